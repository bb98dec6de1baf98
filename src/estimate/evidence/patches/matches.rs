//! Matches found along the epipolar lines, of corners and of features.

use serde::Serialize;

use crate::geometry::PointPair;

/// A match found along the epipolar lines, full-size pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RefinedMatch {
    /// Where it is, image 2 to a fraction of a pixel.
    pub pair: PointPair,
    /// Correlation of its patches, −1 to 1; of features what their being alike, and like nothing else, is worth on that
    /// scale.
    pub correlation: f32,
}

/// A match in pixels of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LevelMatch {
    pub found: RefinedMatch,
    /// Standard deviation, px.
    pub sigma: f64,
    /// Probability that it is the right one of the places that look alike.
    pub prior: f32,
}

/// Standard deviation of an aligned match, px of the level. Not measured.
pub(super) const MATCH_SIGMA: f64 = 0.3;
