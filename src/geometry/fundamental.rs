//! The fundamental matrix: validation, epipoles and epipolar lines.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::conditioning::pixels_from_conditioned;
use super::essential::is_rounded_essential;
use super::point::rescaling;
use super::{Frame, HomogeneousPoint, Line, Point};

/// A fundamental matrix `F`, `x2ᵀ F x1 = 0`: rank 2, Frobenius norm 1, the entry of largest
/// magnitude positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FundamentalMatrix(Matrix3<f64>);

/// The reason why a 3×3 matrix is no fundamental matrix.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NotFundamental {
    /// Some entries are infinite or NaN.
    #[error("the matrix has entries that are not finite numbers")]
    NotFinite,
    /// The matrix has rank 1 or 0.
    #[error("the matrix has rank 1 or 0, a fundamental matrix has 2")]
    RankBelowTwo,
    /// The matrix is far from every matrix of rank 2. The number is the ratio of the third to the second
    /// singular value, 0 to 1: the larger of the ratios in pixels and in conditioned coordinates.
    #[error(
        "the matrix has rank 3 (its third singular value is {:.2} % of the second), a fundamental matrix has 2. It may be a homography, or rounded to too few digits",
        100.0 * .0
    )]
    RankThree(f64),
    /// The matrix has rank 3 and looks like an essential matrix that was rounded.
    #[error(
        "the matrix looks like an essential matrix rounded to few digits (two equal singular values, entries of like size), which is not for pixels. Give more digits, and the calibration"
    )]
    Essential,
}

/// Largest accepted ratio of the third to the second singular value, in conditioned coordinates.
/// Matrices rounded to two digits stay below it.
const MOST_THIRD: f64 = 0.05;
/// Ratio of the third to the second singular value in pixels above which a matrix may be a
/// homography. Homographies have about a thousandth.
const CLEAR_IN_PIXELS: f64 = 1e-4;
/// Largest entry, in conditioned coordinates of norm 1, that rows do not have and rounding explains.
const ROUNDING: f64 = 1e-9;

impl FundamentalMatrix {
    /// Assumed size of images of unknown size, px.
    pub(crate) const TYPICAL: Frame = Frame { width: 1000, height: 1000 };

    /// Normalises a matrix that has rank 2 by construction. Returns `None` when the matrix is not
    /// finite or has lower rank.
    pub fn from_rank_two(matrix: Matrix3<f64>) -> Option<Self> {
        let matrix = in_range(matrix);
        let norm = matrix.norm();
        if !(norm.is_finite() && norm > 0.0) {
            return None;
        }
        let largest = matrix.iter().fold(0.0, |m: f64, v| if v.abs() > m.abs() { *v } else { m });
        let f = Self(matrix / (norm * largest.signum()));
        let [e1, e2] = [f.epipole1(), f.epipole2()];
        // A null vector of zeros means rank 1: all columns (rows) are parallel.
        (e1.norm() > 0.0 && e2.norm() > 0.0 && f.0.iter().all(|v| v.is_finite())).then_some(f)
    }

    /// Returns the nearest matrix of rank 2 in Frobenius norm: the smallest singular value is set
    /// to zero. Coordinates should be conditioned: the norm is meaningful only for entries of
    /// similar size.
    pub fn nearest_rank_two(matrix: Matrix3<f64>) -> Option<Self> {
        if !matrix.iter().all(|v| v.is_finite()) {
            return None;
        }
        let mut svd = matrix.svd(true, true);
        let smallest = svd.singular_values.imin();
        svd.singular_values[smallest] = 0.0;
        Self::from_rank_two(svd.recompose().ok()?)
    }

    /// Returns the 3×3 matrix.
    pub fn matrix(&self) -> &Matrix3<f64> {
        &self.0
    }

    /// Returns the matrix as nested rows, as in result files.
    pub fn rows(&self) -> [[f64; 3]; 3] {
        self.0.transpose().data.0
    }

