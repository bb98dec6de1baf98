//! What is pointed at and what is chosen, shared by all panes and panels.
//!
//! Whoever has something under the cursor says so in one frame ([`crate::app::model::command::Command::PointAt`]); in the
//! next, everyone else lights up what belongs to it. What is chosen stays until something else is. None of it is
//! part of the document: it is a way of looking, and no step of the history.

use serde::{Deserialize, Serialize};

use super::comparison::Contestant;
use super::document::Side;
use crate::geometry::Point;

/// Something that can be pointed at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// A line of image 1 against a line of image 2 in the matrix of a click.
    Cell {
        /// Which of the two clicks that the pencils pass through, 0 or 1.
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
    /// A match that the refinement found, by its place in the list of the result.
    Match(usize),
    /// A true match, by its place in the list.
    TrueMatch(usize),
    /// A sample of the inspected line of image 1, by its index (0 is the anchor).
    Sample(i32),
    /// A place in the rectified pictures.
    Rectified {
        /// The picture, by its side; `None` where both are drawn in one.
        side: Option<Side>,
        /// Where, px of the pictures as they are drawn.
        at: Point,
    },
}

/// Where a pair of lines comes from. Lines that come from a point follow the geometry when it changes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineSource {
    /// The epipolar lines of a point pair: each point's line in the other image.
    Pair(usize),
    /// The epipolar line through a point of one image, and the one that corresponds to it.
    Through {
        /// The image.
        side: Side,
        /// A point of it, px.
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

/// A line pair that stays on the images.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    /// Where it comes from.
    pub source: LineSource,
    /// Number in both images and in the plots, from 0; its colour goes with it.
    pub number: usize,
}

/// Pinned line pairs at most, each with a number of its own; the oldest gives way.
pub const PINS: usize = 40;

/// What is pointed at and what is chosen.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Focus {
    hovered: Option<Target>,
    hypothesis: Option<usize>,
    contestant: Option<Contestant>,
    pins: Vec<Pin>,
    inspected: Option<usize>,
}

impl Focus {
    /// What is under the cursor, somewhere in the window.
    pub fn hovered(&self) -> Option<Target> {
        self.hovered
    }

    /// The hypothesis that was chosen, by its place in the list of the result.
    pub fn hypothesis(&self) -> Option<usize> {
        self.hypothesis
    }

    /// The geometry of the comparison that was chosen in place of the result.
    pub fn contestant(&self) -> Option<Contestant> {
        self.contestant
    }

    /// The pinned line pairs, the oldest first.
    pub fn pins(&self) -> &[Pin] {
        &self.pins
    }

    /// The pinned line pair that is looked at closely.
    pub fn inspected(&self) -> Option<&Pin> {
        self.pins.get(self.inspected?)
    }

    /// The place in the list of the pinned line pair that is looked at closely.
    pub fn inspected_number(&self) -> Option<usize> {
        self.inspected
    }

    /// Says what is under the cursor; returns whether that is news.
    pub fn point_at(&mut self, target: Option<Target>) -> bool {
        std::mem::replace(&mut self.hovered, target) != target
    }

    /// Chooses a hypothesis, or the result again.
    pub fn choose_hypothesis(&mut self, number: Option<usize>) {
        self.hypothesis = number;
        self.contestant = None;
    }

    /// Chooses a geometry of the comparison; the result is what is shown when nothing is chosen.
    pub fn choose_contestant(&mut self, contestant: Contestant) {
        self.hypothesis = None;
        self.contestant = Some(contestant).filter(|contestant| *contestant != Contestant::Result);
    }

    /// Forgets the hypothesis that was chosen, since its result is gone.
    pub fn forget_hypothesis(&mut self) {
        self.hypothesis = None;
    }

    /// Pins a line pair and looks at it closely.
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

    /// Looks closely at a pinned line pair, by its place in the list.
    pub fn inspect(&mut self, number: usize) {
        self.inspected = (number < self.pins.len()).then_some(number);
    }

    /// Removes a pinned line pair, by its place in the list; the newest of the others is looked at then.
    pub fn unpin(&mut self, number: usize) {
        if number < self.pins.len() {
            self.pins.remove(number);
            self.inspected = self.pins.len().checked_sub(1);
        }
    }

    /// Removes all pinned line pairs.
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

    #[test]
    fn only_a_change_is_news() {
        let mut focus = Focus::default();
        assert!(focus.point_at(Some(Target::Hypothesis(3))));
        assert!(!focus.point_at(Some(Target::Hypothesis(3))));
        assert!(focus.point_at(None));
    }
}
