//! The advantage of a geometry over the best clearly different one.

use crate::estimate::{Estimate, Search};
use crate::geometry::{
    Frame, FundamentalMatrix, PointPair, epipolar_difference, symmetric_epipolar_distance,
};

/// Geometries farther apart than this fraction of the longer side are clearly different: some ten times the error of a
/// good result, and what a person sees at once.
const DIFFERENT: f64 = 0.01;
/// A match that is off its line by more than this share of that distance contradicts a geometry.
const CONTRADICTING: f64 = 0.5;
/// Differences are measured up to this many times that distance, beyond which they are all alike.
const LARGEST_DIFFERENCE: f64 = 10.0;

/// Advantage of the best hypothesis over the best one that is clearly different from `fundamental`, relative to the
/// better of the two; `None` when there is none. Where there are supporting matches, one is different that half of them
/// contradict (two geometries that agree wherever the scene is do not compete); else one whose epipolar lines are
/// elsewhere.
pub(in crate::estimate) fn margin(
    fundamental: &FundamentalMatrix,
    hypotheses: &[Estimate],
    matches: &[PointPair],
    frames: [Frame; 2],
    search: Search,
) -> Option<f64> {
    let far = DIFFERENT * frames[0].longer_side();
    let best = hypotheses.first()?;
    let differs = |other: &&Estimate| {
        let f = other.fundamental();
        if matches.is_empty() {
            return epipolar_difference(fundamental, f, frames, LARGEST_DIFFERENCE * far) > far;
        }
        let contradicts = |m: &&PointPair| symmetric_epipolar_distance(f, m) > CONTRADICTING * far;
        2 * matches.iter().filter(contradicts).count() > matches.len()
    };
    let other = hypotheses.iter().find(differs)?;
    // A figure that is missing says nothing for either.
    Some(match search {
        Search::Patches => {
            let [best, other] = [best, other].map(|h| h.support_score().unwrap_or(0.0));
            (best - other) / best.max(1e-9)
        }
        Search::Lines => {
            let [best, other] = [best, other].map(|h| h.line_score().unwrap_or(f64::NAN));
            (other - best) / other.max(1e-9)
        }
    })
}
