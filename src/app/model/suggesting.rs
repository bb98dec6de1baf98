//! Questions about the pictures beside the search: the match of one point, the repair of a placed pair, the
//! next click, and the distortion of the lens.

use super::document::HalfPair;
use super::picture::Pictures;
use super::shared::Shared;
use crate::estimate::Estimate;
use crate::geometry::{Point, PointPair};
use crate::suggest::{SuggestError, Suggestions};

/// Request for a suggested match.
#[derive(Clone, PartialEq)]
pub struct SuggestQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// The first click.
    pub half: HalfPair,
    /// The final result, unless it is unreliable.
    pub found: Option<Shared<Estimate>>,
    /// Pairs that tell rotation and scale between the images while there is no such result.
    pub placed: Vec<PointPair>,
}

/// Places that look like the first click, or the reason why there are none.
pub type Suggested = Result<Suggestions, SuggestError>;

/// Request for the most useful next click, for a doubtful result.
#[derive(Clone, PartialEq)]
pub struct NextClickQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// The result and its rivals.
    pub found: Shared<Estimate>,
    /// The pairs placed so far.
    pub placed: Vec<PointPair>,
}

/// Request for the distortion of a lens that explains the matches clearly better than a result.
#[derive(Clone, PartialEq)]
pub struct LensQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// The result without a lens.
    pub found: Shared<Estimate>,
}

/// Request to check the places of pairs along their epipolar lines, which no distance from the lines shows.
#[derive(Clone, PartialEq)]
pub struct SlidQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// The result, which is reliable.
    pub found: Shared<Estimate>,
    /// The pairs that are not left out.
    pub pairs: Vec<PointPair>,
}

/// A pair whose place along the epipolar line the images do not confirm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slid {
    /// The pair.
    pub pair: PointPair,
    /// Place of the match in the right image, px, if it clearly lies elsewhere on the line. `None` if no
    /// place is clear.
    pub place: Option<Point>,
}

/// Method of repairing a placed pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Repair {
    /// Aligns the point in the right image to a fraction of a pixel near its place.
    Refine,
    /// Moves the point in the right image to the best match on its epipolar line.
    Rematch,
}

/// Request to repair a pair.
#[derive(Clone, PartialEq)]
pub struct RepairQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// Number of the pair.
    pub pair: usize,
    /// Points of the pair.
    pub points: PointPair,
    /// Method of the repair.
    pub how: Repair,
    /// The final result, unless it is unreliable.
    pub found: Option<Shared<Estimate>>,
}

/// New place of the right point, or the reason why there is none: a sentence without its full stop.
pub type RepairOutcome = Result<Point, String>;

/// A finished repair.
#[derive(Clone, PartialEq)]
pub struct Repaired {
    /// The request.
    pub question: RepairQuestion,
    /// The outcome.
    pub outcome: RepairOutcome,
}
