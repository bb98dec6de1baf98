//! Points, point pairs and points at infinity.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use super::Point;

/// A point of the projective plane as a homogeneous triple, defined up to scale.
///
/// Epipoles have this type because they are often far away or at infinity.
pub type HomogeneousPoint = Vector3<f64>;

/// The image points of one scene point in both images, in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PointPair {
    /// Position in image 1.
    pub point1: Point,
    /// Position in image 2.
    pub point2: Point,
}

impl PointPair {
    /// Creates a pair from the four numbers `x1 y1 x2 y2` of a match file.
    pub fn new(x1: f64, y1: f64, x2: f64, y2: f64) -> Self {
        Self { point1: Point::new(x1, y1), point2: Point::new(x2, y2) }
    }

    /// Returns the numbers `x1 y1 x2 y2`.
    pub fn numbers(&self) -> [f64; 4] {
        [self.point1.x, self.point1.y, self.point2.x, self.point2.y]
    }

    /// Returns the pair with the images exchanged.
    #[must_use]
    pub fn swapped(self) -> Self {
        Self { point1: self.point2, point2: self.point1 }
    }

    /// Returns the pair after both images were resized, see [`rescaled`].
    #[must_use]
    pub fn rescaled(&self, scales: [f64; 2]) -> Self {
        Self { point1: rescaled(self.point1, scales[0]), point2: rescaled(self.point2, scales[1]) }
    }

    /// Maps both points, each with the index of its image.
    pub(crate) fn mapped(&self, map: impl Fn(usize, Point) -> Option<Point>) -> Option<Self> {
        Some(Self { point1: map(0, self.point1)?, point2: map(1, self.point2)? })
    }

    /// Returns whether all four coordinates are finite numbers.
    pub fn is_finite(&self) -> bool {
        self.point1.iter().chain(self.point2.iter()).all(|v| v.is_finite())
    }
}

/// Returns a point after its image was resized by `scale` (new size over old size): pixel centres
/// map as `x' = (x + ½)·scale − ½`.
pub fn rescaled(p: Point, scale: f64) -> Point {
    Point::new((p.x + 0.5) * scale - 0.5, (p.y + 0.5) * scale - 0.5)
}

/// Returns the map of [`rescaled`] as a matrix for homogeneous points.
pub fn rescaling(scale: f64) -> Matrix3<f64> {
    let shift = 0.5 * scale - 0.5;
    scaling(scale, shift, shift)
}

/// Returns the map that scales points and then adds an offset.
pub(crate) fn scaling(scale: f64, x: f64, y: f64) -> Matrix3<f64> {
    Matrix3::new(scale, 0.0, x, 0.0, scale, y, 0.0, 0.0, 1.0)
}

/// Returns the pixel position of a homogeneous point, or `None` beyond 10⁹ px and at infinity.
pub fn finite_point(p: &HomogeneousPoint) -> Option<Point> {
    let scale = p.xy().norm();
    (p.z.abs() * 1e9 > scale).then(|| Point::new(p.x / p.z, p.y / p.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_at_infinity_have_no_position() {
        assert!(finite_point(&HomogeneousPoint::new(1.0, 2.0, 0.0)).is_none());
        assert!(finite_point(&HomogeneousPoint::new(0.0, 0.0, 0.0)).is_none());
        let p = finite_point(&HomogeneousPoint::new(-4.0, 2.0, -2.0));
        assert_eq!(p, Some(Point::new(2.0, -1.0)));
    }
}
