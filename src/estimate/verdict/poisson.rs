//! Poisson distribution.

/// Returns the probability of fewer than `n` events if `mean` events are expected.
pub(super) fn fewer_than(n: usize, mean: f64) -> f64 {
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
