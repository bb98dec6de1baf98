//! Evidence for the lines of a geometry: matches that were found without any geometry.
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
//!
//! What counts is the lead over the likeliest clearly different geometry, since on repeated structure both are
//! far from chance.

use std::collections::HashMap;
use std::f64::consts::FRAC_2_PI;

use rayon::prelude::*;

use crate::estimate::evidence::patches::UnguidedMatch;
use crate::estimate::fit::false_alarms::Agreement;
use crate::estimate::verdict::trust::LineEvidence;
use crate::geometry::{Frame, FundamentalMatrix, Point, PointPair, sampson_distance};

/// Distance within which matches share their errors, as a share of the longer side.
const NEIGHBOURS: f64 = 0.028;
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
    let witnesses = Witnesses::new(unguided, side);
    let likelihoods: Vec<f64> = rivals.par_iter().map(|rival| witnesses.log_likelihood(rival)).collect();
    LineEvidence {
        likelihood: witnesses.log_likelihood(f),
        rival: likelihoods.into_iter().fold(0.0, f64::max),
        // Numbers in files are finite.
        log_false_alarms: agreement.log_false_alarms.min(f64::MAX),
    }
}

/// Matches found without a geometry.
struct Witnesses {
    pairs: Vec<PointPair>,
    /// Logarithms of the odds of each match from its appearance.
    log_odds: Vec<f64>,
    /// One over the number of matches around each.
    weights: Vec<f64>,
    side: f64,
}

impl Witnesses {
    fn new(unguided: &[UnguidedMatch], side: f64) -> Self {
        let pairs: Vec<PointPair> = unguided.iter().map(|m| m.pair).collect();
        let log_odds = |m: &UnguidedMatch| {
            let prior = f64::from(m.prior).clamp(SUREST, 1.0 - SUREST);
            (prior / (1.0 - prior)).ln()
        };
        Self {
            log_odds: unguided.iter().map(log_odds).collect(),
            weights: crowding(&pairs, NEIGHBOURS * side).into_iter().map(|n| 1.0 / n as f64).collect(),
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
    fn log_likelihood(&self, f: &FundamentalMatrix) -> f64 {
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
    use crate::estimate::fit::false_alarms::PRECISION;
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
        let apart =
            crowding(&[PointPair::new(0.0, 0.0, 0.0, 0.0), PointPair::new(5.0, 0.0, 90.0, 0.0)], 20.0);
        assert_eq!(apart, [1, 1], "near in one image alone");
    }
}
