//! Agreement of a geometry with matches that were found without it: those of the images, and those of another
//! program.

use crate::estimate::evidence::patches::{LIKELY, PatchLevels, one_a_place};
use crate::estimate::evidence::prepared::GivenMatches;
use crate::estimate::fit::false_alarms::{Agreement, PRECISION};
use crate::estimate::verdict::constants::CLICK_DEVIATIONS;
use crate::estimate::verdict::trust::GivenFigures;
use crate::geometry::{Frame, FundamentalMatrix, PointPair, median, sampson_distance};

/// Returns the agreement of the likely matches found in the whole of image 2 with a geometry (full size).
pub(in crate::estimate) fn unguided_agreement(
    patches: &PatchLevels,
    f: &FundamentalMatrix,
    frames: [Frame; 2],
) -> Agreement {
    Agreement::with_lines(f, one_a_place(patches.unguided(), LIKELY), frames, PRECISION)
}

/// Returns the number of these matches within `tolerance` px of their epipolar lines.
pub(super) fn unguided_on_lines(patches: &PatchLevels, f: &FundamentalMatrix, tolerance: f64) -> usize {
    one_a_place(patches.unguided(), LIKELY).filter(|pair| sampson_distance(f, pair) < tolerance).count()
}

/// Returns the agreement of given matches with a geometry. Matches that no common geometry explains are mistakes
/// and not counted, unless no geometry explains enough of them. A match is off its lines beyond its own noise
/// and beyond the error of a click, whichever is larger.
pub(in crate::estimate) fn given_figures(
    given: &GivenMatches,
    f: &FundamentalMatrix,
    click_sigma: f64,
) -> GivenFigures {
    let all = || given.all.iter().map(|m| m.pair).collect();
    let (pairs, reach): (Vec<PointPair>, f64) = match &given.fit {
        Ok(fit) => (fit.inliers.clone(), fit.reach),
        Err(_) => (all(), 0.0),
    };
    let limit = reach.max(CLICK_DEVIATIONS * click_sigma);
    let distances: Vec<f64> = pairs.iter().map(|pair| sampson_distance(f, pair)).collect();
    GivenFigures {
        matches: pairs.len(),
        off: distances.iter().filter(|distance| **distance > limit).count(),
        distance: median(distances),
    }
}