    /// Creates a fundamental matrix from numbers of unknown origin, in pixels of images of the
    /// given sizes. Unknown sizes count as 1000×1000 px.
    ///
    /// A matrix nearly of rank 2 (rounded, or estimated without the constraint) is replaced by the
    /// nearest matrix of rank 2. The distance is measured in conditioned coordinates, which
    /// preserves the epipolar lines. The [`rows`](Self::rows) of a fundamental matrix give the same
    /// matrix back, bit for bit.
    ///
    /// # Errors
    /// Fails when the matrix has rank 1 or lower, or when its rank is clearly 3.
    pub fn from_numbers(matrix: Matrix3<f64>, frames: Option<[Frame; 2]>) -> Result<Self, NotFundamental> {
        if !matrix.iter().all(|v| v.is_finite()) {
            return Err(NotFundamental::NotFinite);
        }
        let matrix = in_range(matrix);
        // In pixels the second singular value may be a millionth of the first without being a
        // rounding error.
        if matrix.rank(1e-13 * matrix.norm()) < 2 {
            return Err(NotFundamental::RankBelowTwo);
        }
        // Rounding leaves the norm and the third singular value within a few units in the last
        // place.
        if matrix.singular_values().min() <= 1e-15 * matrix.norm() {
            let f = Self::from_rank_two(matrix).ok_or(NotFundamental::RankBelowTwo)?;
            let as_written = [matrix, -matrix].into_iter().find(|m| (f.0 - m).norm() <= 1e-15);
            return Ok(as_written.map_or(f, Self));
        }
        let [t1, t2] = frames.unwrap_or([Self::TYPICAL; 2]).map(pixels_from_conditioned);
        let conditioned = t2.transpose() * matrix * t1;
        let (in_pixels, ratio) = (third_to_second(&matrix), third_to_second(&conditioned));
        // A homography in conditioned coordinates looks like rank 2, because products of
        // coordinates dominate x2ᵀ H x1. A true rank-2 matrix does not look more like rank 3 in
        // pixels than in conditioned coordinates.
        let is_map_of_points = in_pixels > CLEAR_IN_PIXELS && ratio < 1e-2 * in_pixels;
        if ratio > MOST_THIRD || is_map_of_points {
            if is_rounded_essential(&matrix) {
                return Err(NotFundamental::Essential);
            }
            return Err(NotFundamental::RankThree(ratio.max(in_pixels)));
        }
        let back = |t: Matrix3<f64>| t.try_inverse().ok_or(NotFundamental::NotFinite);
        let rank_two = Self::nearest_rank_two(conditioned).ok_or(NotFundamental::RankBelowTwo)?;
        Self::from_rank_two(back(t2)?.transpose() * rank_two.0 * back(t1)?)
            .ok_or(NotFundamental::RankBelowTwo)
    }

    /// Creates a matrix from nested rows, like [`from_numbers`](Self::from_numbers) for images of
    /// unknown size.
    pub fn from_rows(rows: [[f64; 3]; 3]) -> Result<Self, NotFundamental> {
        Self::from_numbers(Matrix3::from_fn(|r, c| rows[r][c]), None)
    }

    /// Returns whether all epipolar lines are rows of both images, as in rectified pictures.
    pub fn has_rows(&self) -> bool {
        let [t1, t2] = [pixels_from_conditioned(Self::TYPICAL); 2];
        let conditioned = t2.transpose() * self.0 * t1;
        let others = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (2, 0)].map(|place| conditioned[place].abs());
        others.into_iter().fold(0.0, f64::max) <= ROUNDING * conditioned.norm()
    }

    /// Returns the epipolar line in image 2 of a point of image 1; `None` at the epipole.
    pub fn line2_from_point1(&self, point1: Point) -> Option<Line> {
        Line::from_homogeneous(self.0 * point1.to_homogeneous())
    }

    /// Returns the epipolar line in image 1 of a point of image 2; `None` at the epipole.
    pub fn line1_from_point2(&self, point2: Point) -> Option<Line> {
        Line::from_homogeneous(self.0.tr_mul(&point2.to_homogeneous()))
    }

    /// Returns the epipole in image 1 (`F e1 = 0`), unit norm.
    pub fn epipole1(&self) -> HomogeneousPoint {
        null_vector(&self.0.transpose())
    }

    /// Returns the epipole in image 2 (`Fᵀ e2 = 0`), unit norm.
    pub fn epipole2(&self) -> HomogeneousPoint {
        null_vector(&self.0)
    }

    /// Returns the fundamental matrix of the exchanged images, `Fᵀ`.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self(self.0.transpose())
    }

    /// Returns `F` for images resized by `scales` (new size over old size). Pixel centres map as
    /// `x' = (x + ½)·scale − ½`.
    #[must_use]
    pub fn rescaled(&self, scales: [f64; 2]) -> Option<Self> {
        let [old1, old2] = scales.map(|scale| rescaling(1.0 / scale));
        Self::from_rank_two(old2.transpose() * self.0 * old1)
    }
}

