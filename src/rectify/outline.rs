//! The outline of an image as a map leaves it.

use crate::geometry::{Frame, Point, Vector};

/// Lines from the middle of the left side to that of the right one, and from the middle of the upper side to that of the
/// lower one, where a map takes them.
pub(super) fn middle_lines(frame: Frame, map: impl Fn(Point) -> Option<Point>) -> Option<[Vector; 2]> {
    let c = frame.centre();
    let left = map(Point::new(0.0, c.y))?;
    let right = map(Point::new(frame.right(), c.y))?;
    let top = map(Point::new(c.x, 0.0))?;
    let bottom = map(Point::new(c.x, frame.bottom()))?;
    Some([right - left, bottom - top])
}

/// The diagonals from the top left and from the top right corner, where a map takes them.
pub(super) fn diagonals(frame: Frame, map: impl Fn(Point) -> Option<Point>) -> Option<[Vector; 2]> {
    let [a, b, c, d] = frame.corners().map(map);
    Some([c? - a?, d? - b?])
}
