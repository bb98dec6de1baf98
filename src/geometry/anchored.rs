//! Directed lines with an origin, the form in which lines are sampled.

use super::{Frame, Line, Point, Vector};

/// A directed line with an anchor: the point that gets sample index 0.
///
/// Two lines can be compared by stereo matching only when their anchors show the same scene point and
/// their directions correspond; then disparity 0 is a valid disparity at the anchor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnchoredLine {
    /// A point on the line; it may lie outside the image.
    pub anchor: Point,
    /// Unit vector in the direction of growing sample index.
    pub direction: Vector,
}

impl AnchoredLine {
    /// The line through `anchor` at `angle` radians from the x axis.
    pub fn at_angle(anchor: Point, angle: f64) -> Self {
        Self { anchor, direction: Vector::new(angle.cos(), angle.sin()) }
    }

    /// The point at a distance of `t` px from the anchor.
    pub fn point_at(&self, t: f64) -> Point {
        self.anchor + self.direction * t
    }

    /// The undirected line.
    pub fn line(&self) -> Line {
        Line::through_at_angle(self.anchor, self.angle())
    }

    /// Angle of the direction with the x axis, radians in `(−π, π]`.
    pub fn angle(&self) -> f64 {
        self.direction.y.atan2(self.direction.x)
    }

    /// Indices of the samples, `step` px apart, that fall inside the sampling rectangle; `None` when fewer
    /// than two do.
    pub fn index_range(&self, frame: Frame, step: f64) -> Option<(i32, i32)> {
        let (a, b) = frame.clip_ray(self.anchor, self.direction * step)?;
        // Beyond this an index is no longer exact in the sampler, and nothing useful is that far away.
        if a.abs().max(b.abs()) > 1e6 {
            return None;
        }
        let (first, last) = ((a - 1e-9).ceil() as i32, (b + 1e-9).floor() as i32);
        (last > first).then_some((first, last))
    }
}
