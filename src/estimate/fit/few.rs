//! Few matches: a fit that needs no estimate of the noise, and the number of false alarms.
//!
//! Seven matches fit a geometry, right or wrong. The geometry with the smallest number of false alarms is taken,
//! so no threshold of distance is needed.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::false_alarms::{Agreement, near_lines_by_chance};
use super::matches::estimate_geometry;
use super::noise::{LEAST_SCALE, Noise, residuals};
use super::scoring::Units;
use super::{Match, MatchFit, MatchFitError, Uncertainty};
use crate::estimate::sampling::{Draws, Purpose, different};
use crate::geometry::{
    Equation, Frame, FundamentalMatrix, Matrix9, Observation, PointPair, fit_fundamental, point_equation,
    sampson_distance, solve_seven,
};

/// Largest number of matches of which a handful may be right. Among more, a consensus has 14.
pub(in crate::estimate) const MOST_FEW: usize = 500;
/// Fewest matches that a geometry is fitted to: seven fit up to three geometries, and the eighth tests them.
pub(in crate::estimate) const FEWEST: usize = 8;
/// Largest number of matches of which all samples of seven are tried: 1,716.
const MOST_EXHAUSTIVE: usize = 13;
/// Number of samples of more matches. Among 2,000, one is all right with 99.9 % where 61 % of the
/// matches are right.
const SAMPLES: usize = 2000;
const TASK: usize = 50;
/// First stream of random numbers, far from those of the consensus of many matches.
const FIRST_STREAM: u64 = 1 << 48;
/// Number of samples that are fitted to all matches that agree with them.
const OPTIMISED: usize = 12;
/// Rounds of fitting. They end earlier when the number of false alarms no longer falls.
const ROUNDS: usize = 4;
/// Scale of a loss that counts all matches alike, in standard deviations.
const ALL_ALIKE: f64 = 1e4;
/// Median of the absolute values of a Gaussian distribution, in standard deviations.
const MEDIAN: f64 = 0.6745;
/// Half of the 95 % interval of a Gaussian variable, in standard deviations.
const WITHIN: f64 = 1.96;

/// Fits to matches, of which there may be few. A consensus estimates their noise together with the geometry. Where
/// chance explains what it found, the geometry is taken that chance explains least, if that is no chance.
///
/// # Errors
/// The errors of [`estimate_geometry`].
pub(in crate::estimate) fn fit_given(
    matches: &[Match],
    frames: [Frame; 2],
    calibrations: Option<[Matrix3<f64>; 2]>,
    seed: u64,
) -> Result<MatchFit, MatchFitError> {
    let many = estimate_geometry(matches, frames, calibrations, seed);
    let is_clear =
        many.as_ref().is_ok_and(|fit| agreement_of(&fit.fundamental, matches, frames).is_no_chance());
    let is_valid = !matches!(many, Err(MatchFitError::Invalid(_)));
    if is_clear || !is_valid || matches.len() > MOST_FEW || matches.len() < FEWEST {
        return many;
    }
    match fit_few(matches, frames, seed) {
        Some((fit, agreement)) if agreement.is_no_chance() => Ok(fit),
        _ => many,
    }
}

/// Returns the agreement of matches that need no picture, so that nothing limits their precision.
pub(in crate::estimate) fn agreement_of(
    f: &FundamentalMatrix,
    matches: &[Match],
    frames: [Frame; 2],
) -> Agreement {
    Agreement::with_lines(f, matches.iter().map(|m| m.pair), frames, LEAST_SCALE)
}

fn chance(f: &FundamentalMatrix, pair: &PointPair, frames: [Frame; 2]) -> f64 {
    near_lines_by_chance(f, pair, frames, LEAST_SCALE)
}

/// Fits a geometry to the matches that agree beyond chance. Returns the fit and the agreement. `None` if
/// no sample gives a geometry.
pub(in crate::estimate) fn fit_few(
    matches: &[Match],
    frames: [Frame; 2],
    seed: u64,
) -> Option<(MatchFit, Agreement)> {
    let mut scored: Vec<(Agreement, FundamentalMatrix)> =
        samples(matches, frames, seed).into_iter().map(|f| (agreement_of(&f, matches, frames), f)).collect();
    let least =
        |a: &(Agreement, FundamentalMatrix), b: &(Agreement, FundamentalMatrix)| a.0.by_false_alarms(&b.0);
    scored.sort_by(least);
    scored.truncate(OPTIMISED);
    let optimised = scored.into_par_iter().map(|start| optimised(start, matches, frames));
    let (agreement, f) = optimised.collect::<Vec<_>>().into_iter().min_by(least)?;
    Some((of_agreeing(&f, &agreement, matches, frames)?, agreement))
}

