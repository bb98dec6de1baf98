//! Likelihood of epipolar lines from matches that were found without them.
//!
//! Right matches lie near the lines of the right geometry, wrong ones anywhere. With `r` the Sampson distance of a
//! match, `π` its probability of being right and `c` the density of `r` near 0 for wrong matches, the log-likelihood
//! relative to chance is
//!
//! ```text
//!     Λ(F) = Σ u ln(1 − π + π f(r) / c),    f(r) = 2 s / (π (s² + r²)),    logit π = t + logit a
//! ```
//!
//! with `a` the probability from appearance alone. The scale `s` and the offset `t` follow by
//! expectation–maximisation. `c` is measured on the same points, paired with each other's partners. Neighbours
//! share their errors, so a match counts as one over the number of matches around it in both images, `u`.

use std::collections::HashMap;
use std::f64::consts::FRAC_2_PI;

use rayon::prelude::*;

use crate::geometry::{FundamentalMatrix, Point, PointPair, sampson_distance};

/// Smallest and largest scale of the distances of right matches, as a share of the longer side.
const SCALES: [f64; 2] = [2e-4, 4e-3];
/// Starts of scale and offset: precise matches, most of them right, and the reverse.
const STARTS: [(f64, f64); 2] = [(5e-4, 0.0), (2e-3, -3.0)];
/// Largest offset of the log-odds. Beyond it, no match or each match is right.
const MOST_OFFSET: f64 = 9.0;
/// Largest number of steps from each start.
const STEPS: usize = 40;
/// Distance near 0 in which chance is counted, as a share of the longer side.
const NEAR: f64 = 0.02;
/// Number of ways in which all points are paired wrongly.
const PAIRINGS: usize = 8;
/// Smallest distance of a probability from 0 and 1.
const SUREST: f64 = 1e-3;

/// Matches found without a geometry, as evidence for lines.
pub(in crate::estimate) struct LineLikelihood {
    pairs: Vec<PointPair>,
    /// Logarithms of the odds of each match from its appearance.
    log_odds: Vec<f64>,
    /// One over the number of matches around each.
    weights: Vec<f64>,
    side: f64,
}

impl LineLikelihood {
    /// Takes pairs with their probabilities. Those within `neighbours` px share their errors; `side` is the longer
    /// side of the images, px.
    pub fn new(matches: impl Iterator<Item = (PointPair, f64)>, neighbours: f64, side: f64) -> Self {
        let log_odds = |(pair, prior): (PointPair, f64)| {
            let prior = prior.clamp(SUREST, 1.0 - SUREST);
            (pair, (prior / (1.0 - prior)).ln())
        };
        let (pairs, log_odds): (Vec<PointPair>, _) = matches.map(log_odds).unzip();
        Self {
            log_odds,
            weights: crowding(&pairs, neighbours).into_iter().map(|n| 1.0 / n as f64).collect(),
            pairs,
            side,
        }
    }

    fn distances<'a>(
        &'a self,
        f: &'a FundamentalMatrix,
        shift: usize,
    ) -> impl Iterator<Item = f64> + Clone + 'a {
        let n = self.pairs.len();
        self.pairs.iter().enumerate().map(move |(k, pair)| {
            let point2 = self.pairs[(k + shift) % n].point2;
            sampson_distance(f, &PointPair { point2, ..*pair })
        })
    }

    /// Returns the density of the distances of wrong matches near 0, per px.
    fn chance(&self, f: &FundamentalMatrix) -> f64 {
        let n = self.pairs.len();
        let shifts = (1..=PAIRINGS).map(|k| (k * n / (PAIRINGS + 1)).max(1));
        let near =
            shifts.flat_map(|shift| self.distances(f, shift)).filter(|r| *r < NEAR * self.side).count();
        near.max(1) as f64 / (PAIRINGS * n) as f64 / (NEAR * self.side)
    }

    /// Returns the log-likelihood of the matches relative to chance, at the best scale and offset. 0 for chance.
    pub fn log_likelihood(&self, f: &FundamentalMatrix) -> f64 {
        if self.pairs.is_empty() {
            return 0.0;
        }
        let distances: Vec<f64> = self.distances(f, 0).collect();
        let chance = self.chance(f);
        let from = |(scale, offset): (f64, f64)| self.maximum(&distances, chance, scale * self.side, offset);
        STARTS.into_iter().map(from).fold(0.0, f64::max)
    }

    fn maximum(&self, distances: &[f64], chance: f64, mut scale: f64, mut offset: f64) -> f64 {
        let right = |offset: f64, log_odds: f64| 1.0 / (1.0 + (-(offset + log_odds)).exp());
        let density = |scale: f64, r: f64| FRAC_2_PI * scale / (scale * scale + r * r) / chance;
        for _ in 0..STEPS {
            let (mut sum, mut squares, mut slope, mut curvature) = (0.0, 0.0, 0.0, 0.0);
            for ((r, log_odds), weight) in distances.iter().zip(&self.log_odds).zip(&self.weights) {
                let prior = right(offset, *log_odds);
                let with = prior * density(scale, *r);
                let posterior = with / (with + 1.0 - prior);
                sum += weight * posterior;
                // A Cauchy variable is Gaussian with a random precision; this is its expectation.
                squares += weight * posterior * 2.0 * r * r / (1.0 + (r / scale).powi(2));
                slope += weight * (posterior - prior);
                curvature += weight * prior * (1.0 - prior);
            }
            let next = (squares / sum.max(f64::MIN_POSITIVE)).sqrt();
            let next = next.clamp(SCALES[0] * self.side, SCALES[1] * self.side);
            let step = (slope / curvature.max(1e-9)).clamp(-2.0, 2.0);
            let settled = (next / scale).ln().abs() < 1e-4 && step.abs() < 1e-4;
            scale = next;
            offset = (offset + step).clamp(-MOST_OFFSET, MOST_OFFSET);
            if settled {
                break;
            }
        }
        let terms = distances.iter().zip(&self.log_odds).zip(&self.weights).map(|((r, log_odds), weight)| {
            let prior = right(offset, *log_odds);
            weight * (1.0 - prior + prior * density(scale, *r)).ln()
        });
        terms.sum()
    }
}

/// Returns the number of matches within `radius` px of each in both images, itself included.
fn crowding(pairs: &[PointPair], radius: f64) -> Vec<usize> {
    let cell = |at: Point| [at.x, at.y].map(|v| (v / radius).floor() as i64);
    let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for (k, pair) in pairs.iter().enumerate() {
        cells.entry(cell(pair.point1)).or_default().push(k);
    }
    let around = |pair: &PointPair| {
        let [x, y] = cell(pair.point1);
        let places = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
        let near = places.filter_map(|place| cells.get(&place)).flatten();
        near.filter(|k| {
            let other = &pairs[**k];
            (other.point1 - pair.point1).norm() <= radius && (other.point2 - pair.point2).norm() <= radius
        })
        .count()
    };
    pairs.par_iter().map(around).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_crowd_where_they_are_near_in_both_images() {
        let pair = |x1: f64, x2: f64| PointPair::new(x1, 0.0, x2, 0.0);
        assert_eq!(crowding(&[pair(0.0, 0.0), pair(5.0, 90.0)], 20.0), [1, 1]);
        assert_eq!(crowding(&[pair(0.0, 0.0), pair(5.0, 90.0), pair(7.0, 80.0)], 20.0), [1, 2, 2]);
    }
}
