//! Test whether matches contradict the calibrations of two cameras.

use nalgebra::Matrix3;

use super::plane::largest_plane;
use crate::geometry::{FundamentalMatrix, Matrix9, PointPair, calibration_chi_square};

/// 99.9 % quantile of χ² with the two degrees of freedom by which a fundamental matrix differs from an essential
/// one.
const SIGNIFICANT: f64 = 13.8;

/// A geometry and the matches that it explains.
pub(in crate::estimate) struct Explanation {
    pub fundamental: FundamentalMatrix,
    pub log_likelihood: f64,
    /// Matches within reach of the noise.
    pub right: Vec<PointPair>,
}

/// A fundamental matrix, and the best essential matrix for the same matches.
pub(in crate::estimate) struct Contradiction<'a> {
    pub calibrations: &'a [Matrix3<f64>; 2],
    pub posed: Explanation,
    pub free: Explanation,
    /// Number of all matches.
    pub matches: usize,
    /// Distance of a match from a plane within which it is on the plane, px.
    pub reach: f64,
    pub seed: u64,
}

impl Contradiction<'_> {
    /// Returns whether the matches contradict the calibrations. `covariance` is the covariance of the fundamental
    /// matrix, of norm 1, row by row. Three tests have to speak against the calibrations:
    ///
    /// - The fundamental matrix is likelier than the essential one by more than its two further numbers are worth.
    /// - Most of its matches are not on one plane. There its epipole rests on the others, which may be accidents.
    ///   The essential matrix has to explain as many matches as the plane.
    /// - The calibrations are outside its region of 99.9 %. The first test takes the matches as independent; here,
    ///   those of one region share their error.
    pub fn is_clear(&self, covariance: impl FnOnce() -> Option<Matrix9>) -> bool {
        let Self { calibrations, posed, free, matches, reach, seed } = self;
        let worth = (*matches as f64).ln();
        if posed.log_likelihood >= free.log_likelihood - worth {
            return false;
        }
        let plane = largest_plane(&free.right, *reach, *seed).map_or(0, |(_, most)| most);
        if 2 * plane > free.right.len() && posed.right.len() >= plane {
            return false;
        }
        covariance().is_some_and(|covariance| {
            let chi =
                calibration_chi_square(&free.fundamental, &covariance, &posed.fundamental, calibrations);
            chi.is_none_or(|chi| chi > SIGNIFICANT)
        })
    }
}
