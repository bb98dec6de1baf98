//! One row of a rectified picture, traced in the original.

use nalgebra::Vector3;

use crate::geometry::Point;

/// Where the pixels of one rectified row are in the original image: `start + x · step`, homogeneous, for the
/// column `x`. Both methods have this form, because every row is a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RowTrace {
    pub(super) start: Vector3<f64>,
    pub(super) step: Vector3<f64>,
}

impl RowTrace {
    /// The original position of column `x`, px; `None` behind the line that the map sends to infinity.
    #[inline]
    pub fn at(&self, x: f64) -> Option<Point> {
        let h = self.start + self.step * x;
        (h.z > 0.0).then(|| Point::new(h.x / h.z, h.y / h.z))
    }
}
