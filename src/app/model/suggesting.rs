//! Matches of single points: the suggestion while the second click of a pair is due, and the repair of a placed pair.

use super::document::HalfPair;
use super::picture::Pictures;
use super::shared::Shared;
use crate::estimate::Estimate;
use crate::geometry::{Point, PointPair};
use crate::suggest::{Known, SuggestError, Suggestions};

/// What a match is to be suggested for.
#[derive(Clone, PartialEq)]
pub struct SuggestQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// The first click.
    pub half: HalfPair,
    /// What the result says of the images, when there is one that is not called unreliable.
    pub known: Known,
    /// Pairs that say how the images are turned and scaled, while there is no such result.
    pub placed: Vec<PointPair>,
}

/// Places that look like the first click, or why there are none.
pub type Suggested = Result<Suggestions, SuggestError>;

/// A result in doubt, for which the most useful next click is looked for.
#[derive(Clone, PartialEq)]
pub struct NextClickQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// The result, with what competes with it.
    pub found: Shared<Estimate>,
    /// The pairs that are there.
    pub placed: Vec<PointPair>,
}

/// How a placed pair is repaired.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Repair {
    /// The point in the right image is aligned to a fraction of a pixel around where it is.
    Refine,
    /// The point in the right image goes to the best match on its epipolar line.
    Rematch,
}

/// A pair to be repaired.
#[derive(Clone, PartialEq)]
pub struct RepairQuestion {
    /// The two pictures.
    pub pictures: Pictures,
    /// The number of the pair.
    pub pair: usize,
    /// Where its points are.
    pub points: PointPair,
    /// How it is repaired.
    pub how: Repair,
    /// What the result says of the images.
    pub known: Known,
}

/// Where the right point of a pair belongs, or what happened instead, a sentence without its full stop.
pub type RepairOutcome = Result<Point, String>;

/// A pair for which a better place was looked for.
#[derive(Clone, PartialEq)]
pub struct Repaired {
    /// What was asked.
    pub question: RepairQuestion,
    /// What was found.
    pub outcome: RepairOutcome,
}
