//! How firm a median is: percentile bootstrap (Efron & Tibshirani, *An Introduction to the Bootstrap*, §13.3).
//!
//! The trials of a pair are drawn again, as many as there are and with repetition, and the median of what was
//! drawn is noted; the middle 95 % of the medians of 2000 such draws are the interval. For the median over pairs,
//! the trials are drawn again within every pair and the pairs stay: they are the test set and not a sample of
//! something larger.
//!
//! A failed trial is an infinite error here too, so an interval may end at infinity. The draws depend on the seed
//! and on the pair alone, so contenders with the same trials are resampled alike.

use rand::RngExt;
use serde::Serialize;

use super::random::{Purpose, generator};
use super::statistics::median;

/// Resampled medians.
const DRAWS: usize = 2000;

/// Part of the resampled medians that lies inside the interval.
const INSIDE: f64 = 0.95;

/// Even from the least to the greatest of fewer trials a true median is covered less than 95 % of the time
/// (`1 − 2·2⁻ⁿ`).
const FEWEST: usize = 6;

/// A 95 % interval, px. Infinite numbers are written as `null`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end, infinite where failures reach into it.
    pub high: f64,
}

/// The errors of one contender on one pair.
#[derive(Debug, Clone)]
pub(super) struct PairErrors<'a> {
    /// Name of the pair.
    pub(super) pair: &'a str,
    /// One a trial, px; infinite where there is no F.
    pub(super) errors: Vec<f64>,
}

/// Interval of the median over pairs of the medians of their trials; with one pair, of its median. `None` where a
/// pair has fewer than six trials.
pub(super) fn interval(samples: &[PairErrors], seed: u64) -> Option<Interval> {
    if samples.is_empty() || samples.iter().any(|s| s.errors.len() < FEWEST) {
        return None;
    }
    // One column of resampled medians a pair.
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

    /// Different numbers between 0 and 1 without order, median ½.
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
        // 95 % of 300 is 285 with a standard deviation of 4; of 25 trials the percentile method takes order
        // statistics, so a few per cent either way are its own.
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
