//! Few matches: a fit that needs no estimate of the noise, and the number of false alarms.
//!
//! Seven matches fit a geometry, right or wrong. The geometry with the smallest number of false alarms is taken,
//! so no threshold of distance is needed.

use nalgebra::Matrix3;
use rayon::prelude::*;

use super::contradiction::{Contradiction, Explanation};
use super::false_alarms::Agreement;
use super::matches::{LEAST_MATCHES, estimate_geometry};
use super::model::{Model, Samples, by_chance};
use super::noise::{LEAST_SCALE, MEDIAN, Noise, Residual, residuals, widening};
use super::scoring::Units;
use super::{Match, MatchFit, MatchFitError, Uncertainty};
use crate::estimate::sampling::{Draws, Purpose};
use crate::geometry::{Frame, FundamentalMatrix, Matrix9, Observation, sampson_distance};

/// Largest number of matches of which a handful may be right. Among more, a consensus has 14.
const MOST_FEW: usize = 500;
/// Largest number of matches of which all samples are tried: 1,716 of seven.
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

/// Fits to matches as [`fit_matches`] does. Too few matches for an estimate of the noise have to agree beyond chance.
///
/// # Errors
/// The errors of [`fit_matches`].
pub(in crate::estimate) fn fit_given(
    matches: &[Match],
    frames: [Frame; 2],
    calibrations: Option<[Matrix3<f64>; 2]>,
    seed: u64,
) -> Result<MatchFit, MatchFitError> {
    let fit = fit_matches(matches, frames, calibrations, seed)?;
    let is_enough = matches.len() >= LEAST_MATCHES || fit.agreement.is_no_chance();
    if is_enough { Ok(fit) } else { Err(MatchFitError::TooFew(matches.len())) }
}

/// Fits to matches, of which there may be few. For known cameras, the result is an essential matrix unless the
/// matches contradict the calibration ([`Contradiction`]).
///
/// # Errors
/// The errors of [`estimate_geometry`].
pub(in crate::estimate) fn fit_matches(
    matches: &[Match],
    frames: [Frame; 2],
    calibrations: Option<[Matrix3<f64>; 2]>,
    seed: u64,
) -> Result<MatchFit, MatchFitError> {
    let free = fit_model(matches, frames, Model::Free, seed);
    let model = Model::of(calibrations);
    let Some(calibrations) = model.calibrations() else { return free };
    match (fit_model(matches, frames, model, seed), free) {
        (Ok(posed), Ok(free)) if contradict(&posed, &free, matches, calibrations, seed) => Ok(free),
        (Ok(posed), _) => Ok(posed),
        (Err(_), free) => free,
    }
}

/// Returns whether matches contradict the calibrations, or agree on a geometry but not on an essential matrix.
fn contradict(
    posed: &MatchFit,
    free: &MatchFit,
    matches: &[Match],
    calibrations: &[Matrix3<f64>; 2],
    seed: u64,
) -> bool {
    if !posed.agreement.is_no_chance() {
        return free.agreement.is_no_chance();
    }
    let explanation = |fit: &MatchFit| Explanation {
        fundamental: fit.fundamental,
        log_likelihood: fit.log_likelihood,
        right: fit.agreeing(matches),
    };
    let contradiction = Contradiction {
        calibrations,
        posed: explanation(posed),
        free: explanation(free),
        matches: matches.len(),
        reach: free.noise.reach(),
        seed,
    };
    contradiction.is_clear(|| free.uncertainty.as_ref().map(Uncertainty::covariance))
}

/// Fits a geometry of one kind. A consensus estimates the noise together with the geometry. Where chance explains
/// the agreement, the geometry is taken that chance explains least.
fn fit_model(
    matches: &[Match],
    frames: [Frame; 2],
    model: Model,
    seed: u64,
) -> Result<MatchFit, MatchFitError> {
    let many = estimate_geometry(matches, frames, model, seed);
    let is_clear = many.as_ref().is_ok_and(|fit| fit.agreement.is_no_chance());
    let is_invalid = matches!(many, Err(MatchFitError::Invalid(_)));
    if is_clear || is_invalid || matches.len() > MOST_FEW || matches.len() <= model.unknowns() {
        return many;
    }
    let few = fit_few(matches, frames, model, seed);
    let least = |a: &MatchFit, b: &MatchFit| a.agreement.by_false_alarms(&b.agreement);
    many.iter().cloned().chain(few).min_by(least).map_or(many, Ok)
}

/// Fits a geometry to the matches that agree beyond chance. `None` if no sample gives a geometry.
fn fit_few(matches: &[Match], frames: [Frame; 2], model: Model, seed: u64) -> Option<MatchFit> {
    let few = Few { matches, frames, model };
    let scored = few.samples(seed).into_iter().map(|f| few.scored(f));
    let mut scored: Vec<Scored> = scored.collect();
    scored.sort_by(Scored::by_false_alarms);
    scored.truncate(OPTIMISED);
    let optimised: Vec<Scored> = scored.into_par_iter().map(|start| few.optimised(start)).collect();
    few.of_agreeing(&optimised.into_iter().min_by(Scored::by_false_alarms)?)
}

/// Few matches, and the kind of geometry that is fitted to them.
#[derive(Clone, Copy)]
struct Few<'a> {
    matches: &'a [Match],
    frames: [Frame; 2],
    model: Model,
}

#[derive(Clone, Copy)]
struct Scored {
    fundamental: FundamentalMatrix,
    agreement: Agreement,
}

impl Scored {
    fn by_false_alarms(&self, other: &Self) -> std::cmp::Ordering {
        self.agreement.by_false_alarms(&other.agreement)
    }
}

