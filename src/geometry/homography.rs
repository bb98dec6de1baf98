//! Homographies from matches (Hartley & Zisserman, algorithm 4.2).

use nalgebra::{Matrix3, SMatrix, SVector};

use super::conditioning::conditioning;
use super::{PointPair, finite_point};

/// The homography `x2 ~ H x1` of four or more matches by linear least squares on conditioned coordinates; `None` when
/// they do not determine one.
pub fn homography(pairs: &[PointPair]) -> Option<Matrix3<f64>> {
    let [t1, t2] = conditioning(pairs)?;
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for pair in pairs {
        let a = t1 * pair.point1.to_homogeneous();
        let b = t2 * pair.point2.to_homogeneous();
        // Two rows of b × (H a) = 0.
        for (k, l) in [(0, b.x), (1, b.y)] {
            let row = SVector::<f64, 9>::from_fn(|i, _| match i / 3 {
                r if r == k => a[i % 3],
                2 => -l * a[i % 3],
                _ => 0.0,
            });
            normal += row * row.transpose();
        }
    }
    let eigen = normal.symmetric_eigen();
    let v = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    let h = t2.try_inverse()? * Matrix3::from_fn(|r, c| v[3 * r + c]) * t1;
    h.iter().all(|x| x.is_finite()).then_some(h)
}

/// How far the point of image 2 is from where the homography maps that of image 1, px; infinite when it maps it to
/// infinity.
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
