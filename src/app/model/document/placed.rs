//! A document in other coordinates: those of another calibration.

use super::{Document, Given};
use crate::estimate::Match;
use crate::geometry::PointPair;

impl Document {
    /// Returns this document with its points at other places. Pairs without a place inside the
    /// pictures are removed. An imported geometry belongs to the old coordinates and is removed, too.
    #[must_use]
    pub fn placed(mut self, place: impl Fn(&PointPair) -> Option<PointPair>) -> Self {
        let places: Vec<Option<PointPair>> =
            self.pairs.iter().map(|pair| place(pair).filter(|place| self.contains(place))).collect();
        for (pair, place) in self.pairs.iter_mut().zip(&places) {
            *pair = place.unwrap_or(*pair);
        }
        let lost: Vec<usize> = (0..places.len()).filter(|pair| places[*pair].is_none()).collect();
        self.remove_all(lost);
        self.half = None;
        self.imported = None;
        self.given = self.given.map(|given| {
            let placed = |found: &Match| Some(Match { pair: place(&found.pair)?, ..*found });
            Given::new(given.file, given.matches.iter().filter_map(placed).collect())
        });
        self
    }
}
