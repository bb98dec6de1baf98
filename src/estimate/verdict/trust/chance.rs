//! What chance explains: binomial and Poisson distributions.

use crate::estimate::fit::false_alarms::BY_CHANCE;
use crate::estimate::verdict::constants::BOUND_DEVIATIONS;

/// Returns the lower bound of a share of which `some` of `all` were seen (Wilson's interval,
/// one-sided, 95 %).
pub(super) fn at_least(some: usize, all: usize) -> f64 {
    let z = BOUND_DEVIATIONS;
    let n = all.max(1) as f64;
    let share = some as f64 / n;
    let spread = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    (share + z * z / (2.0 * n) - spread) / (1.0 + z * z / n)
}

/// Returns the probability that at most `few` of `n` trials fail if each succeeds with probability `p`.
pub(super) fn tail(few: usize, n: usize, p: f64) -> f64 {
    let odds = ((1.0 - p) / p).ln();
    let mut log_term = n as f64 * p.ln();
    let mut sum = log_term.exp();
    for k in 1..=few {
        log_term += ((n - k + 1) as f64 / k as f64).ln() + odds;
        sum += log_term.exp();
    }
    sum.min(1.0)
}

/// Returns whether chance seldom gives so many of all, where each is one of them with probability `share`.
pub(super) fn is_more_than(share: f64, some: usize, all: usize) -> bool {
    tail(all - some, all, share) <= BY_CHANCE
}

/// Returns the probability of fewer than `n` events if `mean` events are expected.
pub(in crate::estimate::verdict) fn fewer_than(n: usize, mean: f64) -> f64 {
    let mut term = (-mean).exp();
    let mut fewer = 0.0;
    for k in 0..n {
        fewer += term;
        term *= mean / (k + 1) as f64;
    }
    fewer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_event_has_its_closed_form_and_all_counts_together_are_certain() {
        assert!(fewer_than(0, 2.5).abs() < 1e-12);
        assert!((fewer_than(1, 2.5) - (-2.5_f64).exp()).abs() < 1e-12);
        assert!((fewer_than(60, 2.5) - 1.0).abs() < 1e-12);
    }
}
