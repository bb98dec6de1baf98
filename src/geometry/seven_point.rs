//! The seven-point algorithm (Hartley & Zisserman, §11.1.2).
//!
//! Seven pairs give seven equations `x2ᵀ F x1 = 0`, which leave a pencil of matrices `a F1 + b F2`.
//! Rank 2 requires `det(a F1 + b F2) = 0`, a binary cubic, so there are one or three real
//! solutions. All solutions fit the seven pairs exactly; only an eighth pair tells them apart.
//!
//! # Pitfalls
//! - The book's `det(λ F1 + (1 − λ) F2)` loses the solution `F1 − F2`, at infinite λ. Here the
//!   basis is rotated until the leading coefficient is far from zero, so every solution has a
//!   finite parameter.
//! - A double root is on the verge of being complex: rounding may give two equal solutions or none.
//! - Six points on one plane (or seven) leave a family of rank-2 matrices; such input is refused.

use nalgebra::{Matrix3, SMatrix};
use thiserror::Error;

use super::conditioning::{conditioning, equation};
use super::{FundamentalMatrix, PointPair};

/// The reason why seven point pairs gave no fundamental matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum SevenPointError {
    /// Not exactly seven pairs.
    #[error("the seven-point algorithm needs exactly 7 point pairs, {0} were given")]
    Count(usize),
    /// The points coincide, or infinitely many matrices fit.
    #[error(
        "these seven point pairs leave infinitely many fundamental matrices: spread them over the images and over depth"
    )]
    Degenerate,
}

/// Minimum ratio of the seventh to the first singular value of the conditioned equations. Below
/// this ratio a third matrix fits all points to about a millionth of a pixel.
const INDEPENDENT: f64 = 1e-9;

/// Minimum magnitude of the largest determinant on the pencil, for matrices of norm 1. The
/// determinant is at most 1/√27; rounding alone makes it about 1e-15.
const DETERMINANT: f64 = 1e-12;

/// Returns all real solutions for exactly seven pairs: one or three, or two at the boundary. Each
/// solution fits all pairs exactly.
pub fn seven_point(pairs: &[PointPair]) -> Result<Vec<FundamentalMatrix>, SevenPointError> {
    if pairs.len() != 7 {
        return Err(SevenPointError::Count(pairs.len()));
    }
    let degenerate = SevenPointError::Degenerate;
    let transforms = conditioning(pairs).ok_or(degenerate)?;
    let [f1, f2] = null_space(pairs, &transforms).ok_or(degenerate)?;
    let roots = roots_on_pencil(&f1, &f2).ok_or(degenerate)?;
    let [t1, t2] = transforms;
    let solutions: Vec<_> = roots
        .into_iter()
        .filter_map(|[a, b]| FundamentalMatrix::nearest_rank_two(a * f1 + b * f2))
        .filter_map(|f| FundamentalMatrix::from_rank_two(t2.transpose() * f.matrix() * t1))
        .collect();
    if solutions.is_empty() { Err(degenerate) } else { Ok(solutions) }
}

/// Returns an orthonormal basis of the matrices that satisfy the seven equations. Returns `None`
/// when the null space has more than two dimensions.
fn null_space(pairs: &[PointPair], transforms: &[Matrix3<f64>; 2]) -> Option<[Matrix3<f64>; 2]> {
    // Two rows of zeros make the decomposition return all nine right singular vectors.
    let mut equations = SMatrix::<f64, 9, 9>::zeros();
    for (mut row, pair) in equations.row_iter_mut().zip(pairs) {
        row.tr_copy_from(&equation(transforms, pair));
    }
    if !equations.iter().all(|v| v.is_finite()) {
        return None;
    }
    // The singular values are in descending order.
    let svd = equations.svd(false, true);
    if svd.singular_values[6] < INDEPENDENT * svd.singular_values[0] {
        return None;
    }
    let v_t = svd.v_t?;
    Some([7, 8].map(|k| Matrix3::from_fn(|r, c| v_t[(k, 3 * r + c)])))
}

