//! The pyramids of an image pair, and the relative rotation and scale of its images.

use nalgebra::Matrix2;

use super::fixed::{COMPARED_SIDE, FixedContent};
use super::{GrayPlane, Pyramid, find_corners};
use crate::geometry::{Frame, Point, PointPair, rescaled};

/// Approximate rotation and scale of image 2 relative to image 1.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RelativeView {
    /// Size of objects in image 2 over their size in image 1, full-size pixels. `None`: in
    /// proportion to the image sizes.
    pub scale: Option<f64>,
    /// Rotation in radians, from the x axis towards the y axis.
    pub rotation: f64,
}

impl RelativeView {
    /// No rotation, and scales in proportion to the image sizes.
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
    /// Grey planes of the images.
    pub planes: [&'a GrayPlane; 2],
    /// Level size over full size, for each image.
    pub scales: [f64; 2],
    /// Pair of pyramids that holds the level.
    pair: &'a PyramidPair,
}

impl PyramidPair {
    /// Builds both pyramids in parallel, down to a longer side of at least `smallest` px.
    pub fn new(image1: &GrayPlane, image2: &GrayPlane, smallest: f64) -> Self {
        let (a, b) = rayon::join(|| Pyramid::new(image1, smallest), || Pyramid::new(image2, smallest));
        let mut pair = Self { pyramids: [a, b], fixed: None };
        // The search for static overlays runs here because a search on demand could deadlock. The
        // search uses all threads, and these could be waiting for its result.
        pair.fixed = pair.find_fixed();
        pair
    }

    /// Returns the full sizes of the two images.
    pub fn frames(&self) -> [Frame; 2] {
        self.pyramids.each_ref().map(|pyramid| pyramid.level(0).frame())
    }

    /// Returns the levels nearest to a longer side of `side` px; infinity selects full size. The
    /// level is chosen for each image separately, so that images of different size are compared at
    /// similar sizes.
    pub fn level(&self, side: f64) -> PairLevel<'_> {
        self.level_seen(side, RelativeView::UPRIGHT)
    }

    /// Returns the levels at which objects have similar size in both images under a view. Neither
    /// level is larger than requested, nor finer than the image of lower resolution.
    pub fn level_seen(&self, side: f64, view: RelativeView) -> PairLevel<'_> {
        let nearest = |image: usize, side: f64| {
            let pyramid = &self.pyramids[image];
            let off = |k: &usize| {
                let own = pyramid.level(*k).frame().longer_side();
                if side.is_finite() { (own / side).ln().abs() } else { -own }
            };
            (0..pyramid.count()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
        };
        let mut numbers = [0, 1].map(|image| nearest(image, side));
        if let Some(scale) = view.scale {
            // Objects are larger by 2ᵏ in image 2, so image 2 is halved k times more often.
            // No pyramid has more levels than an integer has bits.
            let more = scale.log2().round().clamp(-64.0, 64.0) as i64;
            let [k1, k2] = numbers.map(|k| k as i64);
            let first = k1.max(k2 - more).max(0).max(-more);
            numbers = [first, first + more].map(|k| k.max(0) as usize);
            numbers = [0, 1].map(|image| numbers[image].min(self.pyramids[image].count() - 1));
        }
        PairLevel {
            planes: [0, 1].map(|image| self.pyramids[image].level(numbers[image])),
            scales: numbers.map(|k| 0.5f64.powi(k as i32)),
            pair: self,
        }
    }

    /// Returns the number of corners excluded as static overlays, such as captions and logos.
    pub fn left_out(&self) -> usize {
        self.fixed().map_or(0, FixedContent::len)
    }

    /// Returns the static overlays of the pair.
    pub(crate) fn fixed(&self) -> Option<&FixedContent> {
        self.fixed.as_ref()
    }

    fn find_fixed(&self) -> Option<FixedContent> {
        // Between images of different size, equal positions do not correspond.
        let [frame1, frame2] = self.frames();
        let level = self.level(COMPARED_SIDE);
        if frame1 == frame2 { FixedContent::find(level.planes, level.scales[0]) } else { None }
    }
}

impl PairLevel<'_> {
    /// Returns the sizes of the images at this level.
    pub fn frames(&self) -> [Frame; 2] {
        self.planes.map(GrayPlane::frame)
    }

    /// Returns the map from offsets in image 1 to offsets in image 2 under a view, in pixels of
    /// this level.
    pub fn warp(&self, view: RelativeView) -> Matrix2<f64> {
        let scale = view.scale.map_or(1.0, |scale| scale * self.scales[1] / self.scales[0]);
        let (sin, cos) = view.rotation.sin_cos();
        Matrix2::new(cos, -sin, sin, cos) * scale
    }

    /// Returns the corners of an image ([`find_corners`]) without static overlays, in pixels of
    /// this level.
    pub fn corners(&self, image: usize, count: usize, border: usize) -> Vec<Point> {
        let mut corners = find_corners(self.planes[image], count, border);
        if let Some(fixed) = self.pair.fixed() {
            corners.retain(|corner| !fixed.covers(rescaled(*corner, 1.0 / self.scales[image])));
        }
        corners
    }

    /// Converts a full-size point pair to this level's pixels.
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
        // Objects are half as large in image 2, so image 1 is taken at half its size.
        let view = RelativeView { scale: Some(0.5), rotation: 0.0 };
        let seen = pair.level_seen(f64::INFINITY, view);
        assert_eq!(seen.frames().map(|frame| frame.width), [400, 200]);
        assert!((seen.warp(view)[(0, 0)] - 1.0).abs() < 1e-12);
        let resized = level.resized(&PointPair::new(1.5, 1.5, 7.0, 8.0));
        assert_eq!(resized, PointPair::new(0.0, 0.0, 7.0, 8.0));
    }
}
