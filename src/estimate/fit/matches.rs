//! Fundamental matrix of given matches, without images.

use nalgebra::Matrix3;
use rayon::prelude::*;
use thiserror::Error;

use super::Match;
use super::consensus::{Agreed, Evidence, Fitted};
use super::false_alarms::Agreement;
use super::model::Model;
use super::noise::{LEAST_SCALE, MEDIAN, Noise, Residual, residuals, widening};
use super::scoring::BAND;
use super::uncertainty::Uncertainty;
use crate::cancel::CancelFlag;
use crate::geometry::{Frame, FundamentalMatrix, Observation, PointPair, REGIONS, region, sampson_distance};

/// A fundamental matrix fitted to matches.
#[derive(Debug, Clone)]
pub struct MatchFit {
    /// The fitted matrix.
    pub fundamental: FundamentalMatrix,
    /// Noise of the matches, estimated together with the matrix.
    pub noise: Noise,
    /// Probability that each match is right, 0 to 1, in the order of the matches.
    pub inlier_probabilities: Vec<f64>,
    /// Covariance of the matrix, with bands of lines and ellipses of epipoles. Matches of one region of
    /// image 1 are assumed to share their error, so it is too large if they are independent. `None` if
    /// the matches do not determine all seven degrees of freedom.
    pub uncertainty: Option<Uncertainty>,
    /// Whether the matrix is an essential one: the fundamental matrix of a relative pose.
    pub is_posed: bool,
    /// Log-likelihood of all matches, less the value if all were outliers.
    pub(super) log_likelihood: f64,
    pub(in crate::estimate) agreement: Agreement,
}

impl MatchFit {
    /// Returns the matches that are likelier right than wrong, in the order of `matches`.
    pub(in crate::estimate) fn agreeing(&self, matches: &[Match]) -> Vec<PointPair> {
        let is_likely = |(_, probability): &(&Match, &f64)| **probability > LIKELY;
        matches.iter().zip(&self.inlier_probabilities).filter(is_likely).map(|(m, _)| m.pair).collect()
    }
}

/// The reason why matches gave no fundamental matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum MatchFitError {
    /// Too few matches, with their number.
    #[error("a fit needs at least {LEAST_MATCHES} matches, {0} were given")]
    TooFew(usize),
    /// The match of this number, from 1, has no finite points, or an invalid scale or prior.
    #[error(
        "match {0} is invalid: its coordinates must be finite, its sigma above 0, and its prior above 0 and at most 1"
    )]
    Invalid(usize),
    /// No geometry explains enough matches.
    #[error(
        "no epipolar geometry explains {} or more of the matches. Most of them may be wrong",
        LEAST_MATCHES
    )]
    NoAgreement,
}

/// Fewest matches: twice the seven unknowns, so as many check the fit as determine it.
pub(super) const LEAST_MATCHES: usize = 14;
/// Least probability of an agreeing match: likelier right than wrong.
pub(in crate::estimate) const LIKELY: f64 = 0.5;
/// Number of matches from which the noise can be estimated together with the matrix: six for each unknown. The
/// noise is then underestimated by 9 %, `1 − √(1 − 1/6)`.
const FEW_MATCHES: usize = 42;
/// Smallest scale of the first search, px: about the noise of the best matches.
const FINEST: f64 = 0.05;
/// Largest scale of the first search, as a fraction of the longer side: the residue of a lens.
const COARSEST: f64 = 0.002;
/// Standard deviation of the least precise features, and of points that a person sets, px.
const LARGEST_ERROR: f64 = 1.0;
/// Ratio of successive scales of the first search. The truncated score tolerates a factor of 2.
const STEP: f64 = 3.0;
/// Scale of a wide loss, in scales of the noise: 2.385 standard deviations. Where the noise is Gaussian, such a Cauchy loss
/// has 95 % of the best precision (Holland & Welsch 1977).
const WIDE_LOSS: f64 = 2.385 / MEDIAN;
/// Largest number of rounds of the first search. After 20, a sample of right matches alone was drawn with 99.99 % where 34 %
/// of the matches are right.
const MOST_ROUNDS: usize = 20;
/// Largest product of rounds and matches. Ten times as many take seconds.
const MOST_SCORED: usize = 10_000;
/// Number of the first of these rounds. Its random numbers are others than those of the rounds that follow.
const FIRST_ROUND: u64 = 1 << 8;
/// Largest number of rounds of consensus. They end earlier when the likelihood no longer grows.
const ROUNDS: u64 = 3;

