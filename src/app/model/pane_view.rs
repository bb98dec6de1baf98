//! Visible part of an image, independent of the size of the pane.

use serde::{Deserialize, Serialize};

use crate::geometry::{Frame, Point, Vector};

/// Maximum width of an image pixel, screen points.
pub const LARGEST_SCALE: f64 = 64.0;

/// Clockwise turn of a view, in quarter turns. Coordinates of the image stay as they are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "u8", into = "u8")]
pub struct QuarterTurns(u8);

impl From<u8> for QuarterTurns {
    fn from(turns: u8) -> Self {
        Self(turns % 4)
    }
}

impl From<QuarterTurns> for u8 {
    fn from(turns: QuarterTurns) -> Self {
        turns.0
    }
}

impl QuarterTurns {
    /// Returns the number of clockwise quarter turns, 0 to 3.
    pub fn count(self) -> u8 {
        self.0
    }

    #[must_use]
    pub fn next(self) -> Self {
        Self::from(self.0 + 1)
    }

    #[must_use]
    pub fn inverse(self) -> Self {
        Self::from(4 - self.0)
    }

    /// Turns a vector (x to the right, y down).
    pub fn turned(self, v: Vector) -> Vector {
        match self.0 {
            0 => v,
            1 => Vector::new(-v.y, v.x),
            2 => -v,
            _ => Vector::new(v.y, -v.x),
        }
    }

    /// Returns the size of a turned image.
    pub fn turned_frame(self, frame: Frame) -> Frame {
        if self.0.is_multiple_of(2) { frame } else { Frame::new(frame.height, frame.width) }
    }
}

/// Visible part of an image.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PaneView {
    /// Image position in the middle of the pane, px.
    pub centre: Point,
    /// Screen points per image pixel. `None` fits the image into the pane.
    pub scale: Option<f64>,
    #[serde(default)]
    pub turn: QuarterTurns,
}

impl PaneView {
    pub fn fitting(frame: Frame) -> Self {
        Self { centre: frame.centre(), scale: None, turn: QuarterTurns::default() }
    }

    /// Returns a view of the whole image with the same turn.
    #[must_use]
    pub fn fitted(self, frame: Frame) -> Self {
        Self { turn: self.turn, ..Self::fitting(frame) }
    }

    /// Returns the view after one more quarter turn about the middle of the pane.
    #[must_use]
    pub fn turned(self) -> Self {
        Self { turn: self.turn.next(), ..self }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_turn_of_a_view_is_kept_in_a_session_and_missing_in_old_ones() {
        let frame = Frame::new(64, 48);
        let view = PaneView::fitting(frame).turned().turned().turned();
        let text = serde_json::to_string(&view).unwrap();
        assert_eq!(serde_json::from_str::<PaneView>(&text).unwrap().made_valid(frame), view);
        let old = text.replace(",\"turn\":3", "");
        assert_ne!(old, text);
        assert_eq!(serde_json::from_str::<PaneView>(&old).unwrap().turn, QuarterTurns::default());
        // A file may say anything.
        let many = text.replace("\"turn\":3", "\"turn\":251");
        assert_eq!(serde_json::from_str::<PaneView>(&many).unwrap().turn.count(), 3);
    }

    #[test]
    fn a_turn_and_its_inverse_leave_a_vector() {
        let v = Vector::new(3.0, -2.0);
        for count in 0..4 {
            let turn = QuarterTurns::from(count);
            assert_eq!(turn.inverse().turned(turn.turned(v)), v);
        }
        assert_eq!(QuarterTurns::from(1).turned(Vector::new(1.0, 0.0)), Vector::new(0.0, 1.0), "clockwise");
    }
}
