//! Refinement on lines: the five numbers that parametrise every `F` through the two clicks, moved so that the
//! epipolar lines match better, coarse to fine.
//!
//! The cost is a sum of minima over integer disparities, piecewise smooth at best, so the search uses no
//! derivatives: a few random steps around the best point so far, the step size shrinking when none of them is
//! better. Steps are drawn from the seed and evaluated in parallel; the order of threads changes nothing.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::bundle::{Angles, Bundle};
use super::level::Level;
use super::prepared::PreparedPair;
use super::validation::line_score;
use super::{EstimateError, Monitor, Parameters};
use crate::geometry::PointPair;
use crate::similarity::{DisparityRange, StereoSimilarity};

/// Steps tried at a time.
const POPULATION: usize = 8;
/// Rounds at each level.
const ROUNDS: usize = 8;
/// Lines a direction while refining; fewer than in validation, since only neighbours are compared.
const LINES: usize = 12;

/// The stereo similarity at a level.
pub(crate) fn stereo<'a>(level: &Level<'a>, parameters: &Parameters) -> StereoSimilarity<'a> {
    let side = level.planes[0].frame().longer_side();
    let reach = (parameters.disparity_reach * side).round().max(2.0) as i32;
    StereoSimilarity {
        planes: level.planes,
        range: DisparityRange::symmetric(reach),
        parameters: parameters.stereo,
    }
}

/// Moves the five numbers to a better line score at each level from the coarse one up to a longer side of
/// `finest` px.
pub(crate) fn refine_on_lines(
    prepared: &PreparedPair,
    start: &Angles,
    clicks: &[PointPair; 2],
    parameters: &Parameters,
    finest: f64,
    monitor: &Monitor,
) -> Result<Angles, EstimateError> {
    let mut best = *start;
    let mut rng = Pcg64Mcg::seed_from_u64(parameters.seed ^ 0x5eed);
    let mut side = parameters.coarse_side;
    let mut done = None;
    loop {
        let level = prepared.level(side);
        if done != Some(level.scales) {
            best = refine_at(&level, &best, clicks, parameters, &mut rng, monitor)?;
            done = Some(level.scales);
        }
        if side >= finest {
            return Ok(best);
        }
        side = (side * 2.0).min(finest);
    }
}

fn refine_at(
    level: &Level,
    start: &Angles,
    clicks: &[PointPair; 2],
    parameters: &Parameters,
    rng: &mut Pcg64Mcg,
    monitor: &Monitor,
) -> Result<Angles, EstimateError> {
    let clicks = [level.resized(&clicks[0]), level.resized(&clicks[1])];
    let frames = level.frames();
    let similarity = stereo(level, parameters);
    let score = |angles: &Angles| {
        Bundle::new(angles, clicks).map_or(f64::INFINITY, |bundle| {
            line_score(&similarity, &bundle, frames, LINES, parameters.line_score)
        })
    };
    let mut best = *start;
    let mut lowest = score(&best);
    // One pixel at the far side of the image.
    let mut step = 1.5 / frames[0].longer_side();
    for _ in 0..ROUNDS {
        monitor.check()?;
        let trials: Vec<Angles> = (0..POPULATION).map(|_| moved(&best, step, rng)).collect();
        let scores: Vec<f64> = trials.par_iter().map(&score).collect();
        let winner = (0..POPULATION).min_by(|a, b| scores[*a].total_cmp(&scores[*b])).unwrap_or(0);
        if scores[winner] < lowest {
            (best, lowest) = (trials[winner], scores[winner]);
        } else {
            step *= 0.6;
        }
    }
    Ok(best)
}

/// A random step: all five numbers at once, on the scale of `step` radians.
fn moved(angles: &Angles, step: f64, rng: &mut Pcg64Mcg) -> Angles {
    let mut draw = || step * (rng.random::<f64>() + rng.random::<f64>() + rng.random::<f64>() - 1.5) * 2.0;
    Angles {
        p: angles.p.map(|a| a + draw()),
        q: angles.q.map(|a| a + draw()),
        kappa: angles.kappa * (2.0 * draw()).exp(),
    }
}
