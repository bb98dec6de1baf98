//! How far a point pair is from satisfying a fundamental matrix.

use super::{FundamentalMatrix, PointPair};

/// Mean of the two distances from a point to the epipolar line of its partner, px. Infinite when a point
/// is an epipole, where no line is defined.
pub fn symmetric_epipolar_distance(f: &FundamentalMatrix, pair: &PointPair) -> f64 {
    match (f.line2_from_point1(pair.point1), f.line1_from_point2(pair.point2)) {
        (Some(line2), Some(line1)) => 0.5 * (line2.distance(pair.point2) + line1.distance(pair.point1)),
        _ => f64::INFINITY,
    }
}

/// First-order distance of the pair to the manifold `x2ᵀ F x1 = 0`, px: the square root of the Sampson
/// error (Hartley & Zisserman, eq. 11.9).
pub fn sampson_distance(f: &FundamentalMatrix, pair: &PointPair) -> f64 {
    let l2 = f.matrix() * pair.point1.to_homogeneous();
    let l1 = f.matrix().tr_mul(&pair.point2.to_homogeneous());
    algebraic_residual(f, pair).abs() / (l2.xy().norm_squared() + l1.xy().norm_squared()).sqrt()
}

/// `x2ᵀ F x1`, signed, no geometric unit (depends on the norm of `F`, which is 1 here).
pub fn algebraic_residual(f: &FundamentalMatrix, pair: &PointPair) -> f64 {
    pair.point2.to_homogeneous().dot(&(f.matrix() * pair.point1.to_homogeneous()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    /// Pure sideways motion: epipolar lines are rows.
    fn sideways() -> FundamentalMatrix {
        FundamentalMatrix::from_rank_two(Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)).unwrap()
    }

    #[test]
    fn rows_measure_vertical_differences() {
        let pair = PointPair::new(10.0, 20.0, 30.0, 23.0);
        let f = sideways();
        assert!((symmetric_epipolar_distance(&f, &pair) - 3.0).abs() < 1e-12);
        // Both points move half way each: 3/√2.
        assert!((sampson_distance(&f, &pair) - 3.0 / 2f64.sqrt()).abs() < 1e-12);
        assert!((algebraic_residual(&f, &pair).abs() - 3.0 / 2f64.sqrt()).abs() < 1e-12);
    }
}
