//! What part of an image is shown, whatever the size of its pane.

use serde::{Deserialize, Serialize};

use crate::geometry::{Frame, Point};

/// Screen points an image pixel may be wide at most.
pub const LARGEST_SCALE: f64 = 64.0;

/// What part of an image is shown.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PaneView {
    /// The image position in the middle of the pane, px.
    pub centre: Point,
    /// Screen points per image pixel; `None` as long as the image is to fit the pane.
    pub scale: Option<f64>,
}

impl PaneView {
    /// The whole image.
    pub fn fitting(frame: Frame) -> Self {
        Self { centre: frame.centre(), scale: None }
    }

    /// Whether the whole image is shown as large as the pane allows.
    pub fn fits(&self) -> bool {
        self.scale.is_none()
    }

    /// The same view where it makes sense for an image, else the whole image: a file may say anything.
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
