//! What a person edits: the two pictures' identity, the point pairs and the parameters.
//!
//! Plain data, serialisable and testable without a window. The pixels live elsewhere; a document only
//! knows which pictures it is about and how large they are.

mod notes;
mod parts;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::estimate::{Method, Parameters, SearchPlan};
use crate::geometry::{Frame, Point, PointPair};
use crate::io::PairOrigin;
use crate::rectify::RectifyMethod;

pub use parts::{
    Checked, HalfPair, Imported, PairNote, PictureIdentity, PointRef, Role, Side, TruthSource, counted,
    pair_name,
};

/// Everything a person can change and undo.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// The two pictures, once they are open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pictures: Option<[PictureIdentity; 2]>,
    /// Finished point pairs: `p`, `q`, `r`, then numbers.
    pub pairs: Vec<PointPair>,
    /// Numbers of the pairs that are left out.
    #[serde(default)]
    pub excluded: BTreeSet<usize>,
    /// Numbers of the pairs that only check the geometry.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub checks: BTreeSet<usize>,
    /// Names and origins of pairs; one without is a clicked one without a name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub notes: BTreeMap<usize, PairNote>,
    /// Whether the geometry is searched without clicks as long as there are too few.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub unclicked: bool,
    /// The pair whose second click is due.
    pub half: Option<HalfPair>,
    /// Parameters of the estimate.
    pub parameters: Parameters,
    /// Offset of two sequences: frame `k` of the left one was taken together with frame `k` plus this of the right one.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub offset: i32,
    /// How the images are rectified.
    #[serde(default)]
    pub rectification: RectifyMethod,
    /// The ground truth that the result is compared with, if any.
    #[serde(default)]
    pub truth: Option<TruthSource>,
    /// A geometry from a file, to be shown beside the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imported: Option<Imported>,
    /// The point that keys act on.
    pub selection: Option<PointRef>,
    /// The pairs that are chosen together in the table, for what is done with all of them.
    #[serde(skip)]
    pub chosen: BTreeSet<usize>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
fn is_zero(offset: &i32) -> bool {
    *offset == 0
}

impl Document {
    /// A document about two pictures, without points.
    pub fn new(pictures: [PictureIdentity; 2], parameters: Parameters) -> Self {
        Self { pictures: Some(pictures), parameters, ..Self::default() }
    }

    /// Size of a picture.
    pub fn frame(&self, side: Side) -> Option<Frame> {
        self.pictures.as_ref().map(|pictures| pictures[side.index()].frame)
    }

    /// A clicked point, of a finished pair or the half-finished one.
    pub fn point(&self, at: PointRef) -> Option<Point> {
        if at.pair == self.pairs.len() {
            return self.half.filter(|half| half.side == at.side).map(|half| half.point);
        }
        self.pairs.get(at.pair).map(|pair| at.side.point(pair))
    }

