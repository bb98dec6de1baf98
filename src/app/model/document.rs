//! What a person edits: the two pictures' identity, the point pairs and the parameters.
//!
//! Plain data, serialisable and testable without a window. The pixels live elsewhere; a document only
//! knows which pictures it is about and how large they are.

use std::collections::BTreeSet;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::estimate::{Method, Parameters, Search};
use crate::evaluate::Protocol;
use crate::geometry::{Frame, FundamentalMatrix, HomogeneousPoint, Point, PointPair};
use crate::image::Picture;
use crate::rectify::RectifyMethod;

/// One of the two images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// Image 1.
    Left,
    /// Image 2.
    Right,
}

impl Side {
    /// Both, left first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// 0 or 1, for arrays with one entry an image.
    pub fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
        }
    }

    /// The other image.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The point of a pair in this image.
    pub fn point(self, pair: &PointPair) -> Point {
        match self {
            Self::Left => pair.point1,
            Self::Right => pair.point2,
        }
    }

    /// The epipole of a geometry in this image.
    pub fn epipole(self, f: &FundamentalMatrix) -> HomogeneousPoint {
        match self {
            Self::Left => f.epipole1(),
            Self::Right => f.epipole2(),
        }
    }

    /// What the user reads.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}

/// Which picture a document is about.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureIdentity {
    /// File name, or the name of a built-in sample.
    pub name: String,
    /// Where it came from, if from a file.
    pub path: Option<PathBuf>,
    /// Its size.
    pub frame: Frame,
}

impl From<&Picture> for PictureIdentity {
    fn from(picture: &Picture) -> Self {
        Self { name: picture.name.clone(), path: picture.path.clone(), frame: picture.frame() }
    }
}

/// Where the ground truth in use comes from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TruthSource {
    /// A built-in sample, by its name.
    Sample(String),
    /// Two views of a folder.
    Folder {
        /// The folder, in the VGG layout or one of pairs.
        folder: PathBuf,
        /// The names of the left and the right view: those of their images without the ending.
        views: [String; 2],
    },
}

/// A geometry that came from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Imported {
    /// In the convention of this program.
    pub fundamental: FundamentalMatrix,
    /// The name of the file, or of the two.
    pub file: String,
    /// How the numbers of the file were taken.
    pub reading: String,
    /// What matches said about that; none if nobody asked them.
    pub check: Option<Checked>,
}

/// What matches said about a geometry from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checked {
    /// How many they were.
    pub matches: usize,
    /// What they are called.
    pub of: String,
    /// Their median symmetric epipolar distance, px.
    pub median: f64,
    /// Whether that is small enough.
    pub fits: bool,
}

/// How the pairs that the geometry is estimated from were drawn among the true matches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trial {
    /// Which matches may be drawn together.
    pub protocol: Protocol,
    /// The seed of the draw.
    pub seed: u64,
}

/// The first click of a pair whose second click is due.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HalfPair {
    /// The image that was clicked.
    pub side: Side,
    /// Where, px.
    pub point: Point,
}

/// One clicked point: a pair by its number, and the image. The number after the last pair means the
/// half-finished one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct PointRef {
    /// Number of the pair, from 0.
    pub pair: usize,
    /// The image.
    pub side: Side,
}

