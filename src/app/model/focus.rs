//! Hovered and selected things, shared by all panes and panels.
//!
//! The view under the cursor reports its target in one frame
//! ([`crate::app::model::command::Command::PointAt`]). In the next frame, all others highlight the
//! target. Selections last until the next selection. The focus is not part of the document and no
//! step of the history.

use super::comparison::Contestant;
use super::document::Side;
use crate::geometry::Point;

/// A thing under the cursor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// A cell in the cost matrix of a click: a line of image 1 against a line of image 2.
    Cell {
        /// Number of the click whose pencils are compared, 0 or 1.
        pair: usize,
        /// Line of image 1.
        row: usize,
        /// Line of image 2.
        column: usize,
    },
    /// A hypothesis, by its place in the list of the result.
    Hypothesis(usize),
    /// A point pair, by its number.
    Pair(usize),
    /// A match found by the refinement, by its place in the list of the result.
    Match(usize),
    /// A true match, by its place in the list.
    TrueMatch(usize),
    /// A match from elsewhere, by its place in the list.
    GivenMatch(usize),
    /// A sample of the inspected line of image 1, by its index (0 is the anchor).
    Sample(i32),
    /// A part of the replayed search.
    Replayed(Replayed),
    /// A place in the rectified pictures.
    Rectified {
        side: Side,
        /// The position, px of the rectified pictures as drawn.
        at: Point,
    },
}

/// A part of the replayed search, by its place in the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replayed {
    /// A proposed geometry.
    Hypothesis(usize),
    /// A hypothesis of the race.
    Racer(usize),
    /// A line of the left picture with its best partner, compared by motion barcodes.
    Swept(usize),
    /// A candidate among all lines.
    Candidate(usize),
    /// A match of features.
    Match(usize),
    /// One of the evenly spaced lines of a geometry, or of a round trip.
    Line(usize),
}

/// Hovered and selected things.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Focus {
    hovered: Option<Target>,
    /// The part of the replay that a click lit. It stays lit while nothing else is under the cursor.
    held: Option<Target>,
    hypothesis: Option<usize>,
    contestant: Option<Contestant>,
}

impl Focus {
    /// Returns the thing under the cursor, anywhere in the window, or else the held part of the replay.
    pub fn hovered(&self) -> Option<Target> {
        self.hovered.or(self.held)
    }

    /// Keeps a part of the replay lit; `None` lets go of it.
    pub fn hold(&mut self, target: Option<Target>) {
        self.held = target;
    }

    /// Returns the selected hypothesis, by its place in the list of the result.
    pub fn hypothesis(&self) -> Option<usize> {
        self.hypothesis
    }

    /// Returns the geometry of the comparison that is shown in place of the result.
    pub fn contestant(&self) -> Option<Contestant> {
        self.contestant
    }

    /// Sets the thing under the cursor and returns whether it changed.
    pub fn point_at(&mut self, target: Option<Target>) -> bool {
        std::mem::replace(&mut self.hovered, target) != target
    }

    /// Selects a hypothesis; `None` selects the result.
    pub fn choose_hypothesis(&mut self, number: Option<usize>) {
        self.hypothesis = number;
        self.contestant = None;
    }

    /// Selects a geometry of the comparison. Selecting the result clears the selection.
    pub fn choose_contestant(&mut self, contestant: Contestant) {
        self.hypothesis = None;
        self.contestant = Some(contestant).filter(|contestant| *contestant != Contestant::Result);
    }

    /// Deselects the hypothesis, after its result was replaced.
    pub fn forget_hypothesis(&mut self) {
        self.hypothesis = None;
    }
}
