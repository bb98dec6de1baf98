//! Both images of a pair at the sizes of their pyramids.

use super::{GrayPlane, Pyramid};
use crate::geometry::{Frame, PointPair};

/// The pyramids of two images.
#[derive(Debug)]
pub struct PyramidPair([Pyramid; 2]);

/// Both images at one size.
#[derive(Clone, Copy)]
pub struct PairLevel<'a> {
    /// The images.
    pub planes: [&'a GrayPlane; 2],
    /// Size over full size, of each image.
    pub scales: [f64; 2],
}

impl PyramidPair {
    /// Builds both in parallel, down to a longer side of at least `smallest` px.
    pub fn new(image1: &GrayPlane, image2: &GrayPlane, smallest: f64) -> Self {
        let (a, b) = rayon::join(|| Pyramid::new(image1, smallest), || Pyramid::new(image2, smallest));
        Self([a, b])
    }

    /// Sizes of the two images.
    pub fn frames(&self) -> [Frame; 2] {
        self.0.each_ref().map(|pyramid| pyramid.level(0).frame())
    }

    /// The levels nearest to a longer side of `side` px (full size when that is infinite), chosen for each image
    /// apart, so that images of different size are compared at like sizes.
    pub fn level(&self, side: f64) -> PairLevel<'_> {
        let numbers = self.0.each_ref().map(|pyramid| {
            let off = |k: &usize| {
                let own = pyramid.level(*k).frame().longer_side();
                if side.is_finite() { (own / side).ln().abs() } else { -own }
            };
            (0..pyramid.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
        });
        PairLevel {
            planes: [0, 1].map(|image| self.0[image].level(numbers[image])),
            scales: numbers.map(|k| 0.5f64.powi(k as i32)),
        }
    }
}

impl PairLevel<'_> {
    /// Sizes of the images at this level.
    pub fn frames(&self) -> [Frame; 2] {
        self.planes.map(GrayPlane::frame)
    }

    /// A full-size point pair in this level's pixels.
    pub fn resized(&self, pair: &PointPair) -> PointPair {
        pair.rescaled(self.scales)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_of_different_size_are_taken_at_like_sizes() {
        let plane = |width| GrayPlane::from_fn(Frame::new(width, width / 2), |x, y| (x + y) as f32);
        let pair = PyramidPair::new(&plane(800), &plane(200), 48.0);
        let level = pair.level(190.0);
        assert_eq!(level.scales.map(f64::to_bits), [0.25f64, 1.0].map(f64::to_bits));
        assert_eq!(level.frames(), [Frame::new(200, 100); 2]);
        assert_eq!(pair.level(f64::INFINITY).frames()[0].width, 800);
        let resized = level.resized(&PointPair::new(1.5, 1.5, 7.0, 8.0));
        assert_eq!(resized, PointPair::new(0.0, 0.0, 7.0, 8.0));
    }
}
