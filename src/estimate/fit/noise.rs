//! The noise of a set of matches, estimated from their own residuals.
//!
//! The Sampson distances of right matches follow a Cauchy distribution closely: most lie within a
//! tenth of a pixel, and the rest has heavy tails (blurred corners, occlusions, curved surfaces).
//! Wrong matches spread over a known width `W`. With `r` the residual of a match in px and `σ` its
//! own relative scale, the density of the residuals is
//!
//! ```text
//!     p(r) = w · sσ / (π ((sσ)² + r²)) + (1 − w) / W
//! ```
//!
//! The scale `s` and the share of inliers `w` follow by expectation–maximisation (Dempster, Laird &
//! Rubin 1977). Where a match counts as an inlier follows from both.

use std::f64::consts::PI;

use super::Match;
use crate::geometry::{FundamentalMatrix, median, sampson_distance};

/// Median of the absolute values of a Gaussian distribution, in standard deviations.
pub(in crate::estimate) const MEDIAN: f64 = 0.6745;
/// Half of the 95 % interval of a Gaussian variable, in standard deviations.
pub(super) const WITHIN: f64 = 1.96;
/// Smallest scale, px. Without a limit, a geometry that fits a few matches exactly would outweigh
/// all others. Matches of usual pictures are several times less precise, but a fit to fewer than
/// some 200 matches of a small picture can reach the floor.
pub(in crate::estimate) const LEAST_SCALE: f64 = 0.005;
/// Smallest distance of the share of inliers from 0 and 1, where the likelihood is unbounded.
const LEAST_SHARE: f64 = 0.01;
/// Number of steps of the estimate of scale and share. Twice as many take twice the time.
const ITERATIONS: usize = 30;
/// Distance within which 95 % of the residuals of a Cauchy distribution lie, in scales:
/// `tan(0.95 π / 2)`.
const INLIER_SCALES: f64 = 12.7;

/// Distribution of the residuals of inliers and outliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Scale of the Cauchy distribution of inliers with a σ of 1, px: half of these inliers have a
    /// smaller Sampson distance.
    pub scale: f64,
    /// Share of inliers among the matches, 0 to 1.
    pub inliers: f64,
    /// Width over which the residuals of outliers spread, px.
    pub spread: f64,
}

/// Sampson distance of a match, px, its relative scale, and its prior probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Residual {
    pub distance: f64,
    pub sigma: f64,
    pub prior: f64,
}

/// Residuals of matches about a geometry.
pub(super) fn residuals(f: &FundamentalMatrix, matches: &[Match]) -> Vec<Residual> {
    let of = |m: &Match| Residual { distance: sampson_distance(f, &m.pair), sigma: m.sigma, prior: m.prior };
    matches.iter().map(of).collect()
}

impl Noise {
    /// Estimates the noise from residuals, of which outliers spread over `spread` px.
    pub(super) fn of(residuals: &[Residual], spread: f64) -> Self {
        Self::at_least(LEAST_SCALE, residuals, spread)
    }

    /// Estimates the noise, whose scale is at least `least` px.
    pub(super) fn at_least(least: f64, residuals: &[Residual], spread: f64) -> Self {
        let mut near =
            residuals.iter().filter(|r| 2.0 * r.distance < spread).map(|r| r.distance / r.sigma).peekable();
        if near.peek().is_none() {
            return Self { scale: least, inliers: LEAST_SHARE, spread };
        }
        let mut noise = Self { scale: median(near).max(least), inliers: 0.5, spread };
        let priors: f64 = residuals.iter().map(|r| r.prior).sum();
        for _ in 0..ITERATIONS {
            let (mut shares, mut squares) = (0.0, 0.0);
            for r in residuals {
                let inlier = noise.inlier_probability(r);
                shares += inlier;
                // A Cauchy variable is Gaussian with a random precision; this is its expectation.
                let square = (r.distance / r.sigma).powi(2);
                squares += inlier * 2.0 * square / (1.0 + square / noise.scale.powi(2));
            }
            let scale = (squares / shares.max(f64::MIN_POSITIVE)).sqrt().max(least);
            let inliers = (shares / priors).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
            let settled = (scale / noise.scale).ln().abs() < 1e-3 && (inliers - noise.inliers).abs() < 1e-3;
            noise = Self { scale, inliers, ..noise };
            if settled {
                break;
            }
        }
        noise
    }

