//! Whether two geometries differ by more than the covariance of one of them allows.
//!
//! `F` has seven degrees of freedom. With `δ` the difference of the nine entries, both matrices with norm
//! 1, and `C` their covariance of rank 7, `δᵀ C⁺ δ` has a χ² distribution with seven degrees of freedom
//! if chance explains the difference (Hartley & Zisserman, §5.2.3). The distribution holds to first
//! order.

use nalgebra::{Matrix3, SVector};
use serde::Serialize;

use crate::geometry::{Frame, FundamentalMatrix, Matrix9, pixels_from_half_diagonals};

type Vector9 = SVector<f64, 9>;

/// 99.9 % quantile of the χ² distribution with seven degrees of freedom.
const BY_CHANCE: f64 = 24.3;
/// Degrees of freedom of a fundamental matrix.
const FREEDOM: usize = 7;

/// Difference of a geometry from the reference, measured by a covariance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Significance {
    /// Squared difference in standard deviations, summed over seven degrees of freedom.
    pub chi_square: f64,
    /// Value that chance exceeds once in a thousand.
    pub limit: f64,
    /// Whether `chi_square` exceeds `limit`.
    pub is_significant: bool,
}

/// Measures the difference between `given` and `reference`. `covariance` belongs to the nine
/// entries of `reference` with norm 1, row by row. `None` if the covariance has less than rank 7.
pub(super) fn significance(
    given: &FundamentalMatrix,
    reference: &FundamentalMatrix,
    covariance: &Matrix9,
    frames: [Frame; 2],
) -> Option<Significance> {
    // In pixels, entries differ by six orders of magnitude.
    let [from1, from2] = frames.map(pixels_from_half_diagonals);
    let map = |m: &Matrix3<f64>| from2.transpose() * m * from1;
    let entries = |m: &Matrix3<f64>| Vector9::from_fn(|k, _| m[(k / 3, k % 3)]);
    let own = reference.matrix() / reference.matrix().norm();
    let norm = map(&own).norm();
    let mean = entries(&(map(&own) / norm));
    let columns: [Vector9; 9] = std::array::from_fn(|k| {
        let mut entry = Matrix3::zeros();
        entry[(k / 3, k % 3)] = 1.0;
        let moved = entries(&map(&entry)) / norm;
        moved - mean * mean.dot(&moved)
    });
    let jacobian = Matrix9::from_columns(&columns);
    let eigen = (jacobian * covariance * jacobian.transpose()).symmetric_eigen();
    let other = entries(&map(given.matrix())).normalize();
    let difference = if other.dot(&mean) < 0.0 { -other - mean } else { other - mean };
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let mut chi_square = 0.0;
    for k in &order[..FREEDOM] {
        let variance = eigen.eigenvalues[*k];
        if variance <= f64::EPSILON * eigen.eigenvalues[order[0]] {
            return None;
        }
        chi_square += eigen.eigenvectors.column(*k).dot(&difference).powi(2) / variance;
    }
    let found = Significance { chi_square, limit: BY_CHANCE, is_significant: chi_square > BY_CHANCE };
    chi_square.is_finite().then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::RandomScene;
    use crate::judge::tests::fitted;

    const FRAMES: [Frame; 2] = [Frame { width: 768, height: 576 }; 2];

    #[test]
    fn the_truth_differs_as_chance_explains_and_other_geometries_more() {
        let (mut sum, mut significant) = (0.0, 0);
        let runs = 60;
        for seed in 0..runs {
            let mut scene = RandomScene::new(seed);
            let truth = scene.fundamental();
            let exact = scene.pairs(150);
            let noisy = scene.disturbed(&exact, 0.5);
            let (fit, covariance) = fitted(&truth, &noisy, 0.5);
            let found = significance(&truth, &fit, &covariance, FRAMES).unwrap();
            sum += found.chi_square;
            significant += usize::from(found.is_significant);
            // The scale and the sign of a matrix say nothing.
            let scaled = FundamentalMatrix::from_rank_two(truth.matrix() * -3.0).unwrap();
            let same = significance(&scaled, &fit, &covariance, FRAMES).unwrap();
            assert!((same.chi_square / found.chi_square - 1.0).abs() < 1e-6);
            let other = RandomScene::new(seed + 1000).fundamental();
            assert!(significance(&other, &fit, &covariance, FRAMES).unwrap().is_significant);
        }
        // The mean of χ² is 7 with a deviation of √14 / √60 = 0.5.
        let mean = sum / runs as f64;
        assert!((5.5..8.5).contains(&mean) && significant <= 1, "{mean} {significant}");
    }

    #[test]
    fn a_covariance_without_all_directions_tells_nothing() {
        let f = RandomScene::new(1).fundamental();
        assert!(significance(&f, &f, &Matrix9::zeros(), FRAMES).is_none());
    }
}
