//! Rectification from the fundamental matrix alone: both images redrawn so that corresponding points are in the same
//! row.
//!
//! [`rectify`] computes a [`Rectification`], which maps points both ways, tells how good it is, and draws the
//! pictures ([`Rectification::warp`]). Two methods are behind it: *planar*, one homography an image, for epipoles
//! outside both images, and *polar*, one row for each pair of half epipolar lines, for epipoles anywhere.
//! [`RectifyMethod::Auto`] chooses and says why.
//!
//! No camera is calibrated here: the pictures are as the pair allows, right for matching along rows, not for
//! measuring angles.

mod advice;
mod choice;
mod description;
mod error;
mod extent;
mod map;
mod measures;
mod outline;
mod planar;
mod polar;
mod presentation;
mod row;
mod warp;

use serde::{Deserialize, Serialize};

pub use advice::RectifyWarning;
pub use choice::rectify;
pub use description::Description;
pub use error::RectifyError;
pub use map::{ImageMap, PolarTable};
pub use measures::{Distortion, Measures, RowErrors};
pub use presentation::{anaglyph, stacked};
pub use row::RowTrace;

use crate::cancel::CancelFlag;
use crate::geometry::Frame;
use image::DynamicImage;

/// A way to rectify.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RectifyMethod {
    /// Planar where it bends the images little, else polar.
    #[default]
    Auto,
    /// One homography an image (Loop & Zhang 1999).
    Planar,
    /// A row for each pair of half epipolar lines (Pollefeys et al. 1999).
    Polar,
}

impl RectifyMethod {
    /// Every way, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Planar, Self::Polar];

    /// Name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Planar => "planar",
            Self::Polar => "polar",
        }
    }
}

/// Limits of a rectification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most pixels of one rectified picture; a larger one is drawn smaller, and that is reported.
    pub pixels: usize,
}

impl Default for Limits {
    /// 64 million pixels: twice what a 12-megapixel pair with the epipole inside needs.
    fn default() -> Self {
        Self { pixels: 64_000_000 }
    }
}

/// A rectified pair, ready to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Rectification {
    /// What was used: planar or polar.
    pub method: RectifyMethod,
    /// Why this method, one sentence.
    pub reason: String,
    /// The map of each image.
    pub maps: [ImageMap; 2],
    /// Size of both pictures.
    pub size: Frame,
    /// Factor by which the pictures are smaller than they should be; 1 unless a limit was met.
    pub scale: f64,
    /// How good it is.
    pub measures: Measures,
    /// What to beware of.
    pub warnings: Vec<RectifyWarning>,
}

impl Rectification {
    /// Draws the rectified picture of image `which` (0 or 1): bilinear between pixels, with the depth and the colours
    /// of the original and an alpha channel, transparent where the image does not reach. On all cores. `None` when
    /// cancelled.
    pub fn warp(&self, which: usize, original: &DynamicImage, cancel: &CancelFlag) -> Option<DynamicImage> {
        warp::warp(original, &self.maps[which], self.size, cancel)
    }
}

#[cfg(test)]
mod tests;
