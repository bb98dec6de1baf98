//! Intensities along the inspected line pair, matched sample by sample.

use std::ops::Deref;
use std::sync::Arc;

use image::GrayImage;

use super::document::Side;
use super::picture::Pictures;
use super::revision;
use crate::estimate::Parameters;
use crate::geometry::{AnchoredLine, Point};
use crate::similarity::{MatchedLines, StereoParameters};

/// Request to match two lines.
#[derive(Debug, Clone, PartialEq)]
pub struct InspectionRequest {
    pub pictures: Pictures,
    pub lines: [AnchoredLine; 2],
    pub stereo: StereoParameters,
    /// Largest disparity tried, as a fraction of the longer side of the left image.
    pub reach: f64,
    /// Size of things in the right picture over their size in the left one.
    pub scale: f64,
}

impl InspectionRequest {
    /// Creates a request with the parameters of the estimate, for pictures of this relative scale.
    pub fn new(pictures: Pictures, lines: [AnchoredLine; 2], scale: f64, parameters: &Parameters) -> Self {
        let similarity = parameters.similarity;
        Self { pictures, lines, stereo: similarity.stereo, reach: similarity.disparity_reach, scale }
    }

    /// Samples and matches the lines.
    pub fn inspect(&self) -> Inspection {
        let planes = self.pictures.each_ref().map(|picture| &picture.gray);
        let matched = MatchedLines::new(planes, self.lines, self.scale, self.reach, &self.stereo);
        let band = Arc::new(band(&matched));
        Inspection { number: revision::fresh(), matched, band }
    }
}

fn band(matched: &MatchedLines) -> GrayImage {
    let rows = (matched.range.min..=matched.range.max).rev();
    let grey = |likeness: f32| (likeness * 255.0) as u8;
    let pixels = rows.flat_map(|disparity| matched.likeness_at(disparity).map(grey)).collect();
    let (width, height) = (matched.samples().len() as u32, matched.range.len() as u32);
    GrayImage::from_raw(width, height, pixels).expect("a byte for each sample and disparity")
}

#[derive(Debug, Clone)]
pub struct Inspection {
    pub number: u64,
    matched: MatchedLines,
    /// Cost of matching each sample (x) at each disparity (y, the largest on top). Bright means
    /// similar.
    pub band: Arc<GrayImage>,
}

impl Deref for Inspection {
    type Target = MatchedLines;

    fn deref(&self) -> &MatchedLines {
        &self.matched
    }
}

impl Inspection {
    /// Returns the sample nearest to a position, if the line passes within `reach` px of it.
    pub fn sample_near(&self, side: Side, point: Point, reach: f64) -> Option<i32> {
        self.matched.sample_near(side.index(), point, reach)
    }
}
