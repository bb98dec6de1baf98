//! Number of false alarms of a geometry: the expected number of geometries that agree with as many matches
//! as well, if all matches lie anywhere (a contrario; Desolneux, Moisan & Morel 2000, Moisan & Stival 2004).
//!
//! Let `α` be the probability that a match that lies anywhere is as near to its place as the `k`-th nearest of
//! `n` matches. A sample of `s` matches has up to `m` geometries, and the other `n − s` matches test them:
//!
//! ```text
//!     N = m (n − s) C(n, k) C(k, s) α^(k − s)
//! ```
//!
//! The least `N` over all `k` counts, so no width of noise is needed.
//!
//! # Pitfalls
//! - Matches are taken to be independent. Repeated structure agrees on wrong geometries.
//! - Matches that were sought along the lines of a geometry are near these lines by construction.

use crate::geometry::{Frame, FundamentalMatrix, PointPair};

/// Largest number of false alarms of a geometry that chance does not explain: one in a thousand results.
pub(in crate::estimate) const BY_CHANCE: f64 = 1e-3;
/// Smallest error of a position in pictures, px. Nearer matches are no less likely by chance.
pub(in crate::estimate) const PRECISION: f64 = 0.15;

/// Numbers of matches that determine a geometry, and of geometries that fit them.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct Sample {
    pub matches: usize,
    pub geometries: f64,
}

/// Seven matches have up to three fundamental matrices.
pub(in crate::estimate) const OF_LINES: Sample = Sample { matches: 7, geometries: 3.0 };
/// Five matches have up to ten essential matrices.
pub(in crate::estimate) const OF_A_POSE: Sample = Sample { matches: 5, geometries: 10.0 };
/// Four matches have one homography.
pub(in crate::estimate) const OF_A_PLANE: Sample = Sample { matches: 4, geometries: 1.0 };

/// Agreement of matches with a geometry.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct Agreement {
    /// Number of all matches.
    pub matches: usize,
    /// Number of those that agree: the `k` of the least number of false alarms. 0 if they are too few for any.
    pub agreeing: usize,
    /// Largest probability of an agreeing match by chance.
    pub within: f64,
    /// Natural logarithm of the number of false alarms.
    #[cfg_attr(test, serde(deserialize_with = "or_infinite"))]
    pub log_false_alarms: f64,
}

/// Reads a number as JSON has it: infinity is null.
#[cfg(test)]
pub(in crate::estimate) fn or_infinite<'de, D: serde::Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let found: Option<f64> = serde::Deserialize::deserialize(from)?;
    Ok(found.unwrap_or(f64::INFINITY))
}

impl Agreement {
    /// Returns the agreement of matches, each with the probability that chance brings it as near.
    pub fn of(by_chance: impl IntoIterator<Item = f64>, sample: Sample) -> Self {
        let mut by_chance: Vec<f64> = by_chance.into_iter().collect();
        by_chance.sort_by(f64::total_cmp);
        let n = by_chance.len();
        let alarms = FalseAlarms::new(n, sample);
        let with = |k: usize| {
            let within = by_chance[k - 1].clamp(f64::MIN_POSITIVE, 1.0);
            Self { matches: n, agreeing: k, within, log_false_alarms: alarms.log(k, within) }
        };
        let none = Self { matches: n, agreeing: 0, within: 0.0, log_false_alarms: f64::INFINITY };
        (sample.matches + 1..=n).map(with).min_by(Self::by_false_alarms).unwrap_or(none)
    }

    /// Returns the agreement of all matches with epipolar lines. Nearer matches than `least` px are no less
    /// likely by chance.
    pub fn with_lines(
        f: &FundamentalMatrix,
        pairs: impl IntoIterator<Item = PointPair>,
        frames: [Frame; 2],
        least: f64,
    ) -> Self {
        Self::of(pairs.into_iter().map(|pair| near_lines_by_chance(f, &pair, frames, least)), OF_LINES)
    }

    /// Orders by the number of false alarms.
    pub fn by_false_alarms(&self, other: &Self) -> std::cmp::Ordering {
        self.log_false_alarms.total_cmp(&other.log_false_alarms)
    }

    /// Returns whether chance does not explain the agreement.
    pub fn is_no_chance(&self) -> bool {
        self.log_false_alarms <= BY_CHANCE.ln()
    }

    /// Returns the weight of the evidence: the logarithm of how much rarer the agreement is than one false
    /// alarm. 0 for chance.
    pub fn evidence(&self) -> f64 {
        (-self.log_false_alarms).max(0.0)
    }
}

/// Numbers of false alarms of `n` matches.
struct FalseAlarms {
    n: usize,
    sample: Sample,
    log_factorials: Vec<f64>,
}

impl FalseAlarms {
    fn new(n: usize, sample: Sample) -> Self {
        let mut log_factorials = vec![0.0; n + 1];
        for k in 1..=n {
            log_factorials[k] = log_factorials[k - 1] + (k as f64).ln();
        }
        Self { n, sample, log_factorials }
    }

