//! What panes and panels may look at: the whole state, read-only.

use super::computation::Computation;
use super::document::{Document, Side};
use super::panels::Message;
use crate::geometry::Point;

/// A position under the cursor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hover {
    /// The image under the cursor.
    pub side: Side,
    /// Where in it, px; the point that is being dragged, if one is.
    pub point: Point,
    /// Whether a point is being dragged.
    pub dragging: bool,
}

/// The state as it is drawn. Panes and panels read it and return commands.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// What is edited.
    pub document: &'a Document,
    /// Where the estimate stands.
    pub computation: &'a Computation,
    /// The position under the cursor: written in one frame, read in the next.
    pub hover: Option<Hover>,
    /// Which overlays are shown, in the order of their list.
    pub overlays: &'a [bool],
    /// Whether pictures are being opened.
    pub loading: bool,
    /// Whether "Show me" has something to place.
    pub has_sample_points: bool,
    /// Whether there is something to undo, and to redo.
    pub can_undo_redo: [bool; 2],
    /// What the user was told and has not dismissed.
    pub messages: &'a [Message],
}