/// Scales the matrix to entries of about 1 when squares of its entries would overflow or underflow.
fn in_range(matrix: Matrix3<f64>) -> Matrix3<f64> {
    let largest = matrix.amax();
    if largest == 0.0 || (1e-100..1e100).contains(&largest) { matrix } else { matrix / largest }
}

/// Returns the ratio of the smallest to the second singular value.
fn third_to_second(matrix: &Matrix3<f64>) -> f64 {
    let values = matrix.singular_values();
    values[2] / values[1]
}

/// Returns the unit vector orthogonal to the columns of a rank-2 matrix: the longest of their cross
/// products.
fn null_vector(m: &Matrix3<f64>) -> Vector3<f64> {
    let mut columns: [Vector3<f64>; 3] = std::array::from_fn(|k| m.column(k).into_owned());
    // Columns differ by orders of magnitude. Unit columns make the longest cross product the best
    // conditioned one.
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
        Self::from_rows(rows).map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::{example_fundamental as example, example_seen};
    use crate::geometry::symmetric_epipolar_distance;

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
        assert!(FundamentalMatrix::from_rows([[f64::NAN; 3]; 3]).is_err());
    }

    #[test]
    fn rows_give_the_same_bits_back() {
        let f = example();
        for f in [f, f.swapped(), f.rescaled([0.37, 2.9]).unwrap()] {
            assert_eq!(FundamentalMatrix::from_rows(f.rows()), Ok(f));
        }
        // Scale and sign are normalised.
        let other = f.rows().map(|row| row.map(|v| -3.0 * v));
        assert!((FundamentalMatrix::from_rows(other).unwrap().matrix() - f.matrix()).norm() < 1e-15);
    }

    #[test]
    fn very_small_and_very_large_numbers_are_the_same_matrix() {
        let f = example();
        for scale in [1e-200, 1e-310, 1e200, 1e305] {
            let found = FundamentalMatrix::from_numbers(f.matrix() * scale, None).unwrap();
            let few_digits = scale < 1e-300;
            assert!((found.matrix() - f.matrix()).norm() < if few_digits { 1e-8 } else { 1e-15 }, "{scale}");
        }
    }

    #[test]
    fn homographies_are_no_fundamental_matrices() {
        let turned = Matrix3::new(0.9, -0.3, 120.0, 0.31, 0.92, -45.0, 1e-4, -2e-5, 1.0);
        let frames = Some([Frame::new(768, 576); 2]);
        for matrix in [Matrix3::identity(), turned, turned * 1e-6] {
            for frames in [None, frames] {
                let found = FundamentalMatrix::from_numbers(matrix, frames);
                assert!(matches!(found, Err(NotFundamental::RankThree(_))), "{found:?}");
            }
        }
    }

    #[test]
    fn the_lines_of_a_matrix_of_nearly_rank_two_stay() {
        let f = example();
        let t = pixels_from_conditioned(Frame::new(640, 480));
        let t_inverse = t.try_inverse().unwrap();
        let conditioned = t.transpose() * f.matrix() * t;
        let values = conditioned.singular_values();
        let svd = conditioned.svd(true, true);
        let (u, v) = (svd.u.unwrap().column(2).into_owned(), svd.v_t.unwrap().row(2).into_owned());
        let full = t_inverse.transpose() * (conditioned + 1e-3 * values[1] * u * v) * t_inverse;
        for frames in [None, Some([Frame::new(640, 480); 2])] {
            let found = FundamentalMatrix::from_numbers(full, frames).unwrap();
            let frames = [Frame::new(640, 480); 2];
            let moved = crate::geometry::epipolar_difference(&found, &f, frames, 99.0);
            let plain = FundamentalMatrix::nearest_rank_two(full).unwrap();
            let by_entries = crate::geometry::epipolar_difference(&plain, &f, frames, 99.0);
            println!("{moved} px, {by_entries} px in pixels");
            assert!(moved < 0.2 && moved < 0.5 * by_entries, "{moved} px, {by_entries} px");
        }
    }

    #[test]
    fn resized_images_keep_their_matches() {
        let g = example().rescaled([0.5, 0.25]).unwrap();
        let pair = example_seen(0.3, -0.2, 5.0).rescaled([0.5, 0.25]);
        assert!(symmetric_epipolar_distance(&g, &pair) < 1e-9);
    }
}
