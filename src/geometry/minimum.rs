//! Minimum of a function of one number.

/// Returns the minimiser of a unimodal function between two ends, to about 10⁻¹⁶ of their
/// distance, by a golden section search.
pub fn golden_section(cost: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_895;
    for _ in 0..80 {
        let (a, b) = (high - (high - low) * SHARE, low + (high - low) * SHARE);
        if cost(a) < cost(b) {
            high = b;
        } else {
            low = a;
        }
    }
    f64::midpoint(low, high)
}

/// Returns the minimiser of a function over a range: the best of a grid with a step, made precise by
/// a golden section search to its neighbours.
pub fn grid_minimum(cost: impl Fn(f64) -> f64, (low, high): (f64, f64), step: f64) -> f64 {
    let count = ((high - low) / step).round() as usize;
    let grid = (0..=count).map(|k| low + k as f64 * step).map(|at| (cost(at), at));
    let best = grid.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(low, |(_, at)| at);
    golden_section(cost, best - step, best + step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_of_several_minima_is_found() {
        // Minima near every multiple of 2π; the parabola decides for the one next to 6.
        let cost = |x: f64| (x - 6.0).powi(2) * 0.01 - x.cos();
        let at = grid_minimum(cost, (-10.0, 20.0), 0.5);
        assert!((at - 6.2776).abs() < 1e-3, "{at}");
        let slope = 0.02 * (at - 6.0) + at.sin();
        assert!(slope.abs() < 1e-6, "{slope}");
    }
}