/// Returns the geometries of all samples of seven matches, or of many.
fn samples(matches: &[Match], frames: [Frame; 2], seed: u64) -> Vec<FundamentalMatrix> {
    let units = Units::new(frames);
    let equations: Vec<Equation> = matches.iter().map(|m| point_equation(units.pair(&m.pair))).collect();
    let solved = |sample: [usize; 7]| {
        let solutions = solve_seven(&sample.map(|k| equations[k]));
        let in_pixels = |f| FundamentalMatrix::nearest_rank_two(units.in_pixels(&f));
        solutions.into_iter().filter_map(in_pixels).collect::<Vec<_>>()
    };
    if matches.len() <= MOST_EXHAUSTIVE {
        return sevens(matches.len()).into_par_iter().flat_map_iter(solved).collect();
    }
    let draws =
        Draws { seed, purpose: Purpose::MatchSamples, first: FIRST_STREAM, count: SAMPLES, task: TASK };
    draws.collect(|random| solved(different(equations.len(), random)))
}

/// Returns all choices of seven of `n` in rising order.
fn sevens(n: usize) -> Vec<[usize; 7]> {
    let chosen = |bits: u32| {
        let mut sample = [0; 7];
        for (place, k) in sample.iter_mut().zip((0..n).filter(|k| bits & (1 << k) != 0)) {
            *place = k;
        }
        sample
    };
    (0..1u32 << n).filter(|bits| bits.count_ones() == 7).map(chosen).collect()
}

/// Fits a geometry in rounds to the matches that agree with it, as long as chance explains it less.
fn optimised(
    start: (Agreement, FundamentalMatrix),
    matches: &[Match],
    frames: [Frame; 2],
) -> (Agreement, FundamentalMatrix) {
    let mut best = start;
    for _ in 0..ROUNDS {
        let observations = observations(&best.1, &best.0, matches, frames, 1.0);
        let fitted = fit_fundamental(&best.1, &observations, ALL_ALIKE).map(|fit| fit.fundamental);
        match fitted.map(|f| (agreement_of(&f, matches, frames), f)) {
            Some(next) if next.0.by_false_alarms(&best.0).is_lt() => best = next,
            _ => break,
        }
    }
    best
}

/// Returns the agreeing matches, with a standard deviation of `sigma` px for an ordinary match.
fn observations(
    f: &FundamentalMatrix,
    agreement: &Agreement,
    matches: &[Match],
    frames: [Frame; 2],
    sigma: f64,
) -> Vec<Observation> {
    let agrees = |m: &&Match| chance(f, &m.pair, frames) <= agreement.within;
    matches.iter().filter(agrees).map(|m| Observation { pair: m.pair, sigma: sigma * m.sigma }).collect()
}

/// Returns the geometry fitted to its agreeing matches, with the noise by their degrees of freedom.
fn of_agreeing(
    f: &FundamentalMatrix,
    agreement: &Agreement,
    matches: &[Match],
    frames: [Frame; 2],
) -> Option<MatchFit> {
    let alike = observations(f, agreement, matches, frames, 1.0);
    let fit = fit_fundamental(f, &alike, ALL_ALIKE)?;
    let fundamental = fit.fundamental;
    let squares = alike.iter().map(|o| (sampson_distance(&fundamental, &o.pair) / o.sigma).powi(2));
    let freedom = alike.len().saturating_sub(7).max(1);
    let deviation = (squares.sum::<f64>() / freedom as f64).sqrt().max(LEAST_SCALE);
    let noise = Noise {
        scale: MEDIAN * deviation,
        inliers: (agreement.agreeing as f64 / matches.len() as f64).clamp(0.01, 0.99),
        spread: frames[0].longer_side().max(frames[1].longer_side()),
    };
    let widened = fit.covariance.map(|covariance| covariance * widening(freedom).powi(2));
    let reach = noise.reach();
    let probability = |(m, r): (&Match, &super::noise::Residual)| {
        let agrees =
            chance(&fundamental, &m.pair, frames) <= agreement.within || r.distance < reach * r.sigma;
        if agrees { noise.inlier_probability(r) } else { 0.0 }
    };
    Some(MatchFit {
        inlier_probabilities: matches
            .iter()
            .zip(&residuals(&fundamental, matches))
            .map(probability)
            .collect(),
        noise,
        uncertainty: widened.map(|covariance: Matrix9| Uncertainty::new(&fundamental, &covariance, [1.0; 2])),
        fundamental,
    })
}

