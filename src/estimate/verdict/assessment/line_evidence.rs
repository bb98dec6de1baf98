//! Evidence for the lines of a geometry: matches that were found without any geometry.
//!
//! What counts is the lead over the likeliest clearly different geometry, since on repeated structure both are
//! far from chance.

use rayon::prelude::*;

use crate::estimate::evidence::patches::UnguidedMatch;
use crate::estimate::fit::LineLikelihood;
use crate::estimate::fit::false_alarms::Agreement;
use crate::estimate::verdict::constants::SHARED_ERRORS;
use crate::estimate::verdict::trust::LineEvidence;
use crate::geometry::{Frame, FundamentalMatrix};

/// Measures the evidence of the matches found without a geometry for the lines of `f`, against clearly different
/// geometries. `agreement` is that of the same matches with `f`.
pub(super) fn line_evidence(
    f: &FundamentalMatrix,
    rivals: &[&FundamentalMatrix],
    unguided: &[UnguidedMatch],
    frames: [Frame; 2],
    agreement: &Agreement,
) -> LineEvidence {
    let side = frames[0].longer_side().max(frames[1].longer_side());
    let matches = unguided.iter().map(|m| (m.pair, f64::from(m.prior)));
    let witnesses = LineLikelihood::new(matches, SHARED_ERRORS * side, side);
    let likelihoods: Vec<f64> = rivals.par_iter().map(|rival| witnesses.log_likelihood(rival)).collect();
    LineEvidence {
        likelihood: witnesses.log_likelihood(f),
        rival: likelihoods.into_iter().fold(0.0, f64::max),
        // Numbers in files are finite.
        log_false_alarms: agreement.log_false_alarms.min(f64::MAX),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::fit::false_alarms::PRECISION;
    use crate::geometry::PointPair;
    use crate::geometry::random_scene::RandomScene;

    const FRAMES: [Frame; 2] = [Frame { width: 768, height: 576 }; 2];

    fn unguided(pairs: &[PointPair], prior: f32) -> Vec<UnguidedMatch> {
        pairs.iter().map(|pair| UnguidedMatch { pair: *pair, prior }).collect()
    }

    fn evidence(
        f: &FundamentalMatrix,
        rivals: &[&FundamentalMatrix],
        found: &[UnguidedMatch],
    ) -> LineEvidence {
        let agreement = Agreement::with_lines(f, found.iter().map(|m| m.pair), FRAMES, PRECISION);
        line_evidence(f, rivals, found, FRAMES, &agreement)
    }

    #[test]
    fn right_matches_speak_for_the_right_lines_and_chance_for_none() {
        let mut scene = RandomScene::new(5);
        let truth = scene.fundamental();
        let exact = scene.pairs(200);
        let right = scene.disturbed(&exact, 0.5);
        let n = right.len();
        let wrong: Vec<PointPair> =
            (0..n).map(|k| PointPair { point2: right[(k + 71) % n].point2, ..right[k] }).collect();
        let other = RandomScene::new(900).fundamental();
        let strong = evidence(&truth, &[&other], &unguided(&right, 0.8));
        assert!(strong.lead() > 100.0, "{strong:?}");
        let chance = evidence(&truth, &[], &unguided(&wrong, 0.8));
        assert!(chance.lead() < 3.0, "{chance:?}");
        // Half of the matches are right.
        let half: Vec<PointPair> = right[..n / 2].iter().chain(&wrong[n / 2..]).copied().collect();
        let half = evidence(&truth, &[&other], &unguided(&half, 0.5));
        assert!((20.0..strong.lead()).contains(&half.lead()), "{half:?}");
        // The truth is a rival of wrong lines.
        let beaten = evidence(&other, &[&truth], &unguided(&right, 0.8));
        assert!(beaten.lead() < -100.0, "{beaten:?}");
        assert!(evidence(&truth, &[], &[]).lead() <= 0.0);
    }

    #[test]
    fn a_match_that_is_found_many_times_counts_once() {
        let mut scene = RandomScene::new(6);
        let truth = scene.fundamental();
        let pairs = scene.pairs(40);
        let once = evidence(&truth, &[], &unguided(&pairs, 0.7)).likelihood;
        let repeated: Vec<PointPair> = pairs.iter().flat_map(|pair| [*pair; 5]).collect();
        let often = evidence(&truth, &[], &unguided(&repeated, 0.7)).likelihood;
        assert!((often / once - 1.0).abs() < 0.05, "{once} {often}");
    }
}
