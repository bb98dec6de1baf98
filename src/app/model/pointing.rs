//! Pointing by the keyboard: moves of the crosshair, and the places that it marks.

use super::Model;
use super::crosshair::{Crosshair, CrosshairCommand};
use super::document::Side;
use super::open_pair::Hover;
use crate::geometry::{Point, Vector};

impl Model {
    /// Returns the crosshair in place of a cursor; `None` without one.
    pub fn crosshair_as_hover(&self) -> Option<Hover> {
        self.open.crosshair.map(|own| Hover { side: own.side, point: own.point, dragging: false })
    }

    pub fn apply_to_crosshair(&mut self, command: CrosshairCommand) {
        self.open.crosshair = match (command, self.open.crosshair) {
            (CrosshairCommand::Toggle, Some(_)) | (CrosshairCommand::ChangePicture, None) => None,
            (CrosshairCommand::Toggle, None) => {
                let hovered = self.open.hover.map(|hover| hover.side);
                let due = self.document.half.map(|half| half.side.other());
                self.crosshair_in(due.or(hovered).unwrap_or(Side::Left), self.open.hover)
            }
            (CrosshairCommand::ChangePicture, Some(own)) => {
                self.crosshair_in(own.side.other(), self.crosshair_as_hover())
            }
        };
    }

    /// Moves the crosshair, inside its picture. Returns whether there is one.
    pub fn move_crosshair(&mut self, by: Vector) -> bool {
        let Some(own) = self.open.crosshair else { return false };
        let Some(frame) = self.document.frame(own.side) else { return false };
        let to = own.point + by;
        let point = Point::new(to.x.clamp(0.0, frame.right()), to.y.clamp(0.0, frame.bottom()));
        self.open.crosshair = Some(Crosshair { point, moved: true, ..own });
        true
    }

    /// Returns the place that Enter marks: a clear suggestion, unless the crosshair was moved on.
    pub fn marked_by_crosshair(&self) -> Option<(Side, Point)> {
        let own = self.open.crosshair?;
        let suggested = self.accepted_suggestion().filter(|(side, _)| *side == own.side && !own.moved);
        Some(suggested.unwrap_or((own.side, own.point)))
    }

    /// Goes on with the crosshair after it marked a place: to the other picture for the second point of a pair.
    pub fn advance_crosshair(&mut self, (side, point): (Side, Point)) {
        let marked = Hover { side, point, dragging: false };
        let next = self.document.half.map_or(Side::Left, |half| half.side.other());
        self.open.crosshair = self.crosshair_in(next, Some(marked));
    }

    /// Returns a crosshair in a picture: at the place, its match, or about the same part of the other picture.
    fn crosshair_in(&self, side: Side, from: Option<Hover>) -> Option<Crosshair> {
        let frame = self.document.frame(side)?;
        let centre = frame.centre();
        let point = match from {
            Some(from) if from.side == side => from.point,
            Some(from) => self
                .matched(from.side, from.point)
                .filter(|point| frame.contains(*point))
                .unwrap_or_else(|| {
                    let size = self.document.frame(from.side).unwrap_or(frame);
                    let along = |at: f64, of: usize, own: usize| at / of.max(2) as f64 * own as f64;
                    Point::new(
                        along(from.point.x, size.width, frame.width).clamp(0.0, frame.right()),
                        along(from.point.y, size.height, frame.height).clamp(0.0, frame.bottom()),
                    )
                }),
            None => centre,
        };
        Some(Crosshair { side, point, moved: false })
    }
}
