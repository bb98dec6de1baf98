//! Half lines from an epipole across an image.

use std::f64::consts::{PI, TAU};

use crate::geometry::{Frame, HomogeneousPoint, Line, Point, Vector, finite_point};

/// Distance at which an epipole at infinity is placed, px. Directions in the image then differ from
/// parallel by less than 10⁻⁵ radians, and positions stay exact to 10⁻⁷ px.
const FAR: f64 = 1e9;

/// Half lines from an epipole, selected by the angle of their direction (radians from x towards y).
#[derive(Debug, Clone)]
pub(super) struct HalfPencil {
    pub(super) epipole: Point,
    frame: Frame,
    pub(super) inside: bool,
    /// Angle towards the image centre. The other angles lie within π of it.
    pub(super) middle: f64,
}

impl HalfPencil {
    pub(super) fn new(epipole: &HomogeneousPoint, frame: Frame) -> Self {
        let centre = frame.centre();
        let position = finite_point(epipole).filter(|p| (p - centre).norm() < FAR);
        let epipole = position.unwrap_or_else(|| {
            let towards = epipole.xy().try_normalize(0.0).unwrap_or_else(Vector::x);
            // An epipole that is far away but finite keeps its side.
            let side = if epipole.z < 0.0 { -1.0 } else { 1.0 };
            centre + towards * side * FAR
        });
        let to_centre = centre - epipole;
        Self { epipole, frame, inside: frame.contains(epipole), middle: to_centre.y.atan2(to_centre.x) }
    }

    /// Returns the range of angles that the image covers: a full turn from inside.
    pub(super) fn range(&self) -> [f64; 2] {
        if self.inside {
            // A picture in reading order begins on the left, so the full turn is cut there.
            return [-PI, PI];
        }
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for corner in self.frame.corners() {
            let angle = self.angle_of(corner);
            range = [range[0].min(angle), range[1].max(angle)];
        }
        range
    }

    /// Returns the angle of a point, within half a turn of the angle of the image centre.
    pub(super) fn angle_of(&self, p: Point) -> f64 {
        let from = p - self.epipole;
        near(from.y.atan2(from.x), self.middle)
    }

    /// Returns the distances from the epipole at which the half line enters and leaves the image,
    /// px; `None` if it misses.
    pub(super) fn reach(&self, angle: f64) -> Option<[f64; 2]> {
        let (from, to) = self.frame.clip_ray(self.epipole, direction(angle))?;
        (to > 0.0).then(|| [from.max(0.0), to])
    }

    /// Returns the distance to the far end of the half line in the image, px; at least 1.
    pub(super) fn far_end(&self, angle: f64) -> f64 {
        // At the ends of the range the half line touches a corner; rounding may place it outside
        // the image.
        self.reach(angle).map_or_else(|| (self.frame.centre() - self.epipole).norm(), |r| r[1]).max(1.0)
    }

    /// Returns the middle of the visible part of the half line, or if it misses the image its point
    /// nearest to the image centre. The point is at least 1 px from the epipole, even outside the
    /// image, because `F` has no line at the epipole.
    pub(super) fn point(&self, angle: f64) -> Point {
        let along = direction(angle);
        let reach = self.reach(angle).map_or_else(
            || (self.frame.centre() - self.epipole).dot(&along),
            |[from, to]| f64::midpoint(from, to),
        );
        self.epipole + along * reach.max(1.0)
    }

    /// Returns the angle of an oriented line through the epipole; its direction selects the half.
    pub(super) fn angle_of_line(&self, line: &Line) -> f64 {
        let centre = self.frame.centre();
        if (centre - self.epipole).norm() > 2.0 * self.frame.diagonal() {
            // From afar only the half that faces the image counts. The point where the line passes
            // the image gives a more accurate angle than the line's direction.
            return self.angle_of(line.foot(centre));
        }
        let along = line.direction();
        near(along.y.atan2(along.x), self.middle)
    }
}

pub(super) fn direction(angle: f64) -> Vector {
    Vector::new(angle.cos(), angle.sin())
}

/// Adds full turns to an angle until it is within π of another.
pub(super) fn near(angle: f64, to: f64) -> f64 {
    to + (angle - to + PI).rem_euclid(TAU) - PI
}
