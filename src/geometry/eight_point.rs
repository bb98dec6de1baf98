//! The normalised eight-point algorithm (Hartley 1997; Hartley & Zisserman, algorithm 11.1).

use nalgebra::{Matrix3, SMatrix};
use thiserror::Error;

use super::conditioning::{conditioning, equation};
use super::elimination::{Eliminated, Unknowns};
use super::{FundamentalMatrix, PointPair};

/// The reason why point pairs gave no fundamental matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum EightPointError {
    /// Fewer than eight pairs.
    #[error("the eight-point algorithm needs at least 8 point pairs, {0} were given")]
    TooFew(usize),
    /// All points (nearly) coincide, or the configuration is degenerate.
    #[error(
        "these point pairs do not determine a fundamental matrix: spread them over the images and over depth"
    )]
    Degenerate,
}

/// Fits `F` to eight or more point pairs by linear least squares on conditioned coordinates, with
/// rank 2 enforced.
pub fn eight_point(pairs: &[PointPair]) -> Result<FundamentalMatrix, EightPointError> {
    if pairs.len() < 8 {
        return Err(EightPointError::TooFew(pairs.len()));
    }
    let degenerate = EightPointError::Degenerate;
    let transforms = conditioning(pairs).ok_or(degenerate)?;
    let equations = pairs.iter().map(|pair| equation(&transforms, pair));
    let solution =
        if pairs.len() == 8 { solution_of_eight(equations) } else { least_squares_solution(equations) };
    let v = solution.ok_or(degenerate)?;
    let [t1, t2] = transforms;
    let conditioned = Matrix3::from_fn(|r, c| v[3 * r + c]);
    let rank_two = FundamentalMatrix::nearest_rank_two(conditioned).ok_or(degenerate)?;
    FundamentalMatrix::from_rank_two(t2.transpose() * rank_two.matrix() * t1).ok_or(degenerate)
}

/// Minimum ratio of the second smallest to the largest singular value for which the equations
/// determine a matrix.
const DETERMINED: f64 = 3e-7;

/// Returns the unit vector with the smallest sum of squared products with the rows. Returns `None`
/// when the vector is not unique.
fn least_squares_solution(rows: impl Iterator<Item = Unknowns>) -> Option<Unknowns> {
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for row in rows {
        normal += row * row.transpose();
    }
    let eigen = normal.symmetric_eigen();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|i, j| eigen.eigenvalues[*i].total_cmp(&eigen.eigenvalues[*j]));
    let is_determined = eigen.eigenvalues[order[1]] >= DETERMINED * DETERMINED * eigen.eigenvalues[order[8]];
    is_determined.then(|| eigen.eigenvectors.column(order[0]).into_owned())
}

/// Returns the vector orthogonal to eight rows. Returns `None` when the rows are (nearly)
/// dependent.
fn solution_of_eight(rows: impl Iterator<Item = Unknowns>) -> Option<Unknowns> {
    let mut equations = [[0.0; 9]; 8];
    for (equation, row) in equations.iter_mut().zip(rows) {
        *equation = row.into();
    }
    let largest = equations.as_flattened().iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let [solution] = Eliminated::new(equations, DETERMINED * largest)?.solutions();
    solution.try_normalize(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::RandomScene;
    use crate::geometry::symmetric_epipolar_distance;

    #[test]
    fn exact_points_give_the_exact_matrix() {
        for seed in 0..20 {
            let pairs = RandomScene::new(seed).pairs(20);
            for n in [8, 20] {
                let f = eight_point(&pairs[..n]).unwrap();
                for pair in &pairs {
                    // The normal equations square a condition number of up to about 10⁵.
                    assert!(symmetric_epipolar_distance(&f, pair) < 1e-3, "seed {seed}");
                }
            }
        }
    }

    /// Returns the median over many scenes of the mean distance of 100 exact points to the `F` of
    /// `count` noisy points, px.
    fn error(count: usize, sigma: f64) -> f64 {
        let mut errors: Vec<f64> = (0..60)
            .map(|seed| {
                let mut scene = RandomScene::new(seed);
                let exact = scene.pairs(100);
                let noisy = scene.disturbed(&exact[..count], sigma);
                let f = eight_point(&noisy).unwrap();
                assert!(f.matrix().determinant().abs() < 1e-12, "rank 2 under noise");
                exact.iter().map(|p| symmetric_epipolar_distance(&f, p)).sum::<f64>() / 100.0
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        errors[30]
    }

    #[test]
    fn the_error_is_proportional_to_small_noise_and_falls_with_more_points() {
        // First order: a tenth of the noise gives a tenth of the error, within the spread of a
        // median of 60.
        let ratio = error(20, 0.1) / error(20, 0.01);
        assert!((9.0..11.0).contains(&ratio), "{ratio}");
        // Five times as many points lower the error by √5. The minimal sample of eight is even less
        // accurate.
        let [eight, twenty, hundred] = [8, 20, 100].map(|count| error(count, 0.5));
        assert!(eight > 2.0 * twenty && twenty > 1.8 * hundred, "{eight} {twenty} {hundred}");
        assert!(hundred < 0.5, "{hundred}");
    }

    #[test]
    fn too_few_and_degenerate_points_are_refused() {
        let mut scene = RandomScene::new(1);
        let pairs = scene.pairs(12);
        assert_eq!(eight_point(&pairs[..7]), Err(EightPointError::TooFew(7)));
        for n in [8, 9] {
            assert_eq!(eight_point(&vec![pairs[0]; n]), Err(EightPointError::Degenerate));
        }
        // Eight pairs are solved by elimination, more by least squares. Both solvers must detect a
        // repeated pair.
        let seven = [&pairs[..7], &pairs[..1]].concat();
        assert_eq!(eight_point(&seven), Err(EightPointError::Degenerate));
        assert_eq!(eight_point(&seven.repeat(2)), Err(EightPointError::Degenerate));
        for n in [8, 20] {
            assert_eq!(eight_point(&scene.planar_pairs(n)), Err(EightPointError::Degenerate));
        }
    }
}
