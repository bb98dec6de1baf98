//! Essential matrices that are given in place of fundamental ones.
//!
//! An essential matrix `E = [t]× R` has two equal singular values, and entries of like size, since its rays
//! have coordinates near 1. Entries of a fundamental matrix in pixels differ by the focal length and its
//! square. The fundamental matrix of two parallel cameras, `[e]×`, has equal singular values too, but only its
//! last row and column are large.

use nalgebra::{Matrix2, Matrix3};

/// Largest relative difference of the two singular values, with a block of at least [`LARGE_BLOCK`]. Of the F of
/// 200,000 random pairs of cameras (64 to 4,000 px; turned, ahead, and side by side), one had both. So had 99.9 % of the
/// essential matrices, except of nearly parallel cameras.
const EQUAL: f64 = 1e-2;
/// Least share of the upper left 2×2 block in the norm.
const LARGE_BLOCK: f64 = 2.5e-2;
/// The same for rigs of nearly parallel cameras, whose essential matrices have small blocks. Four digits show
/// this difference, and no F of these pairs has it with such a block.
const CLEARLY_EQUAL: f64 = 1e-4;
const SMALL_BLOCK: f64 = 5e-4;
/// Largest ratio of the third to the first singular value of a matrix that may be essential up to
/// rounding to two digits, with the difference of the other two.
const ROUNDED: f64 = 5e-2;

/// Returns whether a matrix that is given as fundamental is probably an essential one.
pub fn looks_essential(matrix: &Matrix3<f64>) -> bool {
    let Some((different, third, block)) = figures(matrix) else { return false };
    let skew = (matrix + matrix.transpose()).norm() / matrix.norm();
    let is_parallel = skew < SMALL_BLOCK;
    third < EQUAL
        && (different < EQUAL && block > LARGE_BLOCK
            || different < CLEARLY_EQUAL && block > SMALL_BLOCK && !is_parallel)
}

/// Returns whether a matrix of rank 3 is probably an essential one, rounded to few digits.
pub(super) fn is_rounded_essential(matrix: &Matrix3<f64>) -> bool {
    figures(matrix)
        .is_some_and(|(different, third, block)| different < ROUNDED && third < ROUNDED && block > ROUNDED)
}

/// Returns the relative difference of the two larger singular values, the ratio of the smallest to the
/// largest, and the share of the upper left block.
fn figures(matrix: &Matrix3<f64>) -> Option<(f64, f64, f64)> {
    let norm = matrix.norm();
    let is_sound = norm > 0.0 && norm.is_finite();
    let unit = is_sound.then(|| matrix / norm)?;
    let mut values: Vec<f64> = unit.singular_values().iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    let block: Matrix2<f64> = unit.fixed_view::<2, 2>(0, 0).into();
    Some((1.0 - values[1] / values[0], values[2] / values[0], block.norm()))
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3};

    use super::*;
    use crate::geometry::random_scene::RandomScene;

    fn essential(turn: [f64; 3], t: [f64; 3]) -> Matrix3<f64> {
        let rotation = Rotation3::from_scaled_axis(Vector3::from(turn));
        Vector3::from(t).normalize().cross_matrix() * rotation.matrix()
    }

    fn rounded(matrix: &Matrix3<f64>, digits: i32) -> Matrix3<f64> {
        let by = 10_f64.powi(digits);
        matrix.map(|v| (v * by).round() / by)
    }

    #[test]
    fn essential_matrices_are_recognised() {
        for e in [
            essential([0.1, 0.3, -0.05], [1.0, 0.2, 0.3]),
            essential([0.0, 0.02, 0.01], [0.1, 0.0, 1.0]),
            // A rig of nearly parallel cameras.
            essential([0.004, -0.003, 0.002], [-1.0, 0.004, 0.009]),
        ] {
            assert!(looks_essential(&e) && looks_essential(&(e * -3e4)), "{e}");
            assert!(looks_essential(&rounded(&e, 6)), "{e}");
        }
        assert!(is_rounded_essential(&rounded(&essential([0.1, 0.3, -0.05], [1.0, 0.2, 0.3]), 2)));
    }

    #[test]
    fn fundamental_matrices_are_not() {
        for seed in 0..200 {
            assert!(!looks_essential(RandomScene::new(seed).fundamental().matrix()), "{seed}");
        }
        // Parallel cameras: rows, columns, and an epipole inside the picture.
        for e in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [300.0, 200.0, 1.0]] {
            let f = Vector3::from(e).cross_matrix();
            assert!(!looks_essential(&f), "{f}");
        }
        assert!(!looks_essential(&Matrix3::zeros()));
        // A homography.
        assert!(!looks_essential(&Matrix3::new(1.0, 0.01, 20.0, -0.01, 1.0, 5.0, 1e-5, 0.0, 1.0)));
        assert!(!is_rounded_essential(&Matrix3::identity()));
    }
}
