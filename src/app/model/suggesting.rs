//! Questions about the pictures beside the search: the match of one point, the repair of a placed pair, the
//! next click, and the distortion of the lens.

use super::document::HalfPair;
use super::picture::Pictures;
use super::shared::Shared;
use crate::estimate::Estimate;
use crate::geometry::{Point, PointPair};
use crate::suggest::{SuggestError, Suggestions};

#[derive(Clone, PartialEq)]
pub struct SuggestQuestion {
    pub pictures: Pictures,
    pub half: HalfPair,
    /// The final result, unless it is unreliable.
    pub found: Option<Shared<Estimate>>,
    /// Pairs that tell rotation and scale between the images while there is no such result.
    pub placed: Vec<PointPair>,
}

/// Places that look like the first click, or the reason why there are none.
pub type Suggested = Result<Suggestions, SuggestError>;

/// Request about the pairs of a result: for the most useful next click, or for the matches of the pairs along their
/// epipolar lines. No distance from the lines shows whether a pair is there.
#[derive(Clone, PartialEq)]
pub struct PairsQuestion {
    pub pictures: Pictures,
    pub found: Shared<Estimate>,
    pub pairs: Vec<PointPair>,
}

/// Request for the distortion of a lens that explains the matches clearly better than a result.
#[derive(Clone, PartialEq)]
pub struct LensQuestion {
    pub pictures: Pictures,
    /// The result without a lens.
    pub found: Shared<Estimate>,
}

/// Request to align the right point of a pair to a fraction of a pixel near its place.
#[derive(Clone, PartialEq)]
pub struct RepairQuestion {
    pub pictures: Pictures,
    pub pair: usize,
    pub points: PointPair,
    /// The final result, unless it is unreliable.
    pub found: Option<Shared<Estimate>>,
}

/// New place of the right point, or the reason why there is none: a sentence without its full stop.
pub type RepairOutcome = Result<Point, String>;

/// A finished repair: the request and its outcome.
pub type Repaired = (RepairQuestion, RepairOutcome);