impl Few<'_> {
    fn scored(&self, fundamental: FundamentalMatrix) -> Scored {
        let agreement = self.model.agreement(&fundamental, self.matches, self.frames);
        Scored { fundamental, agreement }
    }

    /// Returns the geometries of all minimal samples, or of many.
    fn samples(&self, seed: u64) -> Vec<FundamentalMatrix> {
        let units = Units::new(self.frames);
        let samples = Samples::new(&self.model, units, self.matches.iter().map(|m| &m.pair));
        let in_pixels = |f: Matrix3<f64>| FundamentalMatrix::nearest_rank_two(units.in_pixels(&f));
        let solved =
            |solutions: Vec<Matrix3<f64>>| solutions.into_iter().filter_map(in_pixels).collect::<Vec<_>>();
        let count = self.matches.len();
        if count <= MOST_EXHAUSTIVE {
            let all = choices(count, self.model.unknowns());
            return all.into_par_iter().flat_map_iter(|sample| solved(samples.solved(&sample))).collect();
        }
        let draws =
            Draws { seed, purpose: Purpose::MatchSamples, first: FIRST_STREAM, count: SAMPLES, task: TASK };
        draws.collect(|random| solved(samples.drawn(random)))
    }

    /// Fits a geometry in rounds to the matches that agree with it, as long as chance explains it less.
    fn optimised(&self, start: Scored) -> Scored {
        let mut best = start;
        for _ in 0..ROUNDS {
            let fitted = self.model.fitted(&best.fundamental, &self.agreeing(&best), ALL_ALIKE);
            match fitted.map(|fit| self.scored(fit.fundamental)) {
                Some(next) if next.by_false_alarms(&best).is_lt() => best = next,
                _ => break,
            }
        }
        best
    }

    fn agrees(&self, with: &Scored, m: &Match) -> bool {
        by_chance(&with.fundamental, &m.pair, self.frames) <= with.agreement.within
    }

    /// Returns the agreeing matches. An ordinary one has a standard deviation of 1 px.
    fn agreeing(&self, with: &Scored) -> Vec<Observation> {
        let agreeing = self.matches.iter().filter(|m| self.agrees(with, m));
        agreeing.map(|m| Observation { pair: m.pair, sigma: m.sigma }).collect()
    }

    /// Returns the geometry fitted to its agreeing matches, with the noise by their degrees of freedom.
    fn of_agreeing(&self, best: &Scored) -> Option<MatchFit> {
        let Self { matches, frames, model } = *self;
        let alike = self.agreeing(best);
        let fit = model.fitted(&best.fundamental, &alike, ALL_ALIKE)?;
        let fundamental = fit.fundamental;
        let squares = alike.iter().map(|o| (sampson_distance(&fundamental, &o.pair) / o.sigma).powi(2));
        let freedom = alike.len().saturating_sub(model.unknowns()).max(1);
        let deviation = (squares.sum::<f64>() / freedom as f64).sqrt().max(LEAST_SCALE);
        let spread = frames[0].longer_side().max(frames[1].longer_side());
        let inliers = (best.agreement.agreeing as f64 / matches.len() as f64).clamp(0.01, 0.99);
        let noise = Noise { scale: MEDIAN * deviation, inliers, spread };
        let widened = fit.covariance.map(|covariance| covariance * widening(freedom).powi(2));
        let residuals = residuals(&fundamental, matches);
        let (reach, fitted) = (noise.reach(), Scored { fundamental, ..*best });
        let probability = |(m, r): (&Match, &Residual)| {
            let is_right = self.agrees(&fitted, m) || r.distance < reach * r.sigma;
            if is_right { noise.inlier_probability(r) } else { 0.0 }
        };
        Some(MatchFit {
            inlier_probabilities: matches.iter().zip(&residuals).map(probability).collect(),
            uncertainty: widened.map(|c: Matrix9| Uncertainty::new(&fundamental, &c, [1.0; 2])),
            log_likelihood: noise.log_likelihood(&residuals),
            agreement: best.agreement,
            is_posed: model.is_posed(),
            noise,
            fundamental,
        })
    }
}

/// Returns all choices of `some` of `n` in rising order.
fn choices(n: usize, some: usize) -> Vec<Vec<usize>> {
    let chosen = |bits: u32| (0..n).filter(|k| bits & (1 << k) != 0).collect();
    (0..1u32 << n).filter(|bits| bits.count_ones() as usize == some).map(chosen).collect()
}

#[cfg(test)]
mod tests {
    use super::super::noise::WITHIN;
    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};
    use crate::geometry::PointPair;
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
            let fit = fit_few(&all, [FRAME; 2], Model::Free, 0).unwrap();
            let agreement = fit.agreement;
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
                let fit = fit_matches(&given, [FRAME; 2], None, seed).unwrap();
                let error = scene.error(&fit.fundamental);
                assert!(error < 12.0 * sigma, "{count} matches off by {sigma} px: {error} px");
            }
        }
        let one = noisy(&scene, 7, 0.3, 1);
        assert_eq!(fit_matches(&one, [FRAME; 2], None, 0).unwrap_err(), MatchFitError::TooFew(7));
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
            let agreement = fit_few(&wrong, [FRAME; 2], Model::Free, 0).unwrap().agreement;
            assert!(!agreement.is_no_chance(), "{count}: {agreement:?}");
        }
        let agreement = fit_few(&noisy(&scene, 11, 0.1, 1), [FRAME; 2], Model::Free, 0).unwrap().agreement;
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
                let Some(fit) = fit_few(&matches, [FRAME; 2], Model::Free, seed) else { continue };
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
        assert_eq!(choices(8, 7).len(), 8);
        assert_eq!(choices(13, 7).len(), 1716);
    }
}
