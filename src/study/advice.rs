//! Advice on clicks: the match of a point, the places of placed pairs, and the most useful next click.

use super::Study;
use crate::estimate::Estimate;
use crate::geometry::{Point, PointPair};
use crate::suggest::{
    ClickedImage, Known, NextClick, Rival, SuggestError, SuggestParameters, Suggestions, next_click, refine,
    suggest, view_at,
};

/// Distance from the match, as a share of the longer side, from which a pair counts as misplaced along its
/// line. Measurements of suggestions count a larger distance from the truth as wrong.
const SLID: f64 = 0.01;

/// What the images tell about the place of a pair along its epipolar line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceFound {
    /// The pair.
    pub pair: PointPair,
    /// Place of the match of the left point in the right image, px, if it is clear.
    pub place: Option<Point>,
    /// Whether the surroundings of both points are alike, or the match is at the right point.
    pub is_confirmed: bool,
}

impl Study {
    /// Suggests matches of a point clicked in one image, by known relations of the images ([`suggest`]).
    ///
    /// # Errors
    /// The errors of [`suggest`].
    pub fn suggest(
        &self,
        at: Point,
        clicked: ClickedImage,
        known: &Known,
        parameters: &SuggestParameters,
    ) -> Result<Suggestions, SuggestError> {
        suggest(self.images(), at, clicked, known, parameters)
    }

    /// Suggests matches of a point with the geometry, the view and the matches of a result. Without a result, the
    /// surroundings of placed pairs tell how the images are turned.
    ///
    /// # Errors
    /// The errors of [`suggest`].
    pub fn suggest_by(
        &self,
        found: Option<&Estimate>,
        placed: &[PointPair],
        at: Point,
        clicked: ClickedImage,
    ) -> Result<Suggestions, SuggestError> {
        let matches = found.map(Estimate::matched_pairs).unwrap_or_default();
        let view = match found {
            Some(found) => Some(found.view()),
            None => view_at(self.images(), placed),
        };
        let known = Known { fundamental: found.map(|found| *found.fundamental()), view, matches: &matches };
        self.suggest(at, clicked, &known, &SuggestParameters::default())
    }

    /// Looks for the matches of pairs along the epipolar lines of a result.
    pub fn places(&self, pairs: &[PointPair], found: &Estimate) -> Vec<PlaceFound> {
        let least = SLID * self.frames()[1].longer_side();
        let check = |pair: &PointPair| {
            let suggested = self.suggest_by(Some(found), &[], pair.point1, ClickedImage::First);
            let place = suggested.ok().and_then(|suggested| Some(suggested.clear()?.position));
            let is_there = place.is_some_and(|place| (place - pair.point2).norm() <= least);
            // At the border of two surfaces, each has its own match. The pair may be of the other one.
            let is_alike = || self.repaired(pair, Some(found)).is_ok();
            PlaceFound { pair: *pair, place, is_confirmed: is_there || is_alike() }
        };
        pairs.iter().map(check).collect()
    }

    /// Returns a better place for the right point of a pair, near its present place, px. A result tells how the
    /// images are turned.
    ///
    /// # Errors
    /// The errors of [`refine`].
    pub fn repaired(&self, pair: &PointPair, found: Option<&Estimate>) -> Result<Point, SuggestError> {
        let view = found.map(Estimate::view);
        let refined = refine(self.images(), pair, view, &SuggestParameters::default());
        refined.map(|refined| refined.position)
    }

    /// Returns the most useful place for one more pair beside the placed ones ([`next_click`]).
    pub fn next_click(&self, found: &Estimate, placed: &[PointPair]) -> Option<NextClick> {
        let (rival, matches) = (Rival::of(found), found.matched_pairs());
        next_click(self.images(), found.fundamental(), &rival, placed, &matches)
    }
}
