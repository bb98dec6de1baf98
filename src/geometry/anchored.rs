//! Directed lines with an origin, the form in which lines are sampled.

use super::{Frame, Line, Point, Vector};

/// A directed line with an anchor, the point of sample index 0.
///
/// Stereo matching can compare two lines only when their anchors show the same scene point and
/// their directions correspond. Disparity 0 is then a valid disparity at the anchor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnchoredLine {
    /// A point on the line; it may lie outside the image.
    pub anchor: Point,
    /// Unit vector towards growing sample indices.
    pub direction: Vector,
}

impl AnchoredLine {
    /// Creates the line through `anchor` at `angle` radians from the x axis.
    pub fn at_angle(anchor: Point, angle: f64) -> Self {
        Self { anchor, direction: Vector::new(angle.cos(), angle.sin()) }
    }

    /// Returns the point at a distance of `t` px from the anchor.
    pub fn point_at(&self, t: f64) -> Point {
        self.anchor + self.direction * t
    }

    /// Returns the undirected line.
    pub fn line(&self) -> Line {
        Line::through_at_angle(self.anchor, self.angle())
    }

    /// Returns the angle of the direction with the x axis, radians in `(−π, π]`.
    pub fn angle(&self) -> f64 {
        self.direction.y.atan2(self.direction.x)
    }

    /// Returns the first and last index of the samples, `step` px apart, inside the sampling
    /// rectangle. Returns `None` when fewer than two samples are inside.
    pub fn index_range(&self, frame: Frame, step: f64) -> Option<(i32, i32)> {
        let (a, b) = frame.clip_ray(self.anchor, self.direction * step)?;
        // Farther out a sample's index is no longer exact in `f32`.
        if a.abs().max(b.abs()) > 1e6 {
            return None;
        }
        let (first, last) = ((a - 1e-9).ceil() as i32, (b + 1e-9).floor() as i32);
        (last > first).then_some((first, last))
    }
}
