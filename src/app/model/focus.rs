//! Hovered and selected things, shared by all panes and panels.
//!
//! The view under the cursor reports its target in one frame
//! ([`crate::app::model::command::Command::PointAt`]). In the next frame, all others highlight the
//! target. Selections last until the next selection. The focus is not part of the document and no
//! step of the history.

use serde::{Deserialize, Serialize};

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

/// Origin of a pair of lines. Lines from a point follow the geometry when it changes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineSource {
    /// The epipolar lines of a point pair: each point's line in the other image.
    Pair(usize),
    /// The epipolar line through a point of one image, and its corresponding line.
    Through {
        side: Side,
        /// The point, px.
        point: Point,
    },
    /// Two lines of the pencils through a click.
    Pencil {
        /// Number of the pair.
        pair: usize,
        /// Their directions in image 1 and 2, radians.
        angles: [f64; 2],
    },
}

/// A line pair pinned to the images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    /// Origin of the lines.
    pub source: LineSource,
    /// Number in both images and in the plots, from 0. It also sets the colour.
    pub number: usize,
}

/// Maximum number of pinned line pairs. Each has its own number; the oldest is removed first.
pub const PINS: usize = 40;

/// Hovered and selected things.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Focus {
    hovered: Option<Target>,
    /// The part of the replay that a click lit. It stays lit while nothing else is under the cursor.
    held: Option<Target>,
    hypothesis: Option<usize>,
    contestant: Option<Contestant>,
    pins: Vec<Pin>,
    inspected: Option<usize>,
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

    /// Returns the pinned line pairs, oldest first.
    pub fn pins(&self) -> &[Pin] {
        &self.pins
    }

    pub fn inspected(&self) -> Option<&Pin> {
        self.pins.get(self.inspected?)
    }

    /// Returns the place of the inspected pin in the list.
    pub fn inspected_number(&self) -> Option<usize> {
        self.inspected
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

    /// Pins a line pair and inspects it.
    pub fn pin(&mut self, source: LineSource) {
        if let Some(at) = self.pins.iter().position(|pin| pin.source == source) {
            self.inspected = Some(at);
            return;
        }
        if self.pins.len() == PINS {
            self.pins.remove(0);
        }
        let free = (0..PINS).find(|number| self.pins.iter().all(|pin| pin.number != *number));
        self.pins.push(Pin { source, number: free.unwrap_or(0) });
        self.inspected = Some(self.pins.len() - 1);
    }

    /// Inspects a pin, by its place in the list.
    pub fn inspect(&mut self, number: usize) {
        self.inspected = (number < self.pins.len()).then_some(number);
    }

    /// Removes a pin, by its place in the list. The newest of the others is inspected then.
    pub fn unpin(&mut self, number: usize) {
        if number < self.pins.len() {
            self.pins.remove(number);
            self.inspected = self.pins.len().checked_sub(1);
        }
    }

    /// Removes all pins.
    pub fn unpin_all(&mut self) {
        self.pins.clear();
        self.inspected = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_have_a_number_each_and_the_oldest_gives_way() {
        let mut focus = Focus::default();
        for pair in 0..=PINS {
            focus.pin(LineSource::Pair(pair));
        }
        assert_eq!(focus.pins().len(), PINS);
        assert_eq!(focus.inspected().map(|pin| pin.source), Some(LineSource::Pair(PINS)));
        for (k, pin) in focus.pins().iter().enumerate() {
            assert_eq!(pin.source, LineSource::Pair(k + 1));
            assert!(focus.pins()[..k].iter().all(|other| other.number != pin.number));
        }
        focus.pin(LineSource::Pair(2));
        assert_eq!(focus.pins().len(), PINS, "pinned already");
        assert_eq!(focus.inspected().map(|pin| pin.source), Some(LineSource::Pair(2)));
        focus.unpin(PINS - 1);
        assert_eq!(focus.inspected().map(|pin| pin.source), Some(LineSource::Pair(PINS - 1)));
        focus.unpin_all();
        assert_eq!(focus.inspected(), None);
    }
}