/// Fits a fundamental matrix to matches, many of which may be wrong, and estimates their noise.
///
/// `frames` are the sizes of the images. The same matches and seed give the same matrix on any number
/// of threads.
///
/// # Errors
/// [`MatchFitError`] for fewer than 14 matches, for an invalid match, or if no geometry explains 14.
pub fn estimate_fundamental(
    matches: &[Match],
    frames: [Frame; 2],
    seed: u64,
) -> Result<MatchFit, MatchFitError> {
    estimate_geometry(matches, frames, Model::Free, seed)
}

/// Fits the essential matrix of two known cameras as [`estimate_fundamental`] fits a fundamental one. Returns the
/// fundamental matrix of the pose.
///
/// `calibrations` are the calibration matrices of images without distortion.
///
/// # Errors
/// As for [`estimate_fundamental`].
pub fn estimate_essential(
    matches: &[Match],
    frames: [Frame; 2],
    calibrations: [Matrix3<f64>; 2],
    seed: u64,
) -> Result<MatchFit, MatchFitError> {
    estimate_geometry(matches, frames, Model::of(Some(calibrations)), seed)
}

/// Fits a geometry of one kind to matches, and estimates their noise.
pub(super) fn estimate_geometry(
    matches: &[Match],
    frames: [Frame; 2],
    model: Model,
    seed: u64,
) -> Result<MatchFit, MatchFitError> {
    if matches.len() < LEAST_MATCHES {
        return Err(MatchFitError::TooFew(matches.len()));
    }
    let is_valid = |m: &Match| {
        let is_positive = m.sigma > 0.0 && m.sigma.is_finite() && m.prior > 0.0 && m.prior <= 1.0;
        is_positive && m.pair.is_finite()
    };
    if let Some(wrong) = matches.iter().position(|m| !is_valid(m)) {
        return Err(MatchFitError::Invalid(wrong + 1));
    }
    let cancel = CancelFlag::default();
    let side = frames[0].longer_side().max(frames[1].longer_side());
    let (spread, least_scale) = (side, LEAST_SCALE);
    let all = Evidence { matches, given: &[], clicks: &[], frames, model, spread, least_scale };
    let scales: Vec<f64> = std::iter::successors(Some(FINEST), |scale| Some(STEP * scale))
        .take_while(|scale| *scale <= (COARSEST * side).max(FINEST))
        .collect();
    // The smaller the scale relative to the picture, the more a match within it says. A minimal sample fits a
    // geometry at any scale, and says nothing.
    let worth = |agreed: &Agreed| (agreed.score - model.unknowns() as f64) * (side / agreed.scale).ln();
    let mut best: Option<Agreed> = None;
    for round in 0..(MOST_SCORED / matches.len()).clamp(1, MOST_ROUNDS) as u64 {
        let agreed = all.consensus(&[], &scales, seed, FIRST_ROUND + round, &cancel);
        best = best.into_iter().chain(agreed).max_by(|a, b| worth(a).total_cmp(&worth(b)));
        if best.is_none_or(|best| all.are_enough(round + 1, &best)) {
            break;
        }
    }
    let Agreed { fundamental, scale, .. } = best.ok_or(MatchFitError::NoAgreement)?;
    // A fit to few matches passes through seven of them, which hides their noise.
    let least_scale = if matches.len() < FEW_MATCHES { scale } else { LEAST_SCALE };
    let all = Evidence { least_scale, ..all };
    let coarse = Noise { scale, inliers: 0.5, spread: side };
    let start = within(&all, &fundamental, coarse.reach()).ok_or(MatchFitError::NoAgreement)?;
    // One band for all, as likelihoods are compared. Beyond it, repeated structure agrees on wrong geometries. Within a
    // narrower one, a geometry that fits some matches exactly by chance would hide the others.
    let band = start.noise.reach().max(BAND * LARGEST_ERROR);
    let mut best = within(&all, &start.fundamental, band).ok_or(MatchFitError::NoAgreement)?;
    for round in 1..=ROUNDS {
        let agreed = all.consensus(&[best.fundamental], &best.rival_scales(), seed, round, &cancel);
        let rivals = agreed.iter().filter_map(|agreed| within(&all, &agreed.fundamental, band));
        let Some(rival) = rivals.max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood)) else { break };
        if rival.log_likelihood <= best.log_likelihood {
            break;
        }
        best = rival;
    }
    let near = near(matches, &best.fundamental, band);
    let best = of_best_loss(&Evidence { matches: &near, spread: 2.0 * band, ..all }, best);
    let covariance = Evidence { matches: &near, ..all }.covariance(&best);
    let (fundamental, noise) = (best.fundamental, best.noise);
    let reach = noise.reach().min(band);
    let probability =
        |r: &Residual| if r.distance < reach * r.sigma { noise.inlier_probability(r) } else { 0.0 };
    let inlier_probabilities: Vec<f64> = residuals(&fundamental, matches).iter().map(probability).collect();
    // The noise follows from the residuals of a fit of `u` unknowns to `k` matches: `k − u` degrees of freedom.
    let agreeing = inlier_probabilities.iter().filter(|p| **p > LIKELY).count();
    let freedom = agreeing.saturating_sub(model.unknowns()).max(1);
    let wider = agreeing as f64 / freedom as f64 * widening(freedom).powi(2);
    Ok(MatchFit {
        inlier_probabilities,
        uncertainty: covariance.map(|c| Uncertainty::new(&fundamental, &(c * wider), [1.0; 2])),
        log_likelihood: all.explained(&fundamental).log_likelihood,
        agreement: model.agreement(&fundamental, matches, frames),
        is_posed: model.is_posed(),
        fundamental,
        noise,
    })
}

