//! Measuring a distance and a direction in one image.

use super::document::Side;
use crate::geometry::Point;

/// Two places of one image, the second one once it is clicked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measuring {
    pub side: Side,
    /// First place, px.
    pub start: Point,
    /// Second place, px.
    pub end: Option<Point>,
}

impl Measuring {
    pub fn from(side: Side, start: Point) -> Self {
        Self { side, start, end: None }
    }

    /// Takes a click: the second place, or the first one of another measurement.
    #[must_use]
    pub fn after_click(before: Option<Self>, side: Side, point: Point) -> Self {
        match before {
            Some(open) if open.end.is_none() && open.side == side => Self { end: Some(point), ..open },
            _ => Self::from(side, point),
        }
    }

    /// Returns the distance to a place, px, and the angle from the direction of x, clockwise, in (−180°, 180°], as in
    /// the charts of the method.
    pub fn to(&self, end: Point) -> (f64, f64) {
        let way = end - self.start;
        (way.norm(), way.y.atan2(way.x).to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_in_pixels_and_angles_are_clockwise() {
        let origin = Measuring::from(Side::Left, Point::new(10.0, 10.0));
        for (to, distance, degrees) in [
            ((13.0, 6.0), 5.0, -53.130),
            ((20.0, 10.0), 10.0, 0.0),
            ((10.0, 12.0), 2.0, 90.0),
            ((9.0, 10.0), 1.0, 180.0),
        ] {
            let found = origin.to(Point::new(to.0, to.1));
            assert!((found.0 - distance).abs() < 1e-12 && (found.1 - degrees).abs() < 1e-3, "{found:?}");
        }
    }
}
