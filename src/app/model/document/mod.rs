//! The edited state: identity of the two pictures, point pairs and parameters.
//!
//! Plain data, serialisable and testable without a window. The pixels are stored elsewhere; a
//! document has only names and sizes of the pictures.

mod given;
mod notes;
mod parts;
mod pins;
mod placed;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::estimate::{Method, Parameters, SMALLEST_SIDE, SearchPlan};
use crate::geometry::{Frame, Point, PointPair};
use crate::io::PairOrigin;
use crate::rectify::RectifyMethod;

pub use given::{GIVEN_FIT, Given};
pub use parts::{
    AS_READ, Checked, HalfPair, Imported, PairNote, PictureIdentity, PointRef, Role, Side, TruthSource,
    counted, pair_name,
};
pub use pins::{LineSource, PINS, Pin};

/// Everything that a person can change and undo.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// The two pictures, once they are open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pictures: Option<[PictureIdentity; 2]>,
    /// Finished point pairs: `p`, `q`, `r`, then numbers.
    pub pairs: Vec<PointPair>,
    #[serde(default)]
    pub excluded: BTreeSet<usize>,
    /// Numbers of the pairs that are only checks.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub checks: BTreeSet<usize>,
    /// Names and origins of pairs. A pair without a note was clicked and has no given name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub notes: BTreeMap<usize, PairNote>,
    /// Whether to estimate without clicks while there are too few pairs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub unclicked: bool,
    /// The pair whose second click is due.
    pub half: Option<HalfPair>,
    pub parameters: Parameters,
    /// Time offset: frame `k` of the left sequence belongs with frame `k + offset` of the right
    /// one.
    #[serde(default)]
    pub offset: i32,
    #[serde(default)]
    pub rectification: RectifyMethod,
    /// Ground truth that the result is compared with, if any.
    #[serde(default)]
    pub truth: Option<TruthSource>,
    /// Imported geometry, shown beside the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imported: Option<Imported>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub given: Option<Given>,
    /// Pinned line pairs, oldest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pins: Vec<Pin>,
    /// Number of the pin whose profiles are shown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inspected: Option<usize>,
    /// The point that keys act on.
    pub selection: Option<PointRef>,
}

impl Document {
    /// Creates a document about two pictures, without points.
    pub fn new(pictures: [PictureIdentity; 2], parameters: Parameters) -> Self {
        Self { pictures: Some(pictures), parameters, ..Self::default() }
    }

    pub fn frames(&self) -> Option<[Frame; 2]> {
        self.pictures.as_ref().map(|pictures| pictures.each_ref().map(|picture| picture.frame))
    }

    pub fn frame(&self, side: Side) -> Option<Frame> {
        Some(self.frames()?[side.index()])
    }

    /// Returns whether the pictures are from files, and not built in.
    pub fn is_of_files(&self) -> bool {
        self.pictures.iter().flatten().any(|picture| picture.path.is_some())
    }

    /// Returns whether both points of a pair are inside the pictures.
    pub fn contains(&self, pair: &PointPair) -> bool {
        self.frames().is_some_and(|frames| pair.is_inside(frames))
    }

    /// Returns the hint for a picture too small for lines to be compared, whatever is clicked.
    pub fn too_small(&self) -> Option<String> {
        let is_small = |frame: Frame| frame.width.min(frame.height) < SMALLEST_SIDE;
        self.frames()?.into_iter().any(is_small).then(|| {
            format!(
                "An image is too small for a geometry. Open images of at least {SMALLEST_SIDE} × {SMALLEST_SIDE} px."
            )
        })
    }

    /// Returns a point of a finished pair or of the unfinished one.
    pub fn point(&self, at: PointRef) -> Option<Point> {
        if at.pair == self.pairs.len() {
            return self.half.filter(|half| half.side == at.side).map(|half| half.point);
        }
        self.pairs.get(at.pair).map(|pair| at.side.point(pair))
    }