/// Fits with the loss that predicts the matches of a region best from those of the other regions. Where matches of a region
/// share their error, likelihood prefers the geometry of the region that happens to fit closest, and a wide loss averages
/// over regions instead.
fn of_best_loss(near: &Evidence, best: Fitted) -> Fitted {
    let region = |m: &Match| region(m.pair.point1, near.frames[0]);
    let fitted = |used: &dyn Fn(&Match) -> bool, loss: f64| {
        let observed = |m: &Match| Observation { pair: m.pair, sigma: m.sigma * best.noise.scale };
        let used: Vec<Observation> = near.matches.iter().filter(|m| used(m)).map(observed).collect();
        let fit =
            near.model.fitted(&best.fundamental, &used, loss).filter(|_| used.len() >= LEAST_MATCHES)?;
        Some(fit.fundamental)
    };
    let predicted = |loss: f64| {
        let likelihood = |of: usize| {
            let own: Vec<Match> = near.matches.iter().filter(|m| region(m) == of).copied().collect();
            let others = (!own.is_empty()).then(|| fitted(&|m| region(m) != of, loss)).flatten();
            others.map_or(0.0, |f| best.noise.log_likelihood(&residuals(&f, &own)))
        };
        // Summed in order, on any number of threads.
        (0..REGIONS).into_par_iter().map(likelihood).collect::<Vec<f64>>().into_iter().sum::<f64>()
    };
    let wide = (predicted(WIDE_LOSS) > predicted(1.0)).then(|| fitted(&|_| true, WIDE_LOSS)).flatten();
    wide.map_or(best, |f| near.explained(&f))
}

/// Fits to the matches within `band` px of the lines. Outliers are uniform over the band.
fn within(all: &Evidence, f: &FundamentalMatrix, band: f64) -> Option<Fitted> {
    let mut current = *f;
    let mut fitted = None;
    for _ in 0..3 {
        let near = near(all.matches, &current, band);
        if near.len() < LEAST_MATCHES {
            return None;
        }
        let evidence = Evidence { matches: &near, spread: 2.0 * band, ..*all };
        let next: Fitted = evidence.fitted(&current)?;
        current = next.fundamental;
        fitted = Some(next);
    }
    fitted
}

