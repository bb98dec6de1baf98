//! Sources of line similarities at any image size.

use super::{DisparityRange, LineSimilarity, SimilarityParameters, StereoSimilarity};
use crate::geometry::{Frame, PointPair};
use crate::image::{PyramidPair, RelativeView};

/// Two images, or other data in which lines are compared.
pub trait SimilaritySource: Sync {
    /// Returns the similarity at the size nearest to a longer side of `side` px.
    fn at(&self, side: f64) -> ScaledSimilarity<'_>;

    /// Returns the approximate rotation of image 2 relative to image 1, radians.
    fn rotation(&self) -> f64 {
        0.0
    }
}

/// A line similarity and its image size. All lines passed to it are in pixels of that size.
pub struct ScaledSimilarity<'a> {
    /// Similarity measure.
    pub lines: Box<dyn LineSimilarity + 'a>,
    /// Sizes of the images.
    pub frames: [Frame; 2],
    /// Size over full size, for each image.
    pub scales: [f64; 2],
}

impl ScaledSimilarity<'_> {
    /// Converts a full-size point pair to pixels of this size.
    pub fn resized(&self, pair: &PointPair) -> PointPair {
        pair.rescaled(self.scales)
    }
}

/// Two pictures, compared by stereo matching.
pub struct PictureSource<'a> {
    /// Pyramids of the grey images.
    pub pyramids: &'a PyramidPair,
    /// Rotation and scale of image 2 relative to image 1. Profiles are sampled at levels where
    /// objects have similar size.
    pub view: RelativeView,
    /// Parameters of the comparison.
    pub parameters: SimilarityParameters,
}

impl SimilaritySource for PictureSource<'_> {
    fn at(&self, side: f64) -> ScaledSimilarity<'_> {
        let level = self.pyramids.level_seen(side, self.view);
        let frames = level.frames();
        let reach = (self.parameters.disparity_reach * frames[0].longer_side()).round().max(2.0) as i32;
        let lines = StereoSimilarity {
            planes: level.planes,
            range: DisparityRange::symmetric(reach),
            parameters: self.parameters.stereo,
        };
        ScaledSimilarity { lines: Box::new(lines), frames, scales: level.scales }
    }

    fn rotation(&self) -> f64 {
        self.view.rotation
    }
}