    /// Returns the likelihood of a residual, relative to that if all matches were outliers.
    fn ratio(&self, r: &Residual) -> f64 {
        let scale = self.scale * r.sigma;
        let cauchy = scale / (PI * (scale * scale + r.distance * r.distance));
        let inlier = self.inliers * r.prior;
        inlier * cauchy * self.spread + (1.0 - inlier)
    }

    pub(super) fn inlier_probability(&self, r: &Residual) -> f64 {
        1.0 - (1.0 - self.inliers * r.prior) / self.ratio(r)
    }

    /// Returns the distance below which 95 % of the inliers with a σ of 1 lie, px.
    pub fn reach(&self) -> f64 {
        INLIER_SCALES * self.scale
    }

    /// Returns the log-likelihood of residuals, less the value if all were outliers.
    pub(super) fn log_likelihood(&self, residuals: &[Residual]) -> f64 {
        residuals.iter().map(|r| self.ratio(r).ln()).sum()
    }
}

/// Returns how much wider a 95 % interval is if the noise follows from the matches themselves: the quantile
/// of Student's distribution over the Gaussian one, for these degrees of freedom. Above 2, its expansion in
/// `1 / freedom` is right to 4 % (Abramowitz & Stegun 26.7.5).
pub(super) fn widening(freedom: usize) -> f64 {
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
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Cauchy residuals of this scale, and residuals spread over `spread` px.
    fn mixture(right: usize, wrong: usize, scale: f64, spread: f64, seed: u64) -> Vec<Residual> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut all = Vec::new();
        for _ in 0..right {
            let distance = scale * (0.5 * PI * rng.random::<f64>()).tan();
            all.push(Residual { distance, sigma: 1.0, prior: 1.0 });
        }
        for _ in 0..wrong {
            all.push(Residual { distance: 0.5 * spread * rng.random::<f64>(), sigma: 1.0, prior: 1.0 });
        }
        all
    }

    #[test]
    fn scale_and_share_of_inliers_are_those_of_the_mixture() {
        // Standard errors from the Fisher information: √2/√n of the scale, some 0.02 of the share.
        for (scale, seed) in [(0.05, 1), (0.2, 2), (0.6, 3)] {
            let noise = Noise::of(&mixture(1400, 600, scale, 40.0, seed), 40.0);
            assert!((noise.scale / scale - 1.0).abs() < 0.15, "{scale}: {noise:?}");
            assert!((noise.inliers - 0.7).abs() < 0.06, "{scale}: {noise:?}");
        }
    }

    #[test]
    fn matches_of_chance_are_worth_nothing_and_precise_ones_more_than_loose_ones() {
        let worth = |residuals: &[Residual]| Noise::of(residuals, 8.0).log_likelihood(residuals);
        let [precise, loose, chance] =
            [mixture(700, 100, 0.05, 8.0, 4), mixture(850, 0, 0.3, 8.0, 5), mixture(0, 1000, 1.0, 8.0, 6)];
        assert!(worth(&precise) > 1.3 * worth(&loose), "{} {}", worth(&precise), worth(&loose));
        assert!(worth(&chance) < 10.0, "{}", worth(&chance));
    }

    #[test]
    fn the_scale_has_a_floor_and_few_residuals_do_no_harm() {
        let exact = vec![Residual { distance: 0.0, sigma: 1.0, prior: 1.0 }; 20];
        assert!(Noise::of(&exact, 8.0).scale >= LEAST_SCALE);
        let none = Noise::of(&[], 8.0);
        assert!(none.scale.is_finite() && none.log_likelihood(&[]) == 0.0);
    }

    #[test]
    fn an_ambiguous_match_is_less_likely_right() {
        let noise = Noise { scale: 0.1, inliers: 0.9, spread: 8.0 };
        let probability = |prior| noise.inlier_probability(&Residual { distance: 0.4, sigma: 1.0, prior });
        assert!(probability(1.0) > 0.8 && probability(0.2) < 0.5);
        assert!((noise.reach() - 1.27).abs() < 1e-9);
    }
}
