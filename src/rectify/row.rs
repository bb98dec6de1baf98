//! Row of a rectified picture, traced in the original.

use nalgebra::Vector3;

use crate::geometry::Point;

/// Positions of one rectified row in the original image: `start + x · step`, homogeneous, for
/// column `x`. Planar and polar rows are straight lines, so both have this form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowTrace {
    pub(super) start: Vector3<f64>,
    pub(super) step: Vector3<f64>,
}

impl RowTrace {
    /// Returns the original position of column `x`, px; `None` behind the line that is sent to
    /// infinity.
    #[inline]
    pub fn at(&self, x: f64) -> Option<Point> {
        let h = self.start + self.step * x;
        (h.z > 0.0).then(|| Point::new(h.x / h.z, h.y / h.z))
    }
}
