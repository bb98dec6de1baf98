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
use crate::geometry::{FundamentalMatrix, sampson_distance};

/// Smallest scale, px: bilinear interpolation alone leaves errors of this size. Without a floor a
/// geometry that passes a few matches exactly would outweigh all others.
pub(super) const LEAST_SCALE: f64 = 0.02;
/// Shares of inliers stay away from 0 and 1, where the likelihood has no bound.
const LEAST_SHARE: f64 = 0.01;
const ITERATIONS: usize = 30;

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

/// Sampson distance of a match, px, and its relative scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Residual {
    pub distance: f64,
    pub sigma: f64,
    pub prior: f64,
}

/// Residuals of matches about a geometry.
pub(super) fn residuals(f: &FundamentalMatrix, matches: &[Match]) -> Vec<Residual> {
    let of =
        |m: &Match| Residual { distance: sampson_distance(f, &m.pair), sigma: m.sigma, prior: m.prior };
    matches.iter().map(of).collect()
}

impl Noise {
    /// Estimates the noise from residuals, of which outliers spread over `spread` px.
    pub(super) fn of(residuals: &[Residual], spread: f64) -> Self {
        let mut near: Vec<f64> =
            residuals.iter().filter(|r| 2.0 * r.distance < spread).map(|r| r.distance / r.sigma).collect();
        let middle = near.len() / 2;
        if near.is_empty() {
            return Self { scale: LEAST_SCALE, inliers: LEAST_SHARE, spread };
        }
        let median = *near.select_nth_unstable_by(middle, f64::total_cmp).1;
        let mut noise = Self { scale: median.max(LEAST_SCALE), inliers: 0.5, spread };
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
            let scale = (squares / shares.max(f64::MIN_POSITIVE)).sqrt().max(LEAST_SCALE);
            let inliers = (shares / priors).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
            let settled =
                (scale / noise.scale).ln().abs() < 1e-3 && (inliers - noise.inliers).abs() < 1e-3;
            noise = Self { scale, inliers, ..noise };
            if settled {
                break;
            }
        }
        noise
    }

    /// How many times as likely a residual is as if all matches were outliers.
    fn ratio(&self, r: &Residual) -> f64 {
        let scale = self.scale * r.sigma;
        let cauchy = scale / (PI * (scale * scale + r.distance * r.distance));
        let inlier = self.inliers * r.prior;
        inlier * cauchy * self.spread + (1.0 - inlier)
    }

    /// Probability that a match is an inlier.
    pub(super) fn inlier_probability(&self, r: &Residual) -> f64 {
        1.0 - (1.0 - self.inliers * r.prior) / self.ratio(r)
    }

    /// Distance at which a match with a σ of 1 is as likely an outlier as an inlier, px.
    pub fn reach(&self) -> f64 {
        let odds = self.inliers / (1.0 - self.inliers);
        (self.scale * (odds * self.spread / PI - self.scale)).max(0.0).sqrt()
    }

    /// Log-likelihood of residuals, less that of outliers alone.
    pub(super) fn log_likelihood(&self, residuals: &[Residual]) -> f64 {
        residuals.iter().map(|r| self.ratio(r).ln()).sum()
    }
}