    fn log_choices(&self, n: usize, k: usize) -> f64 {
        self.log_factorials[n] - self.log_factorials[k] - self.log_factorials[n - k]
    }

    /// Returns ln N for `k` matches, more than a sample, of probability `within`.
    fn log(&self, k: usize, within: f64) -> f64 {
        let (n, s) = (self.n, self.sample.matches);
        (self.sample.geometries * (n - s) as f64).ln()
            + self.log_choices(n, k)
            + self.log_choices(k, s)
            + (k - s) as f64 * within.ln()
    }
}

/// Returns the largest number of `n` matches that chance explains on one geometry, each with probability `within`.
pub(in crate::estimate) fn most_by_chance(n: usize, within: f64, sample: Sample) -> usize {
    let alarms = FalseAlarms::new(n, sample);
    let is_chance = |k: &usize| alarms.log(*k, within.clamp(f64::MIN_POSITIVE, 1.0)) > BY_CHANCE.ln();
    (sample.matches + 1..=n).rev().find(is_chance).unwrap_or(sample.matches.min(n))
}

/// Returns the probability that a match that lies anywhere is as near to its epipolar lines, in the image in
/// which it is likelier.
pub(in crate::estimate) fn near_lines_by_chance(
    f: &FundamentalMatrix,
    pair: &PointPair,
    frames: [Frame; 2],
    least: f64,
) -> f64 {
    // Only the epipole has no line. It lies on all of them.
    let distance2 = f.line2_from_point1(pair.point1).map_or(0.0, |line| line.distance(pair.point2));
    let distance1 = f.line1_from_point2(pair.point2).map_or(0.0, |line| line.distance(pair.point1));
    within(distance1.max(least), frames[0]).max(within(distance2.max(least), frames[1]))
}

/// Returns the share of an image within a distance (px) of a line through it. As large a share of a line of mean
/// length is within that distance of one of its points.
pub(in crate::estimate) fn within(distance: f64, frame: Frame) -> f64 {
    let area = (frame.width * frame.height) as f64;
    (2.0 * distance * frame.diagonal() / area).min(1.0)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::estimate::exact::{FRAME, rows};
    use crate::estimate::sampling::{Purpose, stream};

    #[test]
    fn the_number_of_false_alarms_has_its_closed_form() {
        // Eight of ten matches at α = 0.01, two anywhere.
        let by_chance = [0.01; 8].into_iter().chain([0.7, 0.9]);
        let found = Agreement::of(by_chance, OF_LINES);
        let expected: f64 = 3.0 * 3.0 * 45.0 * 8.0 * 0.01;
        assert_eq!(found.matches, 10);
        assert!((found.log_false_alarms - expected.ln()).abs() < 1e-9);
        assert!(!found.is_no_chance() && found.evidence().abs() < 1e-12);
        let more = Agreement::of([0.01; 14], OF_LINES);
        assert!(more.is_no_chance() && more.evidence() > 7.0, "{more:?}");
        // Seven matches fit a geometry exactly, whatever they are.
        assert!(!Agreement::of([0.0; 7], OF_LINES).is_no_chance());
        assert!(!Agreement::of([], OF_A_PLANE).is_no_chance());
    }

    #[test]
    fn one_match_more_than_the_most_by_chance_is_no_chance() {
        for (n, within) in [(20, 0.01), (273, 0.004), (60, 0.2)] {
            let most = most_by_chance(n, within, OF_LINES);
            let agree = |k: usize| {
                let by_chance = (0..n).map(|match_| if match_ < k { within } else { 1.0 });
                Agreement::of(by_chance, OF_LINES).is_no_chance()
            };
            assert!(!agree(most) && agree(most + 1), "{most} of {n}");
        }
        assert_eq!((most_by_chance(5, 0.1, OF_LINES), most_by_chance(30, 1.0, OF_LINES)), (5, 30));
    }

    #[test]
    fn chance_agrees_with_no_geometry() {
        for seed in 0..20 {
            let mut rng = stream(seed, Purpose::PutativePairs, 0);
            let mut at = || (320.0 * rng.random::<f64>(), 240.0 * rng.random::<f64>());
            let anywhere: Vec<PointPair> = (0..200)
                .map(|_| {
                    let ((x, y), (u, v)) = (at(), at());
                    PointPair::new(x, y, u, v)
                })
                .collect();
            let f = rows(0.0);
            let of =
                |pairs: &[PointPair]| Agreement::with_lines(&f, pairs.iter().copied(), [FRAME; 2], PRECISION);
            assert!(!of(&anywhere).is_no_chance(), "{seed}");
            // Thirty right ones among them are no chance.
            let right = (0..30).map(|k| {
                let y = 8.0 * f64::from(k) + 0.5;
                PointPair::new(10.0, y, 200.0, y + 0.2)
            });
            let with: Vec<PointPair> = right.chain(anywhere).collect();
            assert!(of(&with).is_no_chance(), "{seed}");
        }
    }
}
