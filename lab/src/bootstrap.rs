//! Confidence interval of a median: percentile bootstrap (Efron & Tibshirani, *An Introduction to
//! the Bootstrap*, §13.3).
//!
//! The trials of a pair are resampled with replacement 2000 times. The interval spans the middle 95
//! % of the resampled medians. For the median over pairs, trials are resampled within each pair and
//! the pairs stay fixed: they are the test set, not a sample.
//!
//! A failed trial is an infinite error here too, so an interval may end at infinity. The draws
//! depend only on the seed and the pair, so contenders with the same trials are resampled alike.

use rand::RngExt;
use serde::Serialize;

use super::median;
use epiline::internals::comparison::{Purpose, generator};

/// Number of resampled medians.
const DRAWS: usize = 2000;

/// Fraction of the resampled medians inside the interval.
const INSIDE: f64 = 0.95;

/// Minimum number of trials. With fewer, even the range of all trials covers the true median less
/// than 95 % of the time (`1 − 2·2⁻ⁿ`).
const FEWEST: usize = 6;

/// 95 % confidence interval, px. Infinite numbers are serialised as `null`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end, infinite if failures reach it.
    pub high: f64,
}

/// Errors of one contender on one pair.
#[derive(Debug, Clone)]
pub(super) struct PairErrors<'a> {
    /// Name of the pair.
    pub(super) pair: &'a str,
    /// Error of each trial, px; infinite without an F.
    pub(super) errors: Vec<f64>,
}

/// Returns the interval of the median over pairs of the pair medians; for one pair, of its median.
/// `None` if a pair has fewer than six trials.
pub(super) fn interval(samples: &[PairErrors], seed: u64) -> Option<Interval> {
    if samples.is_empty() || samples.iter().any(|s| s.errors.len() < FEWEST) {
        return None;
    }
    // One column of resampled medians per pair.
    let columns: Vec<Vec<f64>> = samples.iter().map(|s| resampled_medians(s, seed)).collect();
    let mut medians: Vec<f64> =
        (0..DRAWS).map(|k| median(&columns.iter().map(|c| c[k]).collect::<Vec<_>>())).collect();
    medians.sort_by(f64::total_cmp);
    let place = |share: f64| medians[(share * (DRAWS - 1) as f64).round() as usize];
    Some(Interval { low: place(0.5 * (1.0 - INSIDE)), high: place(0.5 * (1.0 + INSIDE)) })
}

fn resampled_medians(sample: &PairErrors, seed: u64) -> Vec<f64> {
    let mut random = generator(seed, sample.pair, Purpose::Bootstrap, 0);
    let errors = &sample.errors;
    (0..DRAWS)
        .map(|_| {
            let drawn: Vec<f64> =
                errors.iter().map(|_| errors[random.random_range(0..errors.len())]).collect();
            median(&drawn)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(errors: &[f64], seed: u64) -> Option<Interval> {
        interval(&[PairErrors { pair: "a", errors: errors.to_vec() }], seed)
    }

    /// Returns unordered distinct numbers between 0 and 1, with median ½.
    fn numbers(count: usize, start: usize) -> Vec<f64> {
        (0..count).map(|k| ((start + k) as f64 * 0.618_033_988_75).fract()).collect()
    }

    #[test]
    fn is_the_same_for_the_same_seed_and_needs_six_trials() {
        let errors = numbers(25, 0);
        assert_eq!(of(&errors, 1), of(&errors, 1));
        assert!(of(&errors[..6], 1).is_some());
        assert_eq!(of(&errors[..5], 1), None);
        assert_eq!(interval(&[], 1), None);
        let good = PairErrors { pair: "a", errors: errors.clone() };
        let small = PairErrors { pair: "b", errors: errors[..5].to_vec() };
        assert_eq!(interval(&[good, small], 1), None);
    }

    #[test]
    fn covers_the_true_median_about_as_often_as_it_says() {
        let mut covered = 0;
        for set in 0..300 {
            let mut random = generator(set, "set", Purpose::Noise, 0);
            let errors: Vec<f64> = (0..25).map(|_| random.random::<f64>()).collect();
            let Interval { low, high } = of(&errors, set).unwrap();
            assert!(low <= median(&errors) && median(&errors) <= high);
            covered += usize::from((low..=high).contains(&0.5));
        }
        // 95 % of 300 is 285, with a standard deviation of 4. The percentile method uses order
        // statistics, so with 25 trials its coverage deviates by a few per cent.
        assert!((270..=298).contains(&covered), "{covered}");
    }

    #[test]
    fn shrinks_with_more_trials_and_with_more_pairs() {
        let width = |i: Option<Interval>| i.map(|i| i.high - i.low).unwrap();
        let [few, many] = [10, 250].map(|n| width(of(&numbers(n, 0), 3)));
        assert!(few > 2.0 * many, "{few} {many}");
        let pairs: Vec<_> = ["a", "b", "c", "d", "e", "f", "g", "h", "i"]
            .into_iter()
            .enumerate()
            .map(|(k, pair)| PairErrors { pair, errors: numbers(10, 37 * k) })
            .collect();
        let nine = width(interval(&pairs, 3));
        assert!(few > 1.5 * nine, "{few} {nine}");
    }

    #[test]
    fn failures_reach_into_it() {
        let mut errors = numbers(10, 0);
        for failed in &mut errors[..4] {
            *failed = f64::INFINITY;
        }
        let found = of(&errors, 0).unwrap();
        assert!(found.low < 1.0 && found.high.is_infinite(), "{found:?}");
        assert!(serde_json::to_value(found).unwrap()["high"].is_null());
        assert!(of(&[f64::INFINITY; 8], 0).unwrap().low.is_infinite());
    }
}
