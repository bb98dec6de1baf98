//! Coordinates that condition the linear equations for `F` (Hartley 1997; Hartley & Zisserman,
//! §4.4.4 and §11.2).
//!
//! In pixels the entries of a row `x2 ⊗ x1` differ by six orders of magnitude, which makes a
//! least-squares solution meaningless. Centred and scaled points bring all entries near 1.

use nalgebra::{Matrix3, SVector};

use super::{Frame, Point, PointPair, scaling};

/// Returns the similarities that condition the points of image 1 and of image 2. Returns `None`
/// when all points of an image coincide.
pub(super) fn conditioning(pairs: &[PointPair]) -> Option<[Matrix3<f64>; 2]> {
    let t1 = normalisation(pairs.iter().map(|p| p.point1))?;
    let t2 = normalisation(pairs.iter().map(|p| p.point2))?;
    Some([t1, t2])
}

/// Returns the map to pixels from coordinates with their origin at the image centre and half the
/// longer side as unit.
pub(super) fn pixels_from_conditioned(frame: Frame) -> Matrix3<f64> {
    let unit = 0.5 * frame.longer_side().max(1.0);
    let (x, y) = (0.5 * frame.width as f64, 0.5 * frame.height as f64);
    scaling(unit, x, y)
}

/// Returns the map to pixels from coordinates with their origin at the middle of the pixels and half the
/// diagonal as unit.
pub(crate) fn pixels_from_half_diagonals(frame: Frame) -> Matrix3<f64> {
    let middle = frame.centre();
    scaling(0.5 * frame.diagonal(), middle.x, middle.y)
}

/// Returns the coefficients of `x2ᵀ F x1 = 0` in the entries of `F`, row by row, after
/// conditioning.
pub(super) fn equation([t1, t2]: &[Matrix3<f64>; 2], pair: &PointPair) -> SVector<f64, 9> {
    let a = t1 * pair.point1.to_homogeneous();
    let b = t2 * pair.point2.to_homogeneous();
    SVector::from_fn(|k, _| b[k / 3] * a[k % 3])
}

/// Returns the similarity that moves the centroid to the origin and makes the mean distance from it
/// √2.
fn normalisation(points: impl Iterator<Item = Point> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count() as f64;
    let centroid = points.clone().fold(Point::origin(), |sum, p| sum + p.coords) / count;
    let spread = points.map(|p| (p - centroid).norm()).sum::<f64>() / count;
    let s = std::f64::consts::SQRT_2 / spread;
    s.is_finite().then(|| scaling(s, -s * centroid.x, -s * centroid.y))
}
