//! The normalised eight-point algorithm (Hartley 1997; Hartley & Zisserman, algorithm 11.1).

use nalgebra::{Matrix3, SMatrix, SVector};
use thiserror::Error;

use super::{FundamentalMatrix, Point, PointPair};

/// Why eight or more point pairs gave no fundamental matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum EightPointError {
    /// Fewer than eight pairs.
    #[error("the eight-point algorithm needs at least 8 point pairs, {0} were given")]
    TooFew(usize),
    /// All points (nearly) coincide, or the configuration determines no matrix.
    #[error(
        "these point pairs do not determine a fundamental matrix: spread them over the images and over depth"
    )]
    Degenerate,
}

/// `F` from eight or more point pairs by linear least squares on normalised coordinates, rank 2 enforced.
pub fn eight_point(pairs: &[PointPair]) -> Result<FundamentalMatrix, EightPointError> {
    if pairs.len() < 8 {
        return Err(EightPointError::TooFew(pairs.len()));
    }
    let degenerate = EightPointError::Degenerate;
    let t1 = normalisation(pairs.iter().map(|p| p.point1)).ok_or(degenerate)?;
    let t2 = normalisation(pairs.iter().map(|p| p.point2)).ok_or(degenerate)?;
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for pair in pairs {
        let a = t1 * pair.point1.to_homogeneous();
        let b = t2 * pair.point2.to_homogeneous();
        let row = SVector::<f64, 9>::from_fn(|k, _| b[k / 3] * a[k % 3]);
        normal += row * row.transpose();
    }
    let eigen = normal.symmetric_eigen();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|i, j| eigen.eigenvalues[*i].total_cmp(&eigen.eigenvalues[*j]));
    if eigen.eigenvalues[order[1]] < 1e-13 * eigen.eigenvalues[order[8]] {
        return Err(degenerate);
    }
    let v = eigen.eigenvectors.column(order[0]);
    let conditioned = Matrix3::from_fn(|r, c| v[3 * r + c]);
    let rank_two = FundamentalMatrix::nearest_rank_two(conditioned).ok_or(degenerate)?;
    FundamentalMatrix::from_rank_two(t2.transpose() * rank_two.matrix() * t1).ok_or(degenerate)
}

/// Similarity that moves the centroid to the origin and the mean distance from it to √2.
fn normalisation(points: impl Iterator<Item = Point> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count() as f64;
    let centroid = points.clone().fold(Point::origin(), |sum, p| sum + p.coords) / count;
    let spread = points.map(|p| (p - centroid).norm()).sum::<f64>() / count;
    let s = std::f64::consts::SQRT_2 / spread;
    s.is_finite().then(|| Matrix3::new(s, 0.0, -s * centroid.x, 0.0, s, -s * centroid.y, 0.0, 0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Camera, symmetric_epipolar_distance};

    fn scene() -> Vec<PointPair> {
        let (camera1, camera2) = Camera::example_pair();
        (0..20)
            .map(|k| {
                let t = f64::from(k);
                let x = nalgebra::Point3::new(
                    (t * 0.9).sin() * 2.0,
                    (t * 1.7).cos(),
                    5.0 + (t * 2.3).sin() * 2.0,
                );
                PointPair { point1: camera1.project(&x).unwrap(), point2: camera2.project(&x).unwrap() }
            })
            .collect()
    }

    #[test]
    fn exact_points_give_the_exact_matrix() {
        let pairs = scene();
        for n in [8, 20] {
            let f = eight_point(&pairs[..n]).unwrap();
            for pair in &pairs {
                assert!(symmetric_epipolar_distance(&f, pair) < 1e-5);
            }
        }
    }

    #[test]
    fn too_few_and_degenerate_points_are_refused() {
        let pairs = scene();
        assert_eq!(eight_point(&pairs[..7]), Err(EightPointError::TooFew(7)));
        assert_eq!(eight_point(&[pairs[0]; 9]), Err(EightPointError::Degenerate));
    }
}