/// Returns the unit directions `(a, b)` with `det(a F1 + b F2) = 0`. Returns `None` when the
/// determinant vanishes everywhere.
fn roots_on_pencil(f1: &Matrix3<f64>, f2: &Matrix3<f64>) -> Option<Vec<[f64; 2]>> {
    // The determinant is a cubic in (a, b), so one of six directions over half a turn is far from
    // its zeros.
    let (angle, largest) = (0..6)
        .map(|k| f64::from(k) * std::f64::consts::PI / 6.0)
        .map(|angle| (angle, (angle.cos() * f1 + angle.sin() * f2).determinant()))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    if largest.abs() < DETERMINANT {
        return None;
    }
    let (sin, cos) = angle.sin_cos();
    let (g1, g2) = (cos * f1 + sin * f2, cos * f2 - sin * f1);
    let coefficients = determinant_on_pencil(&g1, &g2).map(|c| c / largest);
    let direction = |mu: f64| {
        let norm = mu.hypot(1.0);
        [(mu * cos - sin) / norm, (mu * sin + cos) / norm]
    };
    Some(real_roots(coefficients).into_iter().map(direction).collect())
}

/// Returns `c0, c1, c2` of
/// `det(μ G1 + G2) = μ³ det G1 + μ² tr(adj(G1) G2) + μ tr(adj(G2) G1) + det G2`.
pub(crate) fn determinant_on_pencil(g1: &Matrix3<f64>, g2: &Matrix3<f64>) -> [f64; 3] {
    let mixed = |g: &Matrix3<f64>, h: &Matrix3<f64>| -> f64 {
        let column = |m: &Matrix3<f64>, k: usize| m.column(k).into_owned();
        (0..3)
            .map(|k| {
                let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                column(h, k).dot(&column(g, next).cross(&column(g, last)))
            })
            .sum()
    };
    [g2.determinant(), mixed(g2, g1), mixed(g1, g2)]
}

/// Largest imaginary part, relative to the root, that rounding gives to a double root.
const DOUBLE: f64 = 1e-7;

