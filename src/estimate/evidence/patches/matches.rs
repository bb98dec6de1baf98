//! Matches found along the epipolar lines, of corners and of features.

use serde::Serialize;

use crate::geometry::{Observation, PointPair};
use crate::image::{PairLevel, Warp};

/// A match found along the epipolar lines; full-size pixels in a result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RefinedMatch {
    /// The matched points; the point of image 2 is aligned to a fraction of a pixel.
    pub pair: PointPair,
    /// Correlation of the patches, −1 to 1. For features, an equivalent on the same scale, from the
    /// ratio of distances. 0 for points without pictures.
    pub correlation: f32,
}

/// A match in pixels of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LevelMatch {
    pub found: RefinedMatch,
    /// Affine map from the surroundings in image 1 to those in image 2.
    pub affine: Warp,
    /// Standard deviation, px.
    pub sigma: f64,
    /// Probability that this is the right match among similar places.
    pub prior: f32,
}

/// Standard deviation of an aligned match, px of the level. It weighs matches against clicks; the
/// final fit estimates the noise of the matches itself.
pub(super) const MATCH_SIGMA: f64 = 0.3;
/// Returns a click in pixels of a level. It is never more precise than the level.
pub(super) fn at_level(click: &Observation, level: &PairLevel) -> Observation {
    let sigma = (click.sigma * level.scales[0]).max(MATCH_SIGMA);
    Observation { pair: level.resized(&click.pair), sigma }
}

/// Fewest matches of a refinement: twice the seven unknowns, and two more.
pub(in crate::estimate) const LEAST_MATCHES: usize = 16;
