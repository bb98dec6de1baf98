//! A document in other coordinates: those of another calibration, or of the pictures in the other order.

use super::{Document, Given, LineSource};
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
        let frames = self.frames();
        self.move_pins(|source| match source {
            LineSource::Pair(_) => Some(source),
            LineSource::Through { side, point } => {
                let mut points = frames?.map(|frame| frame.centre());
                points[side.index()] = point;
                let [point1, point2] = points;
                Some(LineSource::Through { side, point: side.point(&place(&PointPair { point1, point2 })?) })
            }
            // Directions bend with the lens.
            LineSource::Pencil { .. } => None,
        });
        self.imported = None;
        self.given = self.given.map(|given| {
            let placed = |found: &Match| Some(Match { pair: place(&found.pair)?, ..*found });
            Given::new(given.file, given.matches.iter().filter_map(placed).collect())
        });
        self
    }

    /// Returns whether the other document is about the same pictures in the other order.
    pub fn is_swapped(&self, other: &Self) -> bool {
        let pictures = [self, other].map(|document| document.pictures.as_ref());
        matches!(pictures, [Some([a, b]), Some([c, d])] if [a, b] == [d, c] && [a, b] != [c, d])
    }

    /// Returns this document about the pictures in the other order. The ground truth belongs to the old
    /// order and is not used any more.
    #[must_use]
    pub fn swapped(mut self) -> Self {
        if let Some(pictures) = &mut self.pictures {
            pictures.reverse();
        }
        self.pairs.iter_mut().for_each(|pair| *pair = pair.swapped());
        self.move_pins(|source| Some(source.swapped()));
        if let Some(half) = &mut self.half {
            half.side = half.side.other();
        }
        if let Some(imported) = &mut self.imported {
            imported.fundamental = imported.fundamental.swapped();
            imported.cameras.iter_mut().for_each(|cameras| cameras.reverse());
        }
        self.given = self.given.map(|given| {
            let swapped = given.matches.iter().map(|found| Match { pair: found.pair.swapped(), ..*found });
            Given::new(given.file, swapped.collect())
        });
        Self { offset: -self.offset, truth: None, selection: None, ..self }
    }
}
