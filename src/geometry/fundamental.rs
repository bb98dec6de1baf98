//! The fundamental matrix.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::{HomogeneousPoint, Line, Point};

/// `F` with `x2ᵀ F x1 = 0`: rank 2, Frobenius norm 1, the entry of largest magnitude positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FundamentalMatrix(Matrix3<f64>);

impl FundamentalMatrix {
    /// Takes a matrix that has rank 2 by construction and brings it to norm and sign. `None` when it is
    /// not finite or has lower rank.
    pub fn from_rank_two(matrix: Matrix3<f64>) -> Option<Self> {
        let norm = matrix.norm();
        if !(norm.is_finite() && norm > 0.0) {
            return None;
        }
        let largest = matrix.iter().fold(0.0, |m: f64, v| if v.abs() > m.abs() { *v } else { m });
        let f = Self(matrix / (norm * largest.signum()));
        let [e1, e2] = [f.epipole1(), f.epipole2()];
        // A zero null vector means rank 1: no two rows (columns) differ.
        (e1.norm() > 0.0 && e2.norm() > 0.0 && f.0.iter().all(|v| v.is_finite())).then_some(f)
    }

    /// The nearest matrix of rank 2 in Frobenius norm (smallest singular value set to zero). Condition
    /// the coordinates before: the norm is meaningful only where the entries have like sizes.
    pub fn nearest_rank_two(matrix: Matrix3<f64>) -> Option<Self> {
        if !matrix.iter().all(|v| v.is_finite()) {
            return None;
        }
        let mut svd = matrix.svd(true, true);
        let smallest = svd.singular_values.imin();
        svd.singular_values[smallest] = 0.0;
        Self::from_rank_two(svd.recompose().ok()?)
    }

    /// The 3×3 matrix.
    pub fn matrix(&self) -> &Matrix3<f64> {
        &self.0
    }

    /// Nested rows, as in result files.
    pub fn rows(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|r| std::array::from_fn(|c| self.0[(r, c)]))
    }

    /// From nested rows; `None` when they are not a matrix of rank 2 or higher. A matrix of rank 3 (rounded
    /// in a file, say) is brought to rank 2; the [`rows`](Self::rows) of a fundamental matrix give that matrix again,
    /// bit for bit.
    pub fn from_rows(rows: [[f64; 3]; 3]) -> Option<Self> {
        let matrix = Matrix3::from_fn(|r, c| rows[r][c]);
        if !matrix.iter().all(|v| v.is_finite()) {
            return None;
        }
        // Rounding leaves the norm and the third singular value within a few units of the last place.
        if matrix.singular_values().min() > 1e-15 * matrix.norm() {
            return Self::nearest_rank_two(matrix);
        }
        let f = Self::from_rank_two(matrix)?;
        let as_written = [matrix, -matrix].into_iter().find(|m| (f.0 - m).norm() <= 1e-15);
        Some(as_written.map_or(f, Self))
    }

    /// The epipolar line in image 2 of a point of image 1; `None` at the epipole.
    pub fn line2_from_point1(&self, point1: Point) -> Option<Line> {
        Line::from_homogeneous(self.0 * point1.to_homogeneous())
    }

    /// The epipolar line in image 1 of a point of image 2; `None` at the epipole.
    pub fn line1_from_point2(&self, point2: Point) -> Option<Line> {
        Line::from_homogeneous(self.0.tr_mul(&point2.to_homogeneous()))
    }

    /// The epipole in image 1 (`F e1 = 0`), unit norm.
    pub fn epipole1(&self) -> HomogeneousPoint {
        null_vector(&self.0.transpose())
    }

    /// The epipole in image 2 (`Fᵀ e2 = 0`), unit norm.
    pub fn epipole2(&self) -> HomogeneousPoint {
        null_vector(&self.0)
    }

    /// The matrix for the images exchanged, `Fᵀ`.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self(self.0.transpose())
    }

    /// `F` for images resized by `scale1` and `scale2` (new size over old size), where pixel centres map as
    /// `x' = (x + ½)·scale − ½`.
    #[must_use]
    pub fn rescaled(&self, scale1: f64, scale2: f64) -> Option<Self> {
        let old_from_new = |s: f64| {
            let shift = 0.5 / s - 0.5;
            Matrix3::new(1.0 / s, 0.0, shift, 0.0, 1.0 / s, shift, 0.0, 0.0, 1.0)
        };
        Self::from_rank_two(old_from_new(scale2).transpose() * self.0 * old_from_new(scale1))
    }
}