/// Returns how much wider a 95 % interval is if the noise follows from the matches themselves: the quantile
/// of Student's distribution over the Gaussian one, for these degrees of freedom. Above 2, its expansion in
/// `1 / freedom` is right to 4 % (Abramowitz & Stegun 26.7.5).
pub(in crate::estimate) fn widening(freedom: usize) -> f64 {
    let z = WITHIN;
    let quantile = match freedom {
        0 | 1 => 12.706,
        2 => 4.303,
        _ => {
            let freedom = freedom as f64;
            z + (z.powi(3) + z) / (4.0 * freedom)
                + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * freedom * freedom)
        }
    };
    quantile / z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};
    use crate::geometry::random_scene::RandomScene;

    fn noisy(scene: &ExactScene, count: usize, sigma: f64, seed: u64) -> Vec<Match> {
        let pairs = RandomScene::new(seed).disturbed(&scene.pairs(count), sigma);
        pairs.into_iter().map(Match::from).collect()
    }

    #[test]
    fn thirteen_matches_with_two_wrong_ones_give_the_geometry_of_the_others() {
        let scene = ExactScene::aside();
        for seed in 0..5 {
            let mut all = noisy(&scene, 13, 0.1, seed);
            all[3].pair.point2.y += 60.0;
            all[8].pair.point2.y -= 45.0;
            let (fit, agreement) = fit_few(&all, [FRAME; 2], 0).unwrap();
            assert!(agreement.agreeing >= 9 && agreement.is_no_chance(), "{agreement:?}");
            let [wrong1, wrong2] = [3, 8].map(|k| fit.inlier_probabilities[k]);
            assert!(wrong1 < 0.1 && wrong2 < 0.1, "{:?}", fit.inlier_probabilities);
            assert!(scene.error(&fit.fundamental) < 6.0, "{}", scene.error(&fit.fundamental));
        }
    }

    #[test]
    fn few_matches_by_hand_are_fitted_whatever_their_noise() {
        let scene = ExactScene::aside();
        for (count, sigma) in [(10, 0.3), (16, 1.0), (19, 1.5), (200, 0.3)] {
            for seed in 0..3 {
                let given = noisy(&scene, count, sigma, 20 + seed);
                let fit = fit_given(&given, [FRAME; 2], None, seed).unwrap();
                let error = scene.error(&fit.fundamental);
                assert!(error < 12.0 * sigma, "{count} matches off by {sigma} px: {error} px");
            }
        }
        let one = noisy(&scene, 7, 0.3, 1);
        assert_eq!(fit_given(&one, [FRAME; 2], None, 0).unwrap_err(), MatchFitError::TooFew(7));
    }

    #[test]
    fn chance_explains_matches_of_chance_and_not_exact_ones() {
        let mut random = RandomScene::new(7);
        let scene = ExactScene::aside();
        for count in [8, 10, 12, 30] {
            let mut points = random.pairs(2 * count).into_iter();
            let mut wrong = Vec::new();
            while let (Some(a), Some(b)) = (points.next(), points.next()) {
                wrong.push(Match::from(PointPair { point1: a.point1, point2: b.point2 }));
            }
            let (_, agreement) = fit_few(&wrong, [FRAME; 2], 0).unwrap();
            assert!(!agreement.is_no_chance(), "{count}: {agreement:?}");
        }
        let (_, agreement) = fit_few(&noisy(&scene, 11, 0.1, 1), [FRAME; 2], 0).unwrap();
        assert!(agreement.is_no_chance(), "{agreement:?}");
    }

    /// The 95 % bands hold the true lines whatever the number of matches.
    #[test]
    fn few_matches_have_wide_bands() {
        let scene = ExactScene::aside();
        for count in [9, 11, 13] {
            let (mut inside, mut all) = (0.0, 0.0);
            for seed in 0..60 {
                let matches = noisy(&scene, count, 0.3, 50 + seed);
                let Some((fit, _)) = fit_few(&matches, [FRAME; 2], seed) else { continue };
                let Some(uncertainty) = fit.uncertainty else { continue };
                for pair in scene.pairs(count) {
                    let deviation = uncertainty.line2_deviation(pair.point1, pair.point2).unwrap();
                    let line = fit.fundamental.line2_from_point1(pair.point1).unwrap();
                    all += 1.0;
                    inside += f64::from(line.distance(pair.point2) < WITHIN * deviation);
                }
            }
            assert!(inside / all > 0.85, "{count}: {}", inside / all);
        }
    }

    #[test]
    fn the_widening_is_that_of_students_distribution() {
        for (freedom, quantile) in
            [(1, 12.706), (2, 4.303), (3, 3.182), (4, 2.776), (10, 2.228), (100, 1.984)]
        {
            assert!((widening(freedom) * WITHIN / quantile - 1.0).abs() < 0.04, "{freedom}");
        }
        assert_eq!(sevens(8).len(), 8);
        assert_eq!(sevens(13).len(), 1716);
    }
}
