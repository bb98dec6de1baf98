//! What is compared: a source that makes line similarities at any size.

use super::{DisparityRange, LineSimilarity, SimilarityParameters, StereoSimilarity};
use crate::geometry::{Frame, PointPair};
use crate::image::{PyramidPair, RelativeView};

/// Two images, or whatever else lines are compared in.
pub trait SimilaritySource: Sync {
    /// The similarity at the size nearest to a longer side of `side` px.
    fn at(&self, side: f64) -> ScaledSimilarity<'_>;

    /// How far lines of image 2 are turned against those of image 1, about, radians.
    fn rotation(&self) -> f64 {
        0.0
    }
}

/// A line similarity and the size it works at: all lines that it is asked about are in pixels of that size.
pub struct ScaledSimilarity<'a> {
    /// The measure.
    pub lines: Box<dyn LineSimilarity + 'a>,
    /// Sizes of the images.
    pub frames: [Frame; 2],
    /// Size over full size, of each image.
    pub scales: [f64; 2],
}

impl ScaledSimilarity<'_> {
    /// A full-size point pair in pixels of this size.
    pub fn resized(&self, pair: &PointPair) -> PointPair {
        pair.rescaled(self.scales)
    }
}

/// Two pictures, compared by stereo matching.
pub struct PictureSource<'a> {
    /// The grey images.
    pub pyramids: &'a PyramidPair,
    /// How things are turned and scaled in image 2: profiles are sampled so that they are of like size.
    pub view: RelativeView,
    /// The numbers of the comparison.
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