    /// All points of an image in the order of their pairs, the half-finished one last.
    pub fn points(&self, side: Side) -> impl Iterator<Item = (PointRef, Point)> + '_ {
        (0..=self.pairs.len()).filter_map(move |pair| {
            let at = PointRef { pair, side };
            self.point(at).map(|point| (at, point))
        })
    }

    /// A click: the first one of a pair, its match, or, again in the same image, a better first one.
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
        self.chosen.clear();
    }

    /// The second click of a pair is a suggested match.
    pub fn accept(&mut self, side: Side, point: Point) {
        let pair = self.pairs.len();
        self.place(side, point);
        self.set_origin(pair, PairOrigin::Suggested);
    }

    /// Moves a point, keeping it on its image. A point that is not there (any more) is left alone.
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

    /// Removes a pair, or the half-finished one.
    pub fn remove(&mut self, pair: usize) {
        if pair == self.pairs.len() {
            self.half = None;
        } else if pair < self.pairs.len() {
            self.pairs.remove(pair);
            // The pairs behind it move up.
            let moved = |number: &usize| if *number > pair { number - 1 } else { *number };
            for numbers in [&mut self.excluded, &mut self.checks, &mut self.chosen] {
                numbers.remove(&pair);
                *numbers = numbers.iter().map(moved).collect();
            }
            self.notes.remove(&pair);
            self.notes =
                std::mem::take(&mut self.notes).into_iter().map(|(k, note)| (moved(&k), note)).collect();
        }
        self.selection = None;
    }

    /// Replaces all pairs, which come from somewhere.
    pub fn set_pairs(&mut self, pairs: Vec<PointPair>, origin: PairOrigin) {
        self.pairs = pairs;
        self.notes.clear();
        self.chosen.clear();
        for pair in 0..self.pairs.len() {
            self.set_origin(pair, origin);
        }
        self.excluded.clear();
        self.checks.clear();
        self.half = None;
        self.selection = None;
        self.unclicked = false;
    }

    /// Leaves a pair out, or takes it in again.
    pub fn include(&mut self, pair: usize, included: bool) {
        if included {
            self.excluded.remove(&pair);
        } else if pair < self.pairs.len() {
            self.excluded.insert(pair);
        }
    }

    /// Lets a pair only check the geometry, or take part in it again. Either way it is not left out any more.
    pub fn check_only(&mut self, pair: usize, only: bool) {
        if pair < self.pairs.len() {
            self.excluded.remove(&pair);
            if only {
                self.checks.insert(pair);
            } else {
                self.checks.remove(&pair);
            }
        }
    }

    /// The pairs that are not left out.
    pub fn included(&self) -> impl Iterator<Item = PointPair> + '_ {
        (0..self.pairs.len()).filter(|pair| !self.excluded.contains(pair)).map(|pair| self.pairs[pair])
    }

    /// Point pairs without which there is no geometry: the published search takes as many as its method needs, the one
    /// with patches two or more.
    pub fn pairs_needed(&self) -> usize {
        self.most_pairs().unwrap_or(Method::TwoPoint.pairs_needed())
    }

    /// Pairs that the search takes at most; `None` where each takes part.
    pub fn most_pairs(&self) -> Option<usize> {
        SearchPlan::of(&self.parameters, self.pairs.len()).most_clicks()
    }

    /// Numbers of the pairs the geometry is estimated from: all that are neither left out nor set to check only. The
    /// published search takes the first ones of them, as many as its method needs.
    pub fn used(&self) -> impl Iterator<Item = usize> + '_ {
        let most = self.most_pairs().unwrap_or(usize::MAX);
        let set_aside = |pair: &usize| self.excluded.contains(pair) || self.checks.contains(pair);
        (0..self.pairs.len()).filter(move |pair| !set_aside(pair)).take(most)
    }

    /// Number of the pair that the pencils of this number (0 or 1) pass through, or did before it was moved; `None` where
    /// a match stands in for one.
    pub fn pair_of_pencils(&self, number: usize, click: &PointPair) -> Option<usize> {
        let moved = || self.used().nth(number).filter(|_| !self.is_unclicked());
        self.used().find(|pair| self.pairs[*pair] == *click).or_else(moved)
    }

    /// The pairs the geometry is estimated from; `None` while there are too few and nobody asked for it without.
    pub fn used_pairs(&self) -> Option<Vec<PointPair>> {
        let pairs: Vec<PointPair> = self.used().map(|pair| self.pairs[pair]).collect();
        (pairs.len() >= self.pairs_needed() || self.unclicked).then_some(pairs)
    }

    /// What a pair is for.
    pub fn role(&self, pair: usize) -> Role {
        if self.excluded.contains(&pair) {
            Role::Excluded
        } else if self.used().any(|used| used == pair) || pair >= self.pairs.len() {
            Role::Used
        } else {
            Role::Check
        }
    }

    /// Whether a pair that is not used could be: the published search may have all that it takes.
    pub fn can_be_used(&self, pair: usize) -> bool {
        self.role(pair) != Role::Check || self.checks.contains(&pair)
    }

    /// The point nearest to the given one that lies on the pixels of the image.
    fn inside(&self, side: Side, point: Point) -> Point {
        self.frame(side).map_or(point, |frame| frame.nearest(point))
    }
}