/// Returns the real roots of `μ³ + c2 μ² + c1 μ + c0`: eigenvalues of the companion matrix,
/// polished by Newton's method.
fn real_roots([c0, c1, c2]: [f64; 3]) -> Vec<f64> {
    let companion = Matrix3::new(0.0, 0.0, -c0, 1.0, 0.0, -c1, 0.0, 1.0, -c2);
    let polished = |mut mu: f64| {
        for _ in 0..3 {
            let value = ((mu + c2) * mu + c1) * mu + c0;
            let step = value / ((3.0 * mu + 2.0 * c2) * mu + c1);
            // At a double root the slope vanishes and a Newton step leads anywhere.
            let small = step.abs() <= DOUBLE * (1.0 + mu.abs());
            mu -= if small { step } else { 0.0 };
        }
        mu
    };
    companion
        .complex_eigenvalues()
        .iter()
        .filter(|root| root.im.abs() <= DOUBLE * (1.0 + root.re.abs()))
        .map(|root| polished(root.re))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::RandomScene;
    use crate::geometry::{algebraic_residual, symmetric_epipolar_distance};

    fn mean_distance(f: &FundamentalMatrix, pairs: &[PointPair]) -> f64 {
        pairs.iter().map(|p| symmetric_epipolar_distance(f, p)).sum::<f64>() / pairs.len() as f64
    }

    fn best(solutions: &[FundamentalMatrix], pairs: &[PointPair]) -> f64 {
        solutions.iter().map(|f| mean_distance(f, pairs)).fold(f64::INFINITY, f64::min)
    }

    /// Returns the number of sign changes of the determinant over half a turn of the pencil, which
    /// is the number of solutions.
    fn sign_changes(pairs: &[PointPair]) -> usize {
        let [f1, f2] = null_space(pairs, &conditioning(pairs).unwrap()).unwrap();
        let value = |k: i32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 20_000.0).sin_cos();
            (cos * f1 + sin * f2).determinant()
        };
        (0..20_000).filter(|k| (value(*k) < 0.0) != (value(k + 1) < 0.0)).count()
    }

    #[test]
    fn the_truth_is_among_one_or_three_solutions() {
        let mut seen = [0; 4];
        for seed in 0..100 {
            let pairs = RandomScene::new(seed).pairs(40);
            let solutions = seven_point(&pairs[..7]).unwrap();
            assert_eq!(solutions.len(), sign_changes(&pairs[..7]), "seed {seed}");
            seen[solutions.len()] += 1;
            let error = best(&solutions, &pairs);
            assert!(error < 1e-4, "seed {seed}: {error}");
            for f in &solutions {
                assert!(f.matrix().determinant().abs() < 1e-12);
                for pair in &pairs[..7] {
                    assert!(algebraic_residual(f, pair).abs() < 1e-6, "seed {seed}");
                }
            }
        }
        assert!(seen[1] >= 10 && seen[3] >= 10, "both cases must occur: {seen:?}");
    }

    #[test]
    fn the_order_of_the_points_does_not_matter() {
        for seed in 0..20 {
            let pairs = RandomScene::new(seed).pairs(7);
            let turned: Vec<_> = (0..7).map(|k| pairs[(3 * k + 2) % 7]).collect();
            let (one, other) = (seven_point(&pairs).unwrap(), seven_point(&turned).unwrap());
            assert_eq!(one.len(), other.len());
            for f in &one {
                let nearest = other.iter().map(|g| (f.matrix() - g.matrix()).norm()).fold(1.0, f64::min);
                assert!(nearest < 1e-6, "seed {seed}: {nearest}");
            }
        }
    }

    #[test]
    fn the_error_is_proportional_to_small_noise() {
        let error = |sigma: f64| {
            let mut errors: Vec<f64> = (0..100)
                .map(|seed| {
                    let mut scene = RandomScene::new(seed);
                    let exact = scene.pairs(60);
                    let noisy = scene.disturbed(&exact[..7], sigma);
                    let solutions = seven_point(&noisy).unwrap();
                    for f in &solutions {
                        // A minimal solution fits its noisy points.
                        assert!(mean_distance(f, &noisy) < 1e-3 * sigma);
                    }
                    best(&solutions, &exact)
                })
                .collect();
            errors.sort_by(f64::total_cmp);
            errors[50]
        };
        let [tiny, small, usual] = [0.001, 0.01, 0.5].map(error);
        // First order, within the spread of a median and the solutions that noise creates and
        // destroys.
        assert!((9.0..11.0).contains(&(small / tiny)), "{small} / {tiny}");
        assert!(usual > 0.5 && usual < 100.0 * 0.5, "{usual}");
    }

    #[test]
    fn other_numbers_and_degenerate_points_are_refused() {
        let mut scene = RandomScene::new(5);
        let pairs = scene.pairs(8);
        assert_eq!(seven_point(&pairs), Err(SevenPointError::Count(8)));
        assert_eq!(seven_point(&pairs[..6]), Err(SevenPointError::Count(6)));
        let degenerate = Err(SevenPointError::Degenerate);
        assert_eq!(seven_point(&[pairs[0]; 7]), degenerate);
        let twice = [&pairs[..6], &pairs[..1]].concat();
        assert_eq!(seven_point(&twice), degenerate, "six pairs and one of them again");
        assert_eq!(seven_point(&scene.planar_pairs(7)), degenerate);
        let six_planar = [&scene.planar_pairs(6)[..], &pairs[..1]].concat();
        assert_eq!(seven_point(&six_planar), degenerate, "six points of a plane and one off it");
        let mut broken = pairs[..7].to_vec();
        broken[3].point1.x = f64::NAN;
        assert_eq!(seven_point(&broken), degenerate);
        broken[3].point1.x = f64::INFINITY;
        assert_eq!(seven_point(&broken), degenerate);
    }

    #[test]
    fn polynomials_with_known_roots() {
        // (μ + r)(μ + s)(μ + t) with roots −r, −s, −t.
        let coefficients = |[r, s, t]: [f64; 3]| [r * s * t, r * s + s * t + t * r, r + s + t];
        for roots in [[1.0, 2.0, 3.0], [-0.5, 0.0, 40.0], [1e-6, -1.0, 1000.0]] {
            let mut found = real_roots(coefficients(roots.map(|r| -r)));
            found.sort_by(f64::total_cmp);
            let mut expected = roots;
            expected.sort_by(f64::total_cmp);
            assert_eq!(found.len(), 3);
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{found:?}");
            }
        }
        // (μ − 2)(μ² + 1).
        let one = real_roots([-2.0, 1.0, -2.0]);
        assert!(one.len() == 1 && (one[0] - 2.0).abs() < 1e-14);
        // (μ − 1)²(μ + 3): the double root may be found once, twice or not at all, the simple root
        // always.
        let double = real_roots([3.0, -5.0, 1.0]);
        assert!(double.iter().any(|r| (r + 3.0).abs() < 1e-14));
        assert!(double.iter().all(|r| (r + 3.0).abs() < 1e-14 || (r - 1.0).abs() < 1e-6), "{double:?}");
    }
}
