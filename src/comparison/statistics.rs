//! Summary statistics in which a failed trial counts as an infinite error.

/// Returns the median, or NaN without values. For an even number it is the mean of the middle two.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => f64::midpoint(sorted[n / 2 - 1], sorted[n / 2]),
    }
}

/// Returns the arithmetic mean, infinite if a value is, or NaN without values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns the fraction of the values below the limit, 0 to 1, or NaN without values.
pub fn share_below(values: &[f64], limit: f64) -> f64 {
    values.iter().filter(|v| **v < limit).count() as f64 / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_of_odd_and_even_numbers_of_values() {
        assert!((median(&[3.0, 1.0, 2.0]) - 2.0).abs() < 1e-12);
        assert!((median(&[4.0, 1.0, 2.0, 3.0]) - 2.5).abs() < 1e-12);
        assert!(median(&[]).is_nan() && mean(&[]).is_nan() && share_below(&[], 1.0).is_nan());
    }

    #[test]
    fn failures_count_as_infinite_errors() {
        let errors = [0.5, f64::INFINITY, 2.0];
        assert!((median(&errors) - 2.0).abs() < 1e-12);
        assert!(mean(&errors).is_infinite());
        assert!((share_below(&errors, 1.0) - 1.0 / 3.0).abs() < 1e-12);
        assert!(median(&[0.5, f64::INFINITY]).is_infinite());
        assert!(median(&[f64::INFINITY; 2]).is_infinite());
    }
}