/// The vector orthogonal to the columns of a rank-2 matrix: the longest cross product of two of them.
fn null_vector(m: &Matrix3<f64>) -> Vector3<f64> {
    let mut columns: [Vector3<f64>; 3] = std::array::from_fn(|k| m.column(k).into_owned());
    // Columns differ by orders of magnitude; the direction of a cross product does not depend on that,
    // but the choice of the best conditioned one does.
    for column in &mut columns {
        if let Some(unit) = column.try_normalize(0.0) {
            *column = unit;
        }
    }
    let [a, b, c] = columns;
    let candidates = [a.cross(&b), b.cross(&c), c.cross(&a)];
    let best = candidates
        .iter()
        .fold(Vector3::zeros(), |m: Vector3<f64>, v| if v.norm() > m.norm() { *v } else { m });
    best.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
}

impl Serialize for FundamentalMatrix {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.rows().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for FundamentalMatrix {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rows = <[[f64; 3]; 3]>::deserialize(deserializer)?;
        Self::from_rows(rows).ok_or_else(|| serde::de::Error::custom("the matrix does not have rank 2"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::PointPair;
    use crate::geometry::{Camera, symmetric_epipolar_distance};

    fn example() -> FundamentalMatrix {
        let (camera1, camera2) = Camera::example_pair();
        Camera::fundamental(&camera1, &camera2).unwrap()
    }

    #[test]
    fn has_the_stated_norm_sign_and_null_vectors() {
        let f = example();
        assert!((f.matrix().norm() - 1.0).abs() < 1e-12);
        let largest = f.matrix().iter().fold(0.0f64, |m, v| if v.abs() > m.abs() { *v } else { m });
        assert!(largest > 0.0);
        assert!((f.matrix() * f.epipole1()).norm() < 1e-12);
        assert!((f.matrix().transpose() * f.epipole2()).norm() < 1e-12);
    }

    #[test]
    fn refuses_rank_one_and_non_finite() {
        assert!(FundamentalMatrix::from_rank_two(Matrix3::repeat(1.0)).is_none());
        assert!(FundamentalMatrix::from_rank_two(Matrix3::zeros()).is_none());
        assert!(FundamentalMatrix::from_rows([[f64::NAN; 3]; 3]).is_none());
    }

    #[test]
    fn rows_give_the_same_bits_back() {
        let f = example();
        for f in [f, f.swapped(), f.rescaled(0.37, 2.9).unwrap()] {
            assert_eq!(FundamentalMatrix::from_rows(f.rows()), Some(f));
        }
        // Another scale or sign is brought to norm and sign.
        let other = f.rows().map(|row| row.map(|v| -3.0 * v));
        assert!((FundamentalMatrix::from_rows(other).unwrap().matrix() - f.matrix()).norm() < 1e-15);
    }

    #[test]
    fn resized_images_keep_their_matches() {
        let (camera1, camera2) = Camera::example_pair();
        let f = example();
        let g = f.rescaled(0.5, 0.25).unwrap();
        let x = nalgebra::Point3::new(0.3, -0.2, 5.0);
        let (a, b) = (camera1.project(&x).unwrap(), camera2.project(&x).unwrap());
        let resized = |p: Point, s: f64| Point::new((p.x + 0.5) * s - 0.5, (p.y + 0.5) * s - 0.5);
        let pair = PointPair { point1: resized(a, 0.5), point2: resized(b, 0.25) };
        assert!(symmetric_epipolar_distance(&g, &pair) < 1e-9);
    }
}
