//! Both images at one size of their pyramids, and how pixels map between sizes.

use crate::geometry::{Frame, Point, PointPair};
use crate::image::GrayPlane;

/// Both images at one size.
#[derive(Clone, Copy)]
pub(crate) struct Level<'a> {
    pub planes: [&'a GrayPlane; 2],
    /// Size over full size, of each image.
    pub scales: [f64; 2],
}

impl Level<'_> {
    pub fn frames(&self) -> [Frame; 2] {
        [self.planes[0].frame(), self.planes[1].frame()]
    }

    /// A full-size point pair in this level's pixels.
    pub fn resized(&self, pair: &PointPair) -> PointPair {
        resized_pair(pair, self.scales)
    }
}

/// A point pair after resizing the images by `scales`; pixel centres map as `x' = (x + ½)·scale − ½`.
pub(crate) fn resized_pair(pair: &PointPair, scales: [f64; 2]) -> PointPair {
    let resized = |p: Point, s: f64| Point::new((p.x + 0.5) * s - 0.5, (p.y + 0.5) * s - 0.5);
    PointPair { point1: resized(pair.point1, scales[0]), point2: resized(pair.point2, scales[1]) }
}
