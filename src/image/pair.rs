//! Both images of a pair at the sizes of their pyramids, and how they are turned and scaled against each other.

use nalgebra::Matrix2;

use super::fixed::{COMPARED_SIDE, FixedContent};
use super::{GrayPlane, Pyramid, find_corners};
use crate::geometry::{Frame, Point, PointPair, rescaled};

/// How things look in image 2 against image 1, roughly: turned and enlarged.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RelativeView {
    /// How much larger things are in image 2, full-size pixels; `None` when they fill like shares of both images.
    pub scale: Option<f64>,
    /// How far they are turned, radians, from the x axis to the y axis.
    pub rotation: f64,
}

impl RelativeView {
    /// Neither turned nor, in proportion to the sizes of the images, scaled.
    pub const UPRIGHT: Self = Self { scale: None, rotation: 0.0 };
}

/// The pyramids of two images.
#[derive(Debug)]
pub struct PyramidPair {
    pyramids: [Pyramid; 2],
    fixed: Option<FixedContent>,
}

/// Both images at one size.
#[derive(Clone, Copy)]
pub struct PairLevel<'a> {
    /// The images.
    pub planes: [&'a GrayPlane; 2],
    /// Size over full size, of each image.
    pub scales: [f64; 2],
    /// The pair that this is a level of.
    pair: &'a PyramidPair,
}

impl PyramidPair {
    /// Builds both in parallel, down to a longer side of at least `smallest` px.
    pub fn new(image1: &GrayPlane, image2: &GrayPlane, smallest: f64) -> Self {
        let (a, b) = rayon::join(|| Pyramid::new(image1, smallest), || Pyramid::new(image2, smallest));
        let mut pair = Self { pyramids: [a, b], fixed: None };
        // At once and not when it is asked for: looking for it takes all threads, and these may be the ones that ask. They
        // would wait for the thread that looks, and it for them, for ever.
        pair.fixed = pair.find_fixed();
        pair
    }

    /// Sizes of the two images.
    pub fn frames(&self) -> [Frame; 2] {
        self.pyramids.each_ref().map(|pyramid| pyramid.level(0).frame())
    }

    /// The levels nearest to a longer side of `side` px (full size when that is infinite), chosen for each image
    /// apart, so that images of different size are compared at like sizes.
    pub fn level(&self, side: f64) -> PairLevel<'_> {
        self.level_seen(side, RelativeView::UPRIGHT)
    }

    /// The levels at which things are of like size in both images under a view: neither is larger than asked for, nor
    /// finer than the image that shows less.
    pub fn level_seen(&self, side: f64, view: RelativeView) -> PairLevel<'_> {
        let nearest = |image: usize, side: f64| {
            let pyramid = &self.pyramids[image];
            let off = |k: &usize| {
                let own = pyramid.level(*k).frame().longer_side();
                if side.is_finite() { (own / side).ln().abs() } else { -own }
            };
            (0..pyramid.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
        };
        let mut numbers = [0, 1].map(|image| nearest(image, side));
        if let Some(scale) = view.scale {
            // Things are larger by 2ᵏ in image 2, so it is halved as often more than image 1.
            let more = scale.log2().round() as i64;
            let [k1, k2] = numbers.map(|k| k as i64);
            let first = k1.max(k2 - more).max(0).max(-more);
            numbers = [first, first + more].map(|k| k.max(0) as usize);
            numbers = [0, 1].map(|image| numbers[image].min(self.pyramids[image].len() - 1));
        }
        PairLevel {
            planes: [0, 1].map(|image| self.pyramids[image].level(numbers[image])),
            scales: numbers.map(|k| 0.5f64.powi(k as i32)),
            pair: self,
        }
    }

    /// Corners that are left out because they stay at their place though the scene does not: captions, a logo.
    pub fn left_out(&self) -> usize {
        self.fixed().map_or(0, FixedContent::len)
    }

    /// What stays at its place though the scene does not.
    pub(crate) fn fixed(&self) -> Option<&FixedContent> {
        self.fixed.as_ref()
    }

    fn find_fixed(&self) -> Option<FixedContent> {
        // Of other sizes or shapes the same place is not the same.
        let [frame1, frame2] = self.frames();
        let level = self.level(COMPARED_SIDE);
        if frame1 == frame2 { FixedContent::find(level.planes, level.scales[0]) } else { None }
    }
}

impl PairLevel<'_> {
    /// Sizes of the images at this level.
    pub fn frames(&self) -> [Frame; 2] {
        self.planes.map(GrayPlane::frame)
    }

    /// How offsets in image 1 become offsets in image 2 under a view, in pixels of this level.
    pub fn warp(&self, view: RelativeView) -> Matrix2<f64> {
        let scale = view.scale.map_or(1.0, |scale| scale * self.scales[1] / self.scales[0]);
        let (sin, cos) = view.rotation.sin_cos();
        Matrix2::new(cos, -sin, sin, cos) * scale
    }

    /// Corners of an image ([`find_corners`]), in pixels of this level, without what stays at its place.
    pub fn corners(&self, image: usize, count: usize, border: usize) -> Vec<Point> {
        let mut corners = find_corners(self.planes[image], count, border);
        if let Some(fixed) = self.pair.fixed() {
            corners.retain(|corner| !fixed.covers(rescaled(*corner, 1.0 / self.scales[image])));
        }
        corners
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
        // Half as large in image 2: image 1 is taken at half its size.
        let view = RelativeView { scale: Some(0.5), rotation: 0.0 };
        let seen = pair.level_seen(f64::INFINITY, view);
        assert_eq!(seen.frames().map(|frame| frame.width), [400, 200]);
        assert!((seen.warp(view)[(0, 0)] - 1.0).abs() < 1e-12);
        let resized = level.resized(&PointPair::new(1.5, 1.5, 7.0, 8.0));
        assert_eq!(resized, PointPair::new(0.0, 0.0, 7.0, 8.0));
    }
}