/// What a pair is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The geometry is estimated from it.
    Used,
    /// It only shows how well the geometry fits.
    Check,
    /// It was left out.
    Excluded,
}

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
    /// The pair whose second click is due.
    pub half: Option<HalfPair>,
    /// Parameters of the estimate.
    pub parameters: Parameters,
    /// How the images are rectified.
    #[serde(default)]
    pub rectification: RectifyMethod,
    /// The ground truth that the result is compared with, if any.
    #[serde(default)]
    pub truth: Option<TruthSource>,
    /// A geometry from a file, to be shown beside the result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub imported: Option<Imported>,
    /// Which random trial the first pairs are, as long as they are as they were drawn.
    #[serde(default)]
    pub trial: Option<Trial>,
    /// The point that keys act on.
    pub selection: Option<PointRef>,
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
                self.follow_trial();
            }
            _ => self.half = Some(HalfPair { side, point }),
        }
        self.selection = Some(PointRef { pair, side });
    }

    /// Moves a point, keeping it on its image. A point that is not there (any more) is left alone.
    pub fn move_to(&mut self, at: PointRef, point: Point) {
        let (point, needed) = (self.inside(at.side, point), self.pairs_needed());
        if at.pair == self.pairs.len() {
            if let Some(half) = self.half.as_mut().filter(|half| half.side == at.side) {
                half.point = point;
            }
        } else if let Some(pair) = self.pairs.get_mut(at.pair) {
            self.trial = self.trial.filter(|_| at.pair >= needed);
            match at.side {
                Side::Left => pair.point1 = point,
                Side::Right => pair.point2 = point,
            }
        }
    }

    /// Removes a pair, or the half-finished one.
    pub fn remove(&mut self, pair: usize) {
        if pair == self.pairs.len() {
            self.half = None;
        } else if pair < self.pairs.len() {
            self.pairs.remove(pair);
            self.trial = self.trial.filter(|_| pair >= self.pairs_needed());
            // The pairs behind it move up.
            let moved = |number: &usize| if *number > pair { number - 1 } else { *number };
            for numbers in [&mut self.excluded, &mut self.checks] {
                numbers.remove(&pair);
                *numbers = numbers.iter().map(moved).collect();
            }
        }
        self.selection = None;
    }

    /// Replaces all pairs.
    pub fn set_pairs(&mut self, pairs: Vec<PointPair>) {
        self.pairs = pairs;
        self.trial = None;
        self.excluded.clear();
        self.checks.clear();
        self.half = None;
        self.selection = None;
    }

    /// Puts the pairs of a random trial in place of the first ones; those behind them stay, to check the result.
    pub fn set_trial(&mut self, trial: Trial, drawn: Vec<PointPair>) {
        let count = drawn.len();
        self.excluded.retain(|pair| *pair >= count);
        let behind = self.pairs.split_off(count.min(self.pairs.len()));
        self.pairs = drawn;
        self.pairs.extend(behind);
        self.checks = (count..self.pairs.len()).collect();
        self.trial = Some(trial);
        self.half = None;
        self.selection = None;
    }

    /// Leaves a pair out, or takes it in again.
    pub fn include(&mut self, pair: usize, included: bool) {
        if included {
            self.excluded.remove(&pair);
        } else if pair < self.pairs.len() {
            self.excluded.insert(pair);
        }
        self.follow_trial();
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
            self.follow_trial();
        }
    }

    /// A random trial is one no more when others than its pairs are used.
    fn follow_trial(&mut self) {
        if !self.used().eq(0..self.pairs_needed()) {
            self.trial = None;
        }
    }

    /// The pairs that are not left out.
    pub fn included(&self) -> impl Iterator<Item = PointPair> + '_ {
        (0..self.pairs.len()).filter(|pair| !self.excluded.contains(pair)).map(|pair| self.pairs[pair])
    }

    /// Point pairs without which there is no geometry: the published search takes as many as its method needs, the one
    /// with patches two or more.
    pub fn pairs_needed(&self) -> usize {
        match self.parameters.search {
            Search::Lines => self.parameters.method.pairs_needed(),
            Search::Patches => Method::TwoPoint.pairs_needed(),
        }
    }

    /// The parameters that the search is given: the published methods are a choice of the published search alone.
    pub fn search_parameters(&self) -> Parameters {
        match self.parameters.search {
            Search::Lines => self.parameters.clone(),
            Search::Patches => Parameters { method: Method::TwoPoint, ..self.parameters.clone() },
        }
    }

    /// Numbers of the pairs the geometry is estimated from: all that are neither left out nor set to check only. The
    /// published search takes the first ones of them, as many as its method needs.
    pub fn used(&self) -> impl Iterator<Item = usize> + '_ {
        let most = match self.parameters.search {
            Search::Lines => self.pairs_needed(),
            Search::Patches => usize::MAX,
        };
        let set_aside = |pair: &usize| self.excluded.contains(pair) || self.checks.contains(pair);
        (0..self.pairs.len()).filter(move |pair| !set_aside(pair)).take(most)
    }

    /// The pairs the geometry is estimated from; `None` while there are too few.
    pub fn used_pairs(&self) -> Option<Vec<PointPair>> {
        let pairs: Vec<PointPair> = self.used().map(|pair| self.pairs[pair]).collect();
        (pairs.len() >= self.pairs_needed()).then_some(pairs)
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

/// What a pair is called: `p`, `q`, `r`, then numbers.
pub fn pair_name(pair: usize) -> String {
    match pair {
        0 => "p".to_owned(),
        1 => "q".to_owned(),
        2 => "r".to_owned(),
        more => (more + 1).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Preset;

    fn document() -> Document {
        let picture =
            |name: &str| PictureIdentity { name: name.into(), path: None, frame: Frame::new(100, 80) };
        Document::new([picture("a"), picture("b")], Parameters::default())
    }

    #[test]
    fn two_clicks_in_either_order_make_a_pair() {
        let mut document = document();
        document.place(Side::Left, Point::new(1.0, 2.0));
        assert!(document.half.is_some() && document.pairs.is_empty());
        document.place(Side::Right, Point::new(3.0, 4.0));
        document.place(Side::Right, Point::new(7.0, 8.0));
        document.place(Side::Left, Point::new(5.0, 6.0));
        assert_eq!(document.pairs, [PointPair::new(1.0, 2.0, 3.0, 4.0), PointPair::new(5.0, 6.0, 7.0, 8.0)]);
        assert!(document.half.is_none());
        assert_eq!(document.used_pairs().map(|pairs| pairs.len()), Some(2));
    }

    #[test]
    fn a_second_click_in_the_same_image_replaces_the_first() {
        let mut document = document();
        document.place(Side::Left, Point::new(1.0, 2.0));
        document.place(Side::Left, Point::new(9.0, 9.0));
        assert_eq!(document.half.map(|half| half.point), Some(Point::new(9.0, 9.0)));
        assert_eq!(document.points(Side::Left).count(), 1);
        assert_eq!(document.points(Side::Right).count(), 0);
    }

    #[test]
    fn points_stay_on_their_image() {
        let mut document = document();
        document.place(Side::Left, Point::new(-50.0, 500.0));
        assert_eq!(document.half.map(|half| half.point), Some(Point::new(-0.5, 79.5)));
        let at = PointRef { pair: 0, side: Side::Left };
        document.move_to(at, Point::new(1e9, -1e9));
        assert_eq!(document.point(at), Some(Point::new(99.5, -0.5)));
    }

    #[test]
    fn moving_or_removing_what_is_not_there_changes_nothing() {
        let mut document = document();
        document.place(Side::Left, Point::new(1.0, 2.0));
        let before = document.clone();
        document.move_to(PointRef { pair: 0, side: Side::Right }, Point::new(5.0, 5.0));
        document.move_to(PointRef { pair: 7, side: Side::Right }, Point::new(5.0, 5.0));
        assert_eq!(document, before);
        document.remove(7);
        assert!(document.half.is_some());
        document.remove(0);
        assert!(document.half.is_none());
    }

    #[test]
    fn all_pairs_are_used_but_those_that_check_and_the_published_search_takes_what_it_needs() {
        let mut document = document();
        document.set_pairs(vec![PointPair::new(1.0, 2.0, 3.0, 4.0); 5]);
        assert_eq!(document.used_pairs().map(|pairs| pairs.len()), Some(5));
        document.check_only(1, true);
        document.include(3, false);
        assert_eq!(document.used().collect::<Vec<_>>(), [0, 2, 4]);
        assert_eq!((document.role(1), document.role(3)), (Role::Check, Role::Excluded));
        document.remove(0);
        assert_eq!(document.used().collect::<Vec<_>>(), [1, 3], "numbers follow when a pair before goes");
        document.check_only(2, false);
        document.check_only(0, false);
        assert_eq!(document.used().count(), 4);
        document.parameters = Parameters::from(Preset::Paper);
        assert_eq!((document.used().count(), document.role(2)), (2, Role::Check));
        document.parameters.method = Method::ThreePoint;
        assert_eq!((document.used().count(), document.role(2)), (3, Role::Used));
    }

    #[test]
    fn a_document_from_before_there_were_roles_uses_its_pairs() {
        let mut document = document();
        document.set_pairs(vec![PointPair::new(1.0, 2.0, 3.0, 4.0); 3]);
        let mut old = serde_json::to_value(&document).unwrap();
        assert!(old.as_object_mut().unwrap().remove("checks").is_none());
        assert_eq!(serde_json::from_value::<Document>(old).unwrap(), document);
    }

    #[test]
    fn a_trial_replaces_the_first_pairs_until_one_of_them_is_touched() {
        let mut document = document();
        let pair = |x: f64| PointPair::new(x, 1.0, x, 1.0);
        let trial = Trial { protocol: Protocol::WellPosed, seed: 3 };
        document.set_trial(trial, vec![pair(1.0), pair(2.0)]);
        assert_eq!((document.pairs.len(), document.trial), (2, Some(trial)));
        document.place(Side::Left, pair(9.0).point1);
        document.place(Side::Right, pair(9.0).point2);
        assert_eq!(document.trial, None, "another pair takes part");
        document.include(0, false);
        document.include(2, false);
        document.set_trial(trial, vec![pair(3.0), pair(4.0)]);
        assert_eq!(document.pairs, [pair(3.0), pair(4.0), pair(9.0)]);
        assert_eq!(document.used().collect::<Vec<_>>(), [0, 1]);
        assert_eq!(document.excluded, BTreeSet::from([2]), "what was left out further behind stays so");
        document.move_to(PointRef { pair: 2, side: Side::Left }, Point::new(5.0, 5.0));
        assert_eq!(document.trial, Some(trial));
        document.move_to(PointRef { pair: 1, side: Side::Left }, Point::new(5.0, 5.0));
        assert_eq!(document.trial, None);
    }

    #[test]
    fn a_pair_left_out_makes_room_for_the_next_one_of_the_published_search() {
        let mut document = document();
        document.parameters = Parameters::from(Preset::Paper);
        let pair = |x: f64| PointPair::new(x, 1.0, x, 1.0);
        document.set_pairs([1.0, 2.0, 3.0, 4.0].map(pair).to_vec());
        document.include(1, false);
        assert_eq!(document.used_pairs(), Some(vec![pair(1.0), pair(3.0)]));
        let roles: Vec<_> = (0..4).map(|k| document.role(k)).collect();
        assert_eq!(roles, [Role::Used, Role::Excluded, Role::Used, Role::Check]);
        document.remove(0);
        assert_eq!(document.role(0), Role::Excluded, "numbers follow when a pair before it goes");
        document.include(0, true);
        assert_eq!(document.used_pairs(), Some(vec![pair(2.0), pair(3.0)]));
        document.include(1, false);
        document.include(2, false);
        assert_eq!(document.used_pairs(), None);
    }

    #[test]
    fn survives_a_round_trip_through_json() {
        let mut document = document();
        document.place(Side::Left, Point::new(1.25, 2.5));
        let text = serde_json::to_string(&document).unwrap();
        assert_eq!(serde_json::from_str::<Document>(&text).unwrap(), document);
    }
}