    /// Returns all points of an image in the order of their pairs, the unfinished one last.
    pub fn points(&self, side: Side) -> impl Iterator<Item = (PointRef, Point)> + '_ {
        (0..=self.pairs.len()).filter_map(move |pair| {
            let at = PointRef { pair, side };
            self.point(at).map(|point| (at, point))
        })
    }

    /// Places a point: the first of a pair, or its match in the other image. A second click in the
    /// same image replaces the first point.
    pub fn place(&mut self, side: Side, point: Point) {
        let point = self.inside(side, point);
        let pair = self.pairs.len();
        match self.half {
            Some(half) if half.side != side => {
                let [point1, point2] = match side {
                    Side::Left => [point, half.point],
                    Side::Right => [half.point, point],
                };
                self.pairs.push(PointPair { point1, point2 });
                self.half = None;
            }
            _ => self.half = Some(HalfPair { side, point }),
        }
        self.selection = Some(PointRef { pair, side });
    }

    /// Places the second point of a pair at a suggested match.
    pub fn accept(&mut self, side: Side, point: Point) {
        let pair = self.pairs.len();
        self.place(side, point);
        self.set_origin(pair, PairOrigin::Suggested);
    }

    /// Moves a point, keeping it inside its image. Does nothing if there is no such point.
    pub fn move_to(&mut self, at: PointRef, point: Point) {
        let point = self.inside(at.side, point);
        if at.pair == self.pairs.len() {
            if let Some(half) = self.half.as_mut().filter(|half| half.side == at.side) {
                half.point = point;
            }
        } else if let Some(pair) = self.pairs.get_mut(at.pair) {
            let before = at.side.point(pair);
            match at.side {
                Side::Left => pair.point1 = point,
                Side::Right => pair.point2 = point,
            }
            if before != point {
                self.set_origin(at.pair, PairOrigin::Clicked);
            }
        }
    }

    /// Removes a finished pair, or the unfinished one.
    pub fn remove(&mut self, pair: usize) {
        if pair == self.pairs.len() {
            self.half = None;
        } else if pair < self.pairs.len() {
            self.pairs.remove(pair);
            // The numbers of later pairs decrease by one.
            let moved = |number: &usize| if *number > pair { number - 1 } else { *number };
            for numbers in [&mut self.excluded, &mut self.checks] {
                numbers.remove(&pair);
                *numbers = numbers.iter().map(moved).collect();
            }
            self.move_pins(|source| source.without_pair(pair));
            self.notes.remove(&pair);
            self.notes =
                std::mem::take(&mut self.notes).into_iter().map(|(k, note)| (moved(&k), note)).collect();
        }
        self.selection = None;
    }

    /// Replaces all pairs by pairs of this origin.
    pub fn set_pairs(&mut self, pairs: Vec<PointPair>, origin: PairOrigin) {
        self.pairs = pairs;
        self.pins.retain(|pin| matches!(pin.source, LineSource::Through { .. }));
        self.notes.clear();
        for pair in 0..self.pairs.len() {
            self.set_origin(pair, origin);
        }
        self.excluded.clear();
        self.checks.clear();
        self.half = None;
        self.selection = None;
        self.unclicked = false;
    }

    pub fn set_role(&mut self, pair: usize, role: Role) {
        self.excluded.remove(&pair);
        self.checks.remove(&pair);
        match role {
            Role::Check if pair < self.pairs.len() => self.checks.insert(pair),
            Role::Excluded if pair < self.pairs.len() => self.excluded.insert(pair),
            _ => false,
        };
    }

    pub fn included(&self) -> impl Iterator<Item = PointPair> + '_ {
        (0..self.pairs.len()).filter(|pair| !self.excluded.contains(pair)).map(|pair| self.pairs[pair])
    }

    /// Returns the minimum number of pairs for an estimate: fixed by the method of the published
    /// search, and two for the search with patches.
    pub fn pairs_needed(&self) -> usize {
        self.most_pairs().unwrap_or(Method::TwoPoint.pairs_needed())
    }

    /// Returns the maximum number of pairs that the search uses; `None` without a limit.
    pub fn most_pairs(&self) -> Option<usize> {
        SearchPlan::of(&self.parameters, self.pairs.len()).most_clicks()
    }

    /// Returns the numbers of the pairs used in the estimate: neither excluded nor checks. The
    /// published search uses as many of the first ones as its method needs.
    pub fn used(&self) -> impl Iterator<Item = usize> + '_ {
        let most = self.most_pairs().unwrap_or(usize::MAX);
        let set_aside = |pair: &usize| self.excluded.contains(pair) || self.checks.contains(pair);
        (0..self.pairs.len()).filter(move |pair| !set_aside(pair)).take(most)
    }

    /// Returns the pair whose click these pencils (0 or 1) pass through, or passed through before
    /// it moved. `None` if a match replaces the click.
    pub fn pair_of_pencils(&self, number: usize, click: &PointPair) -> Option<usize> {
        let moved = || self.used().nth(number).filter(|_| !self.is_unclicked());
        self.used().find(|pair| self.pairs[*pair] == *click).or_else(moved)
    }

    /// Returns the pairs for the estimate. `None` while there are too few, unless the user asked
    /// for an estimate without clicks.
    pub fn used_pairs(&self) -> Option<Vec<PointPair>> {
        let pairs: Vec<PointPair> = self.used().map(|pair| self.pairs[pair]).collect();
        (pairs.len() >= self.pairs_needed() || self.unclicked).then_some(pairs)
    }

    /// Returns the selected pair; `None` for an unfinished pair.
    pub fn selected_pair(&self) -> Option<usize> {
        self.selection.map(|at| at.pair).filter(|pair| *pair < self.pairs.len())
    }

    pub fn role(&self, pair: usize) -> Role {
        if self.excluded.contains(&pair) {
            Role::Excluded
        } else if self.used().any(|used| used == pair) || pair >= self.pairs.len() {
            Role::Used
        } else {
            Role::Check
        }
    }

    /// Returns whether a pair can have this role. The published search may have all the pairs it takes.
    pub fn can_have(&self, pair: usize, role: Role) -> bool {
        role != Role::Used || self.role(pair) != Role::Check || self.checks.contains(&pair)
    }

    /// Returns the nearest point inside the image.
    fn inside(&self, side: Side, point: Point) -> Point {
        self.frame(side).map_or(point, |frame| frame.nearest(point))
    }
}