fn near(matches: &[Match], f: &FundamentalMatrix, band: f64) -> Vec<Match> {
    matches.iter().filter(|m| sampson_distance(f, &m.pair) < band * m.sigma).copied().collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};
    use crate::geometry::Vector;
    use crate::geometry::random_scene::RandomScene;

    /// Returns matches of a scene with Cauchy noise of this scale, followed by wrong ones.
    fn matches(scene: &ExactScene, right: usize, wrong: usize, scale: f64, seed: u64) -> Vec<Match> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut all: Vec<Match> = Vec::new();
        for pair in scene.pairs(right) {
            let size = scale * (PI * (rng.random::<f64>() - 0.5)).tan();
            let angle = 2.0 * PI * rng.random::<f64>();
            let point2 = pair.point2 + size * Vector::new(angle.cos(), angle.sin());
            all.push(PointPair { point2, ..pair }.into());
        }
        for pair in scene.pairs(wrong) {
            let (x, y) = (rng.random::<f64>() * FRAME.right(), rng.random::<f64>() * FRAME.bottom());
            all.push(PointPair { point2: crate::geometry::Point::new(x, y), ..pair }.into());
        }
        all
    }

    #[test]
    fn given_matches_count_as_much_as_their_own_noise_says() {
        let scene = ExactScene::aside();
        let [precise, loose] =
            [(0.02, 1), (0.5, 2)].map(|(scale, seed)| matches(&scene, 200, 0, scale, seed));
        let error = |matches: &[Match], given: &[Match]| {
            let frames = [FRAME; 2];
            let (model, spread, least_scale) = (Model::Free, 8.0, LEAST_SCALE);
            let evidence = Evidence { matches, given, clicks: &[], frames, model, spread, least_scale };
            scene.error(&evidence.fitted(&scene.disturbed(0.5)).unwrap().fundamental)
        };
        let [of_precise, of_loose] = [error(&precise, &[]), error(&loose, &[])];
        assert!(of_loose > 5.0 * of_precise, "{of_loose} {of_precise}");
        let both = [error(&precise, &loose), error(&loose, &precise)];
        assert!(both.iter().all(|both| *both < 1.5 * of_precise), "{both:?} {of_precise}");
    }

    #[test]
    fn few_matches_of_a_person_are_fitted_and_do_not_seem_exact() {
        let scene = ExactScene::aside();
        for seed in 0..4 {
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let mut off = || 2.0 * (rng.random::<f64>() - 0.5);
            let mut by_hand = |pair: PointPair| {
                let point2 = pair.point2 + Vector::new(off(), off());
                Match::from(PointPair { point2, ..pair })
            };
            let given: Vec<Match> = scene.pairs(16).into_iter().map(&mut by_hand).collect();
            let fit = estimate_fundamental(&given, [FRAME; 2], seed).unwrap();
            let error = scene.error(&fit.fundamental);
            // Seven unknowns of sixteen matches take up more than a third of the noise.
            assert!(error < 5.0 && fit.noise.scale >= FINEST, "{error} px, {:?}", fit.noise);
        }
    }

    #[test]
    fn half_of_the_matches_may_be_wrong() {
        for scene in [ExactScene::aside(), ExactScene::forward()] {
            for scale in [0.05, 0.3] {
                let given = matches(&scene, 200, 200, scale, 7);
                let fit = estimate_fundamental(&given, [FRAME; 2], 3).unwrap();
                let error = scene.error(&fit.fundamental);
                assert!(error < 2.0 * scale, "{scale}: {error} px");
                let right = |range: std::ops::Range<usize>| {
                    fit.inlier_probabilities[range].iter().filter(|p| **p > 0.5).count()
                };
                assert!(right(0..200) > 160 && right(200..400) < 30, "{} {}", right(0..200), right(200..400));
            }
        }
    }

    #[test]
    fn the_seed_decides_and_threads_do_not() {
        let given = matches(&ExactScene::aside(), 100, 60, 0.1, 9);
        let fit = || estimate_fundamental(&given, [FRAME; 2], 5).unwrap().fundamental;
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(fit(), one.install(fit));
    }

    #[test]
    fn precise_matches_outvote_more_loose_ones() {
        let (scene, given) = (ExactScene::aside(), matches(&ExactScene::aside(), 120, 0, 0.05, 11));
        // As many more that agree loosely on another geometry.
        let mut all = given;
        let other = ExactScene::moved([0.3, 0.02, 0.3]);
        all.extend(matches(&other, 150, 0, 0.6, 12));
        let fit = estimate_fundamental(&all, [FRAME; 2], 1).unwrap();
        let (own, of_other) = (scene.error(&fit.fundamental), other.error(&fit.fundamental));
        assert!(own < 0.2 && own < 0.2 * of_other, "{own} {of_other}");
    }

    /// Returns the share of the true lines in their 95 % bands, over 40 fits of matches whose regions
    /// are off by `together` px.
    fn lines_inside(together: f64) -> f64 {
        let scene = ExactScene::aside();
        let (mut inside, mut count) = (0.0, 0.0);
        for seed in 0..40 {
            let mut given = matches(&scene, 300, 60, 0.05, 100 + seed);
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let mut gauss = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
            let shifts: [Vector; 9] = std::array::from_fn(|_| together * Vector::new(gauss(), gauss()));
            for m in &mut given {
                let third =
                    |position: f64, side: usize| (3.0 * position / side as f64).clamp(0.0, 2.0) as usize;
                let point1 = m.pair.point1;
                m.pair.point2 += shifts[3 * third(point1.y, FRAME.height) + third(point1.x, FRAME.width)];
            }
            let fit = estimate_fundamental(&given, [FRAME; 2], seed).unwrap();
            let uncertainty = fit.uncertainty.unwrap();
            for pair in scene.pairs(9) {
                let deviation = uncertainty.line2_deviation(pair.point1, pair.point2).unwrap();
                let line = fit.fundamental.line2_from_point1(pair.point1).unwrap();
                count += 1.0;
                inside += f64::from(line.distance(pair.point2) < 1.96 * deviation);
            }
        }
        inside / count
    }

    #[test]
    fn the_covariance_knows_that_matches_of_a_region_are_off_alike() {
        let alike = lines_inside(0.1);
        // 360 lines of 40 independent fits: some 4 % either way.
        assert!(alike > 0.91, "{alike}");
        // Where they are independent, the bands are wider than needed.
        let independent = lines_inside(0.0);
        assert!(independent > 0.97, "{independent}");
    }

    #[test]
    fn too_few_matches_and_matches_of_chance_are_refused() {
        let scene = ExactScene::aside();
        let few = matches(&scene, 13, 0, 0.1, 1);
        let found = estimate_fundamental(&few, [FRAME; 2], 1).unwrap_err();
        assert_eq!(found, MatchFitError::TooFew(13));
        let mut broken = matches(&scene, 20, 0, 0.1, 1);
        broken[4].pair.point2.x = f64::NAN;
        let found = estimate_fundamental(&broken, [FRAME; 2], 1).unwrap_err();
        assert_eq!(found, MatchFitError::Invalid(5));
        let same: Vec<Match> = vec![PointPair::new(5.0, 6.0, 7.0, 8.0).into(); 40];
        assert_eq!(estimate_fundamental(&same, [FRAME; 2], 1).unwrap_err(), MatchFitError::NoAgreement);
    }

    #[test]
    fn matches_on_a_plane_give_the_geometry_of_known_cameras() {
        let (mut known, mut unknown) = (0, 0);
        for seed in 0..10 {
            let mut scene = RandomScene::new(seed);
            let on_plane = scene.planar_pairs(150);
            let matches: Vec<Match> = scene.disturbed(&on_plane, 0.2).into_iter().map(Match::from).collect();
            let elsewhere = scene.pairs(50);
            let frames = [Frame::new(768, 576); 2];
            let is_right = |fit: MatchFit| {
                let off = elsewhere.iter().map(|pair| sampson_distance(&fit.fundamental, pair));
                usize::from(crate::geometry::median(off) < 1.5)
            };
            let k = Matrix3::new(800.0, 0.0, 383.5, 0.0, 800.0, 287.5, 0.0, 0.0, 1.0);
            known += is_right(estimate_essential(&matches, frames, [k; 2], seed).unwrap());
            unknown += is_right(estimate_fundamental(&matches, frames, seed).unwrap());
        }
        // A plane has two solutions. Of these, one is right; a fundamental matrix may have any epipole.
        assert!(known >= 4 && known > 2 * unknown, "{known} and {unknown} of 10");
    }
}
