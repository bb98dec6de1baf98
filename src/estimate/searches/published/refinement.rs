//! Refinement on lines: optimises the five numbers that parametrise every `F` through the two
//! clicks, coarse to fine.
//!
//! The cost is a sum of minima over integer disparities, at best piecewise smooth, so the search
//! uses no derivatives. It tries random steps around the best point, and shrinks them when none is
//! better. Steps depend on the seed alone, not on the order of threads.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::{PencilAngles, PencilPair, line_scores};
use crate::estimate::sampling::{Purpose, stream};
use crate::estimate::{EstimateError, Parameters};
use crate::geometry::PointPair;
use crate::similarity::{ScaledSimilarity, SimilaritySource};

/// Number of steps tried at a time, enough to occupy vector units and threads.
const POPULATION: usize = 8;
/// Factor of the step length after a round without success. After eight such rounds, steps are a
/// sixtieth of the first.
const SHRINKING: f64 = 0.6;
/// Longer side of the largest images in refinement on lines, px. Lines of larger images are
/// smoother than a step.
const FINEST: f64 = 800.0;

/// Improves the line score of the five numbers at each level, from the coarsest to the finest.
pub(super) fn refine_on_lines(
    source: &dyn SimilaritySource,
    start: &PencilAngles,
    clicks: &[PointPair; 2],
    parameters: &Parameters,
    cancel: &CancelFlag,
) -> Result<PencilAngles, EstimateError> {
    let mut best = *start;
    let mut rng = stream(parameters.seed, Purpose::LineRefinement, 0);
    let mut side = parameters.pencils.coarse_side;
    let mut done = None;
    loop {
        let level = source.at(side);
        if done != Some(level.scales) {
            done = Some(level.scales);
            best = refine_at(&level, &best, clicks, parameters, &mut rng, cancel)?;
        }
        if side >= FINEST {
            return Ok(best);
        }
        side = (side * 2.0).min(FINEST);
    }
}

fn refine_at(
    level: &ScaledSimilarity,
    start: &PencilAngles,
    clicks: &[PointPair; 2],
    parameters: &Parameters,
    rng: &mut Pcg64Mcg,
    cancel: &CancelFlag,
) -> Result<PencilAngles, EstimateError> {
    let how = &parameters.line_refinement;
    let clicks = clicks.each_ref().map(|click| level.resized(click));
    // Degenerate lines have an infinite score.
    let scores = |all: &[PencilAngles]| -> Result<Vec<f64>, EstimateError> {
        let pencils: Vec<_> = all.iter().map(|angles| PencilPair::new(angles, clicks)).collect();
        let valid: Vec<PencilPair> = pencils.iter().flatten().cloned().collect();
        let scores = line_scores(
            &*level.lines,
            &valid,
            level.frames,
            how.lines,
            parameters.validation.line_score,
            cancel,
        );
        cancel.check()?;
        let mut scores = scores.into_iter();
        let score = |valid: &Option<PencilPair>| valid.as_ref().and_then(|_| scores.next());
        Ok(pencils.iter().map(score).map(|score| score.unwrap_or(f64::INFINITY)).collect())
    };
    let mut best = *start;
    let mut lowest = scores(&[best])?[0];
    let mut step = how.first_step / level.frames[0].longer_side();
    for _ in 0..how.rounds {
        let trials: Vec<PencilAngles> = (0..POPULATION).map(|_| moved(&best, step, rng)).collect();
        let scores = scores(&trials)?;
        let winner = (0..POPULATION).min_by(|a, b| scores[*a].total_cmp(&scores[*b])).unwrap_or(0);
        if scores[winner] < lowest {
            (best, lowest) = (trials[winner], scores[winner]);
        } else {
            step *= SHRINKING;
        }
    }
    Ok(best)
}

/// Mean of the sum of three uniform random numbers that makes a step.
const MEAN_OF_THREE: f64 = 1.5;
/// Factor that brings the standard deviation of this sum, ½, to 1.
const TO_UNIT: f64 = 2.0;
/// Size of a step of ln κ, relative to a step of an angle.
const KAPPA_STEP: f64 = 2.0;

/// Returns the numbers after a random step of all five, on the scale of `step` radians.
fn moved(angles: &PencilAngles, step: f64, rng: &mut Pcg64Mcg) -> PencilAngles {
    let mut draw =
        || step * (rng.random::<f64>() + rng.random::<f64>() + rng.random::<f64>() - MEAN_OF_THREE) * TO_UNIT;
    PencilAngles {
        p: angles.p.map(|a| a + draw()),
        q: angles.q.map(|a| a + draw()),
        kappa: angles.kappa * (KAPPA_STEP * draw()).exp(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Preset;
    use crate::estimate::exact::{ExactScene, ExactSource};

    #[test]
    fn five_numbers_near_the_truth_come_nearer_and_the_seed_decides() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            let (source, clicks, truth) = (ExactSource(scene.fundamental()), scene.clicks(), scene.angles());
            let start = PencilAngles {
                p: [truth.p[0] + 0.01, truth.p[1]],
                q: [truth.q[0], truth.q[1] - 0.01],
                kappa: 1.05 * truth.kappa,
            };
            let error = |angles: &PencilAngles| {
                scene.error(&PencilPair::new(angles, clicks).unwrap().fundamental().unwrap())
            };
            let refine = |seed: u64| {
                let parameters = Parameters { seed, ..Parameters::from(Preset::Paper) };
                refine_on_lines(&source, &start, &clicks, &parameters, &CancelFlag::default()).unwrap()
            };
            for seed in [0, 1] {
                let found = refine(seed);
                assert_eq!(found, refine(seed));
                assert!(error(&found) < 0.5 * error(&start), "{} px of {}", error(&found), error(&start));
            }
            assert_ne!(refine(0), refine(1));
            // Nothing is better than the truth.
            let parameters = Parameters::from(Preset::Paper);
            let stays =
                refine_on_lines(&source, &truth, &clicks, &parameters, &CancelFlag::default()).unwrap();
            assert!(error(&stays) < 0.1, "{} px", error(&stays));
            let flag = CancelFlag::default();
            flag.cancel();
            let stopped = refine_on_lines(&source, &start, &clicks, &parameters, &flag);
            assert_eq!(stopped, Err(EstimateError::Cancelled));
        }
    }
}
