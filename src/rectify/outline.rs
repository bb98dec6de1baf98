//! Outline of an image under a map.

use crate::geometry::{Frame, Point, Vector};

/// Maps the two middle lines: from left to right and from top to bottom.
pub(super) fn middle_lines(frame: Frame, map: impl Fn(Point) -> Option<Point>) -> Option<[Vector; 2]> {
    let c = frame.centre();
    let left = map(Point::new(0.0, c.y))?;
    let right = map(Point::new(frame.right(), c.y))?;
    let top = map(Point::new(c.x, 0.0))?;
    let bottom = map(Point::new(c.x, frame.bottom()))?;
    Some([right - left, bottom - top])
}

/// Maps the two diagonals: from the top left and from the top right corner.
pub(super) fn diagonals(frame: Frame, map: impl Fn(Point) -> Option<Point>) -> Option<[Vector; 2]> {
    let [a, b, c, d] = frame.corners().map(map);
    Some([c? - a?, d? - b?])
}
