//! The rectangle of an image and lines clipped to it.

use serde::{Deserialize, Serialize};

use super::{Line, Point, PointPair, Vector};

/// Width and height of an image in pixels.
///
/// The *sampling rectangle* spans the pixel centres, `[0, width − 1] × [0, height − 1]`. Inside it
/// bilinear interpolation needs no pixel outside the image.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frame {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
}

/// Returns the name of an image in sentences, from its number: the first one is the left one.
pub fn image_in_words(number: usize) -> &'static str {
    if number == 1 { "the left image" } else { "the right image" }
}

/// A segment of a line, from `start` to `end` along [`Line::direction`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// First point of the segment.
    pub start: Point,
    /// Last point of the segment.
    pub end: Point,
}

impl Segment {
    /// Returns the length in pixels.
    pub fn length(&self) -> f64 {
        (self.end - self.start).norm()
    }

    /// Returns the midpoint of the segment.
    pub fn midpoint(&self) -> Point {
        nalgebra::center(&self.start, &self.end)
    }
}

impl Frame {
    /// Creates a frame of the given size in pixels.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height }
    }

    /// Returns the longer side in pixels.
    pub fn longer_side(&self) -> f64 {
        self.width.max(self.height) as f64
    }

    /// Returns the shorter side in pixels.
    pub fn shorter_side(&self) -> f64 {
        self.width.min(self.height) as f64
    }

    /// Returns the diagonal in pixels.
    pub fn diagonal(&self) -> f64 {
        (self.width as f64).hypot(self.height as f64)
    }

    /// Returns the centre of the sampling rectangle.
    pub fn centre(&self) -> Point {
        Point::new(self.right() / 2.0, self.bottom() / 2.0)
    }

    /// Returns the x coordinate of the last pixel centres.
    pub fn right(&self) -> f64 {
        self.width as f64 - 1.0
    }

    /// Returns the y coordinate of the last pixel centres.
    pub fn bottom(&self) -> f64 {
        self.height as f64 - 1.0
    }

    /// Returns whether a point lies on a pixel of the image, up to half a pixel beyond the outer
    /// centres.
    pub fn contains(&self, p: Point) -> bool {
        p.x >= -0.5 && p.y >= -0.5 && p.x <= self.right() + 0.5 && p.y <= self.bottom() + 0.5
    }

    /// Returns the point on the image's pixels nearest to `p`.
    pub fn nearest(&self, p: Point) -> Point {
        Point::new(p.x.clamp(-0.5, self.right() + 0.5), p.y.clamp(-0.5, self.bottom() + 0.5))
    }

    /// Returns the corners of the sampling rectangle, clockwise on the screen from the top left.
    pub fn corners(&self) -> [Point; 4] {
        [
            Point::new(0.0, 0.0),
            Point::new(self.right(), 0.0),
            Point::new(self.right(), self.bottom()),
            Point::new(0.0, self.bottom()),
        ]
    }

    /// Returns the largest distance from `p` to a corner, px.
    pub fn farthest_corner(&self, p: Point) -> f64 {
        self.corners().iter().map(|c| (c - p).norm()).fold(0.0, f64::max)
    }

    /// Returns the range of `t` for which `origin + t · direction` lies in the sampling rectangle,
    /// or `None`. `direction` need not be a unit vector.
    pub fn clip_ray(&self, origin: Point, direction: Vector) -> Option<(f64, f64)> {
        let mut range = (f64::NEG_INFINITY, f64::INFINITY);
        for (o, d, last) in [(origin.x, direction.x, self.right()), (origin.y, direction.y, self.bottom())] {
            if d.abs() < 1e-12 {
                // Rounding may place a line along the border slightly outside it.
                if o < -1e-9 || o > last + 1e-9 {
                    return None;
                }
            } else {
                let (a, b) = (-o / d, (last - o) / d);
                range = (range.0.max(a.min(b)), range.1.min(a.max(b)));
            }
        }
        (range.0.is_finite() && range.1.is_finite() && range.0 <= range.1).then_some(range)
    }

    /// Returns the part of a line inside the sampling rectangle.
    pub fn clip(&self, line: &Line) -> Option<Segment> {
        let origin = line.foot(self.centre());
        let direction = line.direction();
        let (a, b) = self.clip_ray(origin, direction)?;
        Some(Segment { start: origin + direction * a, end: origin + direction * b })
    }
}

impl PointPair {
    /// Returns whether both points are inside images of these sizes.
    pub fn is_inside(&self, [frame1, frame2]: [Frame; 2]) -> bool {
        frame1.contains(self.point1) && frame2.contains(self.point2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn clips_axis_parallel_lines_and_misses() {
        let frame = Frame::new(101, 51);
        let at = |x: f64, y: f64, angle: f64| frame.clip(&Line::through_at_angle(Point::new(x, y), angle));
        assert!((at(10.0, 20.0, 0.0).unwrap().length() - 100.0).abs() < 1e-9);
        assert!((at(10.0, 20.0, std::f64::consts::FRAC_PI_2).unwrap().length() - 50.0).abs() < 1e-9);
        assert!(at(10.0, 51.5, 0.0).is_none());
        assert!(at(-5.0, -5.0, -std::f64::consts::FRAC_PI_4).is_none());
    }

    #[test]
    fn frames_without_extent_do_not_panic() {
        for (w, h) in [(0, 0), (1, 1), (0, 5), (1, 7)] {
            let frame = Frame::new(w, h);
            let _ = frame.clip(&Line::through_at_angle(Point::new(0.0, 0.0), 0.3));
        }
    }

    proptest! {
        #[test]
        fn clipped_ends_lie_on_the_border_and_on_the_line(
            x in -200.0..300.0f64, y in -200.0..300.0f64, angle in 0.0..6.3f64
        ) {
            let frame = Frame::new(120, 90);
            let line = Line::through_at_angle(Point::new(x, y), angle);
            if let Some(s) = frame.clip(&line) {
                for p in [s.start, s.end] {
                    prop_assert!(line.distance(p) < 1e-8);
                    let border = [p.x, p.y, frame.right() - p.x, frame.bottom() - p.y];
                    let nearest = border.iter().fold(f64::INFINITY, |m, v| m.min(*v));
                    prop_assert!(nearest.abs() < 1e-7);
                }
                prop_assert!((s.end - s.start).dot(&line.direction()) >= -1e-9);
            }
        }
    }
}
