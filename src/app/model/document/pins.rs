//! Pinned line pairs.

use serde::{Deserialize, Serialize};

use super::{Document, Side};
use crate::geometry::Point;

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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pin {
    /// Origin of the lines.
    pub source: LineSource,
    /// Number in both images and in the plots, from 0.
    pub number: usize,
}

/// Maximum number of pinned line pairs. Each has its own number; the oldest is removed first.
pub const PINS: usize = 40;

impl LineSource {
    /// Returns the lines after a pair was removed; `None` if they were its lines.
    pub(super) fn without_pair(self, removed: usize) -> Option<Self> {
        let moved = |pair: usize| (pair != removed).then(|| pair - usize::from(pair > removed));
        Some(match self {
            Self::Pair(pair) => Self::Pair(moved(pair)?),
            Self::Through { .. } => self,
            Self::Pencil { pair, angles } => Self::Pencil { pair: moved(pair)?, angles },
        })
    }

    /// Returns whether the lines exist beside this number of pairs. A file may say anything.
    pub fn is_of(self, pairs: usize) -> bool {
        match self {
            Self::Pair(pair) | Self::Pencil { pair, .. } => pair < pairs,
            Self::Through { point, .. } => point.iter().all(|v| v.is_finite()),
        }
    }

    pub(super) fn swapped(self) -> Self {
        match self {
            Self::Pair(_) => self,
            Self::Through { side, point } => Self::Through { side: side.other(), point },
            Self::Pencil { pair, angles: [left, right] } => Self::Pencil { pair, angles: [right, left] },
        }
    }
}

impl Document {
    /// Pins a further line pair and inspects it.
    pub fn pin(&mut self, source: LineSource) {
        if self.pins.len() == PINS {
            self.pins.remove(0);
        }
        let number = (0..PINS).find(|number| self.pins.iter().all(|pin| pin.number != *number));
        self.pins.push(Pin { source, number: number.unwrap_or(0) });
        self.inspected = number;
    }

    /// Returns the pin whose profiles are shown.
    pub fn inspected_pin(&self) -> Option<&Pin> {
        self.pins.iter().find(|pin| Some(pin.number) == self.inspected)
    }

    /// Removes a pin, by its number. The newest of the others is inspected then.
    pub fn unpin(&mut self, number: usize) {
        self.pins.retain(|pin| pin.number != number);
        self.inspected = self.pins.last().map(|pin| pin.number);
    }

    /// Gives each pin other lines, and removes those without.
    pub(super) fn move_pins(&mut self, moved: impl Fn(LineSource) -> Option<LineSource>) {
        let pins = std::mem::take(&mut self.pins).into_iter();
        self.pins = pins.filter_map(|pin| Some(Pin { source: moved(pin.source)?, ..pin })).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_have_a_number_each_and_the_oldest_gives_way() {
        let mut document = Document::default();
        for pair in 0..=PINS {
            document.pin(LineSource::Pair(pair));
        }
        let inspected = |document: &Document| document.inspected_pin().map(|pin| pin.source);
        assert_eq!((document.pins.len(), inspected(&document)), (PINS, Some(LineSource::Pair(PINS))));
        for (k, pin) in document.pins.iter().enumerate() {
            assert_eq!(pin.source, LineSource::Pair(k + 1));
            assert!(document.pins[..k].iter().all(|other| other.number != pin.number));
        }
        document.unpin(document.pins[PINS - 1].number);
        assert_eq!(inspected(&document), Some(LineSource::Pair(PINS - 1)));
        document.move_pins(|source| source.without_pair(2));
        assert_eq!((document.pins.len(), document.pins[1].source), (PINS - 2, LineSource::Pair(2)));
    }
}
