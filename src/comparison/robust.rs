//! Robust baselines: RANSAC with MSAC scores, and least median of squares.
//!
//! Both draw samples of seven pairs, solve each with the seven-point algorithm, and keep the best
//! solution under their score of Sampson distances `d`. MSAC minimises `Σ min(d², t²)` (Torr and
//! Zisserman 2000). Least median of squares needs no threshold (Zhang 1998). It minimises the value
//! at `n/2 + 4` of the `n` sorted `d²`, because seven pairs always fit (Rousseeuw and Leroy 1987).
//! An eight-point fit to the inliers replaces the solution if its score is better.

use rand::seq::index::sample;

use super::fits::{FitError, PointFit};
use super::random::{Purpose, generator};
use crate::geometry::{FundamentalMatrix, PointPair, eight_point, sampson_distance, seven_point};

/// Number of samples: with a third of wrong matches, one of them is right with probability
/// `1 − 10⁻²⁶`.
const SAMPLES: usize = 1000;
/// Sampson distance up to which a match is an inlier of RANSAC, px: 95 % of right matches with a
/// standard deviation of 1 px.
const THRESHOLD: f64 = 1.96;
/// Number of pairs that a sample fits exactly.
const FITTED: usize = 7;
/// Fewest pairs.
const FEWEST: usize = FITTED + 1;

/// Fits by RANSAC with MSAC scores. The seed decides the samples.
pub fn fit_msac(pairs: &[PointPair], seed: u64) -> Result<PointFit, FitError> {
    let limit = THRESHOLD * THRESHOLD;
    let score = |squares: &[f64]| squares.iter().map(|square| square.min(limit)).sum();
    best_of_samples(pairs, seed, score, |_| limit)
}

/// Fits by least median of squares. The seed decides the samples.
pub fn fit_least_median(pairs: &[PointPair], seed: u64) -> Result<PointFit, FitError> {
    let score = |squares: &[f64]| {
        let mut sorted = squares.to_vec();
        sorted.sort_by(f64::total_cmp);
        let place = sorted.len() / 2 + FITTED.div_ceil(2);
        sorted.get(place.min(sorted.len()) - 1).copied().unwrap_or(f64::INFINITY)
    };
    // The robust standard deviation of Rousseeuw and Leroy; inliers are within 2.5 of it.
    let correction = 1.4826 * (1.0 + 5.0 / (pairs.len() as f64 - 7.0).max(1.0));
    best_of_samples(pairs, seed, score, |best| (2.5 * correction).powi(2) * best)
}

/// Returns the solution with the lowest score, refitted to the pairs within `reach` of the score.
fn best_of_samples(
    pairs: &[PointPair],
    seed: u64,
    score: impl Fn(&[f64]) -> f64,
    reach: impl Fn(f64) -> f64,
) -> Result<PointFit, FitError> {
    if pairs.len() < FEWEST {
        return Err(FitError::TooFew(FEWEST - pairs.len()));
    }
    let mut random = generator(seed, "", Purpose::Samples, 0);
    let rated = |f: FundamentalMatrix| {
        let squares = squares(&f, pairs);
        (score(&squares), squares, f)
    };
    let mut best: Option<(f64, Vec<f64>, FundamentalMatrix)> = None;
    for _ in 0..SAMPLES {
        let drawn: Vec<PointPair> =
            sample(&mut random, pairs.len(), FITTED).iter().map(|k| pairs[k]).collect();
        for found in seven_point(&drawn).unwrap_or_default().into_iter().map(rated) {
            if best.as_ref().is_none_or(|best| found.0 < best.0) {
                best = Some(found);
            }
        }
    }
    let mut best = best.ok_or(FitError::NoSample)?;
    let limit = reach(best.0);
    let inliers = |squares: &[f64]| -> Vec<PointPair> {
        pairs.iter().zip(squares).filter(|(_, square)| **square <= limit).map(|(pair, _)| *pair).collect()
    };
    let refitted = eight_point(&inliers(&best.1)).ok().map(rated);
    if let Some(refitted) = refitted.filter(|refitted| refitted.0 < best.0) {
        best = refitted;
    }
    Ok(PointFit { fundamental: best.2, pairs: inliers(&best.1).len(), solutions: 1 })
}

/// Returns the squared Sampson distances. An undefined distance is infinite.
fn squares(f: &FundamentalMatrix, pairs: &[PointPair]) -> Vec<f64> {
    let defined = |square: f64| if square.is_nan() { f64::INFINITY } else { square };
    pairs.iter().map(|pair| defined(sampson_distance(f, pair).powi(2))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::{Distances, fit_eight, mean};
    use crate::geometry::random_scene::RandomScene;

    #[test]
    fn a_third_of_wrong_matches_does_not_matter() {
        let right = RandomScene::new(3).pairs(40);
        let mut pairs = right.clone();
        for k in 0..20 {
            let (a, b) = (&right[k], &right[39 - k]);
            pairs.push(PointPair { point1: a.point1, point2: b.point2 });
        }
        let error = |f: &FundamentalMatrix| mean(&Distances::of(f, &right).symmetric);
        for fit in [fit_msac(&pairs, 0), fit_least_median(&pairs, 0)] {
            let fit = fit.unwrap();
            // Wrong matches that lie near their lines by chance pull at the fit.
            assert!(error(&fit.fundamental) < 0.3, "{}", error(&fit.fundamental));
            assert!((38..48).contains(&fit.pairs), "{} inliers", fit.pairs);
        }
        assert!(error(&fit_eight(&pairs).unwrap().fundamental) > 1.0, "which the baselines are for");
    }

    #[test]
    fn the_same_seed_gives_the_same_fit() {
        let mut pairs = RandomScene::new(5).pairs(30);
        for (k, pair) in pairs.iter_mut().enumerate() {
            pair.point2.y += (k as f64 * 7.3).sin();
        }
        for fit in [fit_msac, fit_least_median] {
            assert_eq!(fit(&pairs, 1).unwrap(), fit(&pairs, 1).unwrap());
        }
    }

    #[test]
    fn too_few_and_degenerate_pairs_are_refused() {
        let pairs = RandomScene::new(1).pairs(7);
        assert_eq!(fit_msac(&pairs, 0), Err(FitError::TooFew(1)));
        assert_eq!(fit_least_median(&[pairs[0]; 9], 0), Err(FitError::NoSample));
    }
}
