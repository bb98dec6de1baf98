//! Support by matches of covariant features, beside the support of corners. A match counts where it
//! lies near its epipolar line.

use nalgebra::Matrix2;

use super::matches::RefinedMatch;
use super::near_lines::{NearLines, is_within};
use crate::geometry::{FundamentalMatrix, PointPair};

/// Correlation below which a patch gives no support. Support is the excess over it. A lower floor
/// adds matches by chance, a higher one drops slanted surfaces.
pub(super) const FLOOR: f32 = 0.6;

/// Exponent of the odds between the nearest descriptor and the next: their ratio of distances to
/// this power. Fitted to facades by eye: of matches with ratios of 0.5, 0.7 and 0.9, about 90, 60
/// and 45 % are right.
const RATIO_POWER: i32 = 4;

/// A match of covariant features that supports a geometry beside corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct FeatureSupport {
    /// The matched points, full-size pixels.
    pub pair: PointPair,
    /// Standard deviation of a coordinate, px of image 1.
    pub sigma: f64,
    /// Map of offsets in image 1 to offsets in image 2, from the two frames.
    pub affine: Matrix2<f64>,
    /// Weight, on the scale of correlations of patches.
    pub correlation: f32,
    /// Probability that the nearest descriptor is right, rather than the next.
    pub prior: f32,
}

impl FeatureSupport {
    /// Creates the support of a match from its ratio of best to second-best distance. A ratio of 1
    /// says nothing, like a correlation at the floor. A ratio of 0 counts as a correlation of 1.
    pub fn new(pair: PointPair, sigma: f64, affine: Matrix2<f64>, ratio: f64) -> Self {
        Self {
            pair,
            sigma,
            affine,
            correlation: FLOOR + (1.0 - FLOOR) * (1.0 - ratio).clamp(0.0, 1.0) as f32,
            prior: (1.0 / (1.0 + ratio.powi(RATIO_POWER))) as f32,
        }
    }
}

/// Matches of features, laid out for queries by lines.
#[derive(Debug, Clone, Default)]
pub(super) struct FeatureMatches {
    matches: Vec<RefinedMatch>,
    places: NearLines,
}

impl FeatureMatches {
    pub fn new(matches: Vec<RefinedMatch>) -> Self {
        Self { places: NearLines::new(matches.iter().map(|m| m.pair)), matches }
    }

    /// Returns an upper bound on the summed excess of the matches within `band` px.
    pub fn most_support(&self, f: &FundamentalMatrix, band: f64) -> f32 {
        self.places.candidates(f, band).into_iter().map(|k| self.matches[k].correlation - FLOOR).sum()
    }

    /// Returns the number of all matches.
    pub fn len(&self) -> usize {
        self.matches.len()
    }

    /// Returns the matches within `band` px of each other's epipolar lines.
    pub fn within(&self, f: &FundamentalMatrix, band: f64) -> impl Iterator<Item = RefinedMatch> {
        self.numbered_within(f, band).map(|(_, m)| m)
    }

    /// Returns the matches within `band` px of each other's epipolar lines, with their numbers.
    pub fn numbered_within(
        &self,
        f: &FundamentalMatrix,
        band: f64,
    ) -> impl Iterator<Item = (usize, RefinedMatch)> {
        let near = self.places.candidates(f, band).into_iter().map(|k| (k, self.matches[k]));
        near.filter(move |(_, m)| is_within(f, &m.pair, band))
    }
}
