//! Rectification from the fundamental matrix alone: both images are redrawn so that corresponding
//! points are in the same row.
//!
//! [`rectify`] computes a [`Rectification`], which maps points both ways, measures its quality and
//! draws the pictures ([`Rectification::warp`]). There are two methods. *Planar* applies one
//! homography per image and needs epipoles outside both images. *Polar* draws one row per pair of
//! half epipolar lines and handles epipoles anywhere. [`RectifyMethod::Auto`] chooses one and gives
//! the reason.
//!
//! Without a calibration, the pictures suit matching along rows, not measuring angles.
//! [`rectify_calibrated`] turns calibrated cameras about their centres instead, so that disparities
//! tell depths.

mod advice;
mod calibrated;
mod choice;
mod description;
mod error;
mod extent;
mod map;
mod measures;
mod outline;
mod planar;
mod polar;
#[cfg(feature = "pictures")]
mod presentation;
mod row;

use serde::{Deserialize, Serialize};

pub use advice::RectifyWarning;
pub use calibrated::{StereoRig, rectify_calibrated};
pub use choice::rectify;
pub use description::Description;
pub use error::RectifyError;
pub use map::{ImageMap, PolarTable};
pub use measures::{Distortion, Measures, RowErrors};
#[cfg(feature = "pictures")]
pub use presentation::side_by_side;
pub use row::RowTrace;

use crate::camera::UndistortedView;
use crate::geometry::Frame;

named! {
    fn name;
    /// Method of rectification.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum RectifyMethod {
        /// Planar if the distortion is small, otherwise polar.
        #[default]
        Auto = "auto",
        /// One homography per image (Loop & Zhang 1999).
        Planar = "planar",
        /// One row per pair of half epipolar lines (Pollefeys et al. 1999).
        Polar = "polar",
    }
}

/// Limits on the size of a rectification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Maximum number of pixels of one rectified picture. A larger picture is reduced, with a
    /// warning.
    pub pixels: usize,
}

impl Default for Limits {
    /// Returns 64 million pixels: twice the need of a 12-megapixel pair with the epipole inside.
    fn default() -> Self {
        Self { pixels: 64_000_000 }
    }
}

/// Rectified pair, ready to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Rectification {
    /// Method that was used: planar or polar.
    pub method: RectifyMethod,
    /// Reason for the method, one clause.
    pub reason: String,
    /// Map of each image.
    pub maps: [ImageMap; 2],
    /// Size of both pictures, px.
    pub size: Frame,
    /// Factor by which the pixel limit reduced the pictures; 1 without reduction.
    pub scale: f64,
    /// Row errors and distortion.
    pub measures: Measures,
    /// Warnings for the user.
    pub warnings: Vec<RectifyWarning>,
}

impl Rectification {
    /// Leads the maps on to pictures with distortion. The rectification belongs to two views without
    /// it.
    #[must_use]
    pub fn through(mut self, views: &[UndistortedView; 2]) -> Self {
        for (map, view) in self.maps.iter_mut().zip(views) {
            if !view.is_original() {
                *map = map.clone().through(view);
            }
        }
        self
    }
}

#[cfg(all(test, feature = "pictures"))]
mod tests;
