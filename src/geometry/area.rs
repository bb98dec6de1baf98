//! The epipolar area: the area of an image between two lines (paper, section 5.1, step 2d).

use super::{Frame, Line, Point};

/// Returns the area in px² of the part of the image between two lines: the points on different
/// sides of the two lines.
///
/// The lines are first oriented alike, which selects the acute wedge. The area has a closed form:
/// the sampling rectangle is clipped by half planes and measured by the shoelace formula.
pub fn area_between_lines(a: &Line, b: &Line, frame: Frame) -> f64 {
    wedges(a, b, frame).iter().map(|wedge| polygon_area(&wedge.points[..wedge.len])).sum()
}

/// Returns the corners of the two wedges measured by [`area_between_lines`]. Either wedge may be
/// empty.
pub fn regions_between_lines(a: &Line, b: &Line, frame: Frame) -> [Vec<Point>; 2] {
    wedges(a, b, frame).map(|wedge: Polygon| wedge.points[..wedge.len].to_vec())
}

/// Returns the two parts of the image where the lines, oriented alike, disagree about the side.
fn wedges(a: &Line, b: &Line, frame: Frame) -> [Polygon; 2] {
    let b = if a.direction().dot(&b.direction()) < 0.0 { b.reversed() } else { *b };
    let between =
        |x: &Line, y: &Line| Polygon::from_corners(frame.corners()).clipped(x).clipped(&y.reversed());
    [between(a, &b), between(&b, a)]
}

/// A convex polygon of at most eight corners. A rectangle cut by two lines has six.
#[derive(Clone, Copy)]
struct Polygon {
    points: [Point; 8],
    len: usize,
}

impl Polygon {
    fn from_corners(corners: [Point; 4]) -> Self {
        let mut points = [Point::origin(); 8];
        points[..4].copy_from_slice(&corners);
        Self { points, len: 4 }
    }

    /// Returns the part on the positive side of a line (Sutherland–Hodgman).
    fn clipped(&self, line: &Line) -> Self {
        let mut out = Self { points: self.points, len: 0 };
        for k in 0..self.len {
            let (p, q) = (self.points[k], self.points[(k + 1) % self.len]);
            let (dp, dq) = (line.signed_distance(p), line.signed_distance(q));
            if dp >= 0.0 {
                out.push(p);
            }
            if (dp >= 0.0) != (dq >= 0.0) {
                out.push(p + (q - p) * (dp / (dp - dq)));
            }
        }
        out
    }

    fn push(&mut self, p: Point) {
        // Each cut adds at most one corner to a convex polygon. Rounding cannot exceed eight.
        if self.len < self.points.len() {
            self.points[self.len] = p;
            self.len += 1;
        }
    }
}

/// Returns the area of a polygon, by the shoelace formula.
pub(crate) fn polygon_area(corners: &[Point]) -> f64 {
    let twice: f64 = (0..corners.len())
        .map(|k| {
            let (p, q) = (corners[k], corners[(k + 1) % corners.len()]);
            p.x * q.y - q.x * p.y
        })
        .sum();
    twice.abs() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FRAME: Frame = Frame { width: 101, height: 61 };

    #[test]
    fn parallel_lines_bound_a_strip() {
        let a = Line::through_at_angle(Point::new(0.0, 10.0), 0.0);
        let b = Line::through_at_angle(Point::new(0.0, 13.0), std::f64::consts::PI);
        assert!((area_between_lines(&a, &b, FRAME) - 300.0).abs() < 1e-9);
        assert!(area_between_lines(&a, &a, FRAME).abs() < 1e-9);
    }

    #[test]
    fn crossing_lines_bound_two_triangles() {
        let centre = FRAME.centre();
        let a = Line::through_at_angle(centre, 0.0);
        let b = Line::through_at_angle(centre, 0.1);
        let expected = 50.0 * 50.0 * 0.1f64.tan();
        assert!((area_between_lines(&a, &b, FRAME) - expected).abs() < 1e-9);
    }

    proptest! {
        // Compares the closed form with a count of small cells.
        #[test]
        fn agrees_with_counting(
            x in -50.0..150.0f64, y in -50.0..110.0f64, s in 0.0..3.1f64, t in -0.5..0.5f64
        ) {
            let a = Line::through_at_angle(Point::new(x, y), s);
            let b = Line::through_at_angle(Point::new(x, y), s + t);
            let mut count = 0u32;
            for i in 0..200 {
                for j in 0..120 {
                    let p = Point::new((f64::from(i) + 0.5) * 0.5, (f64::from(j) + 0.5) * 0.5);
                    if (a.signed_distance(p) >= 0.0) != (b.signed_distance(p) >= 0.0) {
                        count += 1;
                    }
                }
            }
            let counted = f64::from(count) * 0.25;
            prop_assert!((area_between_lines(&a, &b, FRAME) - counted).abs() < 60.0);
        }
    }
}
