//! Homographies from matches (Hartley & Zisserman, algorithm 4.2).

use nalgebra::{Matrix3, SMatrix, SVector};

use super::conditioning::conditioning;
use super::{PointPair, finite_point};

/// Fits the homography `x2 ~ H x1` to four or more matches by linear least squares on conditioned
/// coordinates. Returns `None` when the matches do not determine a homography.
pub fn homography(pairs: &[PointPair]) -> Option<Matrix3<f64>> {
    let [t1, t2] = conditioning(pairs)?;
    // Each match gives two rows of b × (H a) = 0: (a, 0, −bx a) and (0, a, −by a). The blocks of
    // the normal equations are a aᵀ times 1, bx, by and bx² + by².
    let mut products = [Matrix3::zeros(); 4];
    for pair in pairs {
        let a = t1 * pair.point1.to_homogeneous();
        let b = t2 * pair.point2.to_homogeneous();
        let of_a = a * a.transpose();
        for (sum, times) in products.iter_mut().zip([1.0, b.x, b.y, b.x * b.x + b.y * b.y]) {
            *sum += of_a * times;
        }
    }
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    let [alone, by_x, by_y, by_both] = products;
    for (at, block) in [([0, 0], alone), ([3, 3], alone), ([0, 6], -by_x), ([3, 6], -by_y), ([6, 6], by_both)]
    {
        normal.fixed_view_mut::<3, 3>(at[0], at[1]).copy_from(&block);
        normal.fixed_view_mut::<3, 3>(at[1], at[0]).copy_from(&block);
    }
    let v = least_eigenvector(&normal);
    let h = t2.try_inverse()? * Matrix3::from_fn(|r, c| v[3 * r + c]) * t1;
    h.iter().all(|x| x.is_finite()).then_some(h)
}

/// Returns the eigenvector of the smallest eigenvalue of a positive semidefinite matrix.
///
/// Inverse iteration is about ten times as fast as a full decomposition, which is the fallback when
/// the iteration does not converge.
fn least_eigenvector(m: &SMatrix<f64, 9, 9>) -> SVector<f64, 9> {
    // The shift is far below any nonzero eigenvalue and far above rounding. The shift leaves the
    // eigenvectors unchanged.
    let shifted = m + SMatrix::identity() * (1e-12 * m.trace());
    if let Some(cholesky) = shifted.cholesky() {
        let mut v = SVector::<f64, 9>::from_fn(|k, _| 1.0 + 0.1 * k as f64).normalize();
        for _ in 0..ITERATIONS {
            let next = cholesky.solve(&v).normalize();
            let settled = (next - v).norm() < 1e-10;
            v = next;
            if settled {
                return v;
            }
        }
    }
    let eigen = m.symmetric_eigen();
    eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned()
}

/// Maximum number of inverse iterations. Each lowers the error by the ratio of the two smallest
/// eigenvalues.
const ITERATIONS: usize = 12;

/// Returns the distance in image 2 between the mapped point of image 1 and its partner, px. The
/// distance is infinite when the point maps to infinity.
pub fn transfer_error(h: &Matrix3<f64>, pair: &PointPair) -> f64 {
    finite_point(&(h * pair.point1.to_homogeneous())).map_or(f64::INFINITY, |p| (p - pair.point2).norm())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::RandomScene;

    #[test]
    fn matches_of_a_plane_give_its_homography_and_those_off_it_do_not_fit() {
        for seed in 0..10 {
            let mut scene = RandomScene::new(seed);
            let plane = scene.planar_pairs(20);
            for n in [4, 20] {
                let h = homography(&plane[..n]).unwrap();
                assert!(plane.iter().all(|pair| transfer_error(&h, pair) < 1e-3), "seed {seed}, {n} matches");
            }
            let h = homography(&plane).unwrap();
            let off = scene.pairs(40).iter().filter(|pair| transfer_error(&h, pair) > 1.0).count();
            assert!(off > 20, "seed {seed}: {off} of 40");
        }
    }

    #[test]
    fn coinciding_points_determine_nothing() {
        assert!(homography(&[PointPair::new(3.0, 4.0, 5.0, 6.0); 4]).is_none());
    }
}
