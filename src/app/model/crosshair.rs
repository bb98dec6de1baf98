//! The crosshair, with which the keyboard places points.

use super::document::Side;
use crate::geometry::Point;

/// A place that the arrow keys move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crosshair {
    pub side: Side,
    /// Position in the image, px.
    pub point: Point,
    /// Whether it was moved since it was put there.
    pub moved: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrosshairCommand {
    /// Put it into a picture, or take it away.
    Toggle,
    /// Put it into the other picture.
    ChangePicture,
}
