//! Lines with a unit normal.

use nalgebra::Vector3;

use super::{HomogeneousPoint, Point, Vector};

/// A line `a x + b y + c = 0` with `a² + b² = 1`, so that the left side is a signed distance in
/// pixels. A line and its negative hold the same points with opposite orientation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line(Vector3<f64>);

impl Line {
    /// Normalises `(a, b, c)`. Returns `None` for the line at infinity and for non-finite numbers.
    pub fn from_homogeneous(coefficients: Vector3<f64>) -> Option<Self> {
        let norm = coefficients.xy().norm();
        let line = coefficients / norm;
        // The first two entries are at most 1, so the sum is finite exactly when all three entries
        // are.
        (norm > 0.0 && line.sum().is_finite()).then_some(Self(line))
    }

    /// Creates the line through `point` whose direction makes `angle` radians with the x axis.
    pub fn through_at_angle(point: Point, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self(Vector3::new(-sin, cos, sin * point.x - cos * point.y))
    }

    /// Creates the line through two points. Returns `None` when the points coincide.
    pub fn through(a: Point, b: Point) -> Option<Self> {
        Self::joining(&a.to_homogeneous(), &b.to_homogeneous())
    }

    /// Creates the line through two homogeneous points. Returns `None` when they coincide or both
    /// are at infinity.
    pub fn joining(a: &HomogeneousPoint, b: &HomogeneousPoint) -> Option<Self> {
        Self::from_homogeneous(a.cross(b))
    }

    /// Returns the coefficients `(a, b, c)`.
    pub fn coefficients(&self) -> &Vector3<f64> {
        &self.0
    }

    /// Returns the signed distance of a point in pixels, positive on the side of the normal.
    pub fn signed_distance(&self, point: Point) -> f64 {
        self.0.x * point.x + self.0.y * point.y + self.0.z
    }

    /// Returns the absolute distance of a point in pixels.
    pub fn distance(&self, point: Point) -> f64 {
        self.signed_distance(point).abs()
    }

    /// Returns the unit vector along the line: the normal turned by −90°. A line built by
    /// [`Line::through_at_angle`] runs along its angle.
    pub fn direction(&self) -> Vector {
        Vector::new(self.0.y, -self.0.x)
    }

    /// Returns the intersection with another line. Parallel lines meet at infinity; coincident
    /// lines give the zero vector.
    pub fn intersection(&self, other: &Self) -> HomogeneousPoint {
        self.0.cross(&other.0)
    }

    /// Returns the angle between two lines in radians, at most π/2.
    pub fn angle_to(&self, other: &Self) -> f64 {
        self.direction().perp(&other.direction()).abs().min(1.0).asin()
    }

    /// Returns the point of the line nearest to `point`.
    pub fn foot(&self, point: Point) -> Point {
        point - self.0.xy() * self.signed_distance(point)
    }

    /// Returns the line with the opposite orientation.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self(-self.0)
    }

    /// Returns the line with the orientation that puts `point` on its positive side.
    #[must_use]
    pub fn with_positive_side(&self, point: Point) -> Self {
        if self.signed_distance(point) < 0.0 { self.reversed() } else { *self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn runs_along_its_angle_through_its_point() {
        let p = Point::new(12.5, -3.0);
        for k in 0..16 {
            let angle = f64::from(k) * PI / 8.0;
            let line = Line::through_at_angle(p, angle);
            assert!(line.distance(p) < 1e-12);
            let d = line.direction();
            assert!((d - Vector::new(angle.cos(), angle.sin())).norm() < 1e-12);
            assert!(line.distance(p + d * 500.0) < 1e-9);
        }
    }

    #[test]
    fn angles_between_lines_have_no_direction() {
        let at = |angle: f64| Line::through_at_angle(Point::new(3.0, 4.0), angle);
        for (a, b, expected) in [(0.1, 0.4, 0.3), (0.4, 0.1, 0.3), (0.1, 0.1 + PI, 0.0), (0.0, 2.0, PI - 2.0)]
        {
            assert!((at(a).angle_to(&at(b)) - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn refuses_the_line_at_infinity_and_coincident_points() {
        assert!(Line::from_homogeneous(Vector3::new(0.0, 0.0, 1.0)).is_none());
        assert!(Line::from_homogeneous(Vector3::new(f64::NAN, 1.0, 1.0)).is_none());
        assert!(Line::through(Point::new(3.0, 4.0), Point::new(3.0, 4.0)).is_none());
    }

    #[test]
    fn orientation_follows_the_named_point() {
        let line = Line::through(Point::new(0.0, 0.0), Point::new(10.0, 0.0)).unwrap();
        for p in [Point::new(1.0, 5.0), Point::new(1.0, -5.0)] {
            assert!((line.with_positive_side(p).signed_distance(p) - 5.0).abs() < 1e-12);
        }
    }
}
