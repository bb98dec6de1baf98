//! Visible part of an image, independent of the size of the pane.

use serde::{Deserialize, Serialize};

use crate::geometry::{Frame, Point};

/// Maximum width of an image pixel, screen points.
pub const LARGEST_SCALE: f64 = 64.0;

/// Visible part of an image.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PaneView {
    /// Image position in the middle of the pane, px.
    pub centre: Point,
    /// Screen points per image pixel. `None` fits the image into the pane.
    pub scale: Option<f64>,
}

impl PaneView {
    /// Returns a view of the whole image.
    pub fn fitting(frame: Frame) -> Self {
        Self { centre: frame.centre(), scale: None }
    }

    /// Returns whether the image is fitted into the pane.
    pub fn fits(&self) -> bool {
        self.scale.is_none()
    }

    /// Returns the view if it is valid for an image, and otherwise the whole image. Values from a
    /// file may be invalid.
    #[must_use]
    pub fn made_valid(mut self, frame: Frame) -> Self {
        self.keep_in_sight(frame);
        self.scale = self.scale.filter(|scale| *scale > 0.0).map(|scale| scale.min(LARGEST_SCALE));
        if self.centre.iter().all(|v| v.is_finite()) { self } else { Self::fitting(frame) }
    }

    /// Keeps the middle of the pane on the image.
    pub fn keep_in_sight(&mut self, frame: Frame) {
        self.centre.x = self.centre.x.clamp(0.0, frame.right().max(0.0));
        self.centre.y = self.centre.y.clamp(0.0, frame.bottom().max(0.0));
    }
}
