//! Estimates without clicks, and the matches that replace the clicks.

use super::Model;
use super::document::{Document, Role, Side};
use crate::estimate::{CLICK_DEVIATIONS, Method, Parameters, RefinedMatch, Search, SearchPlan};
use crate::geometry::{PointPair, sampson_distance};
use crate::io::PairOrigin;

impl Document {
    /// Returns whether the estimate uses the images alone: requested by the user, and too few pairs
    /// since.
    pub fn is_unclicked(&self) -> bool {
        self.unclicked && self.used().count() < self.pairs_needed()
    }

    /// Returns the parameters for the search. The method only matters for the published search.
    /// Without enough pairs, that search compares all lines.
    pub fn search_parameters(&self) -> Parameters {
        let method = match self.parameters.search {
            Search::Lines if self.is_unclicked() => Method::LinesAlone,
            Search::Lines if self.most_pairs().is_some() => self.parameters.method,
            _ => Method::TwoPoint,
        };
        Parameters { method, ..self.parameters.clone() }
    }

    /// Returns the search of the current pairs and parameters. If pairs are missing and nobody asked
    /// for a search without them, it is the search that begins once they are there.
    pub fn search_plan(&self) -> SearchPlan {
        let used = self.used().count();
        let pairs = if self.is_unclicked() { used } else { used.max(self.pairs_needed()) };
        SearchPlan::of(&self.search_parameters(), pairs)
    }

    /// Lets the images decide alone. Enough pairs for an estimate become checks.
    pub fn leave_to_the_images(&mut self) {
        self.unclicked = true;
        self.half = None;
        if self.used().count() >= self.pairs_needed() {
            self.checks.extend(self.used().collect::<Vec<_>>());
        }
    }

    /// Adds matches as pairs. They are only checks until the user accepts them.
    pub fn keep_as_checks(&mut self, matches: &[PointPair]) {
        for pair in matches {
            let number = self.pairs.len();
            self.pairs.push(*pair);
            self.set_origin(number, PairOrigin::Automatic);
            self.checks.insert(number);
        }
    }
}

impl Model {
    /// Changes the role of a pair. If too few are left under a result of patches, the images decide
    /// alone: leaving out a misplaced pair must not lose the geometry that the images support.
    pub fn set_role(&mut self, pair: usize, role: Role) {
        let keeps = self.result().is_some() && self.document.parameters.search == Search::Patches;
        self.edit(|document| {
            document.set_role(pair, role);
            document.unclicked |= keeps && document.used().count() < document.pairs_needed();
        });
    }

    /// Returns whether a search without clicks would give something new.
    pub fn can_find_without_clicks(&self) -> bool {
        self.document.pictures.is_some()
            && !self.document.is_unclicked()
            && self.document.too_small().is_none()
    }

    /// Returns the matches that replaced clicks in the search, right or wrong; none for an estimate from
    /// clicks.
    pub(super) fn stood_in(&self) -> Vec<PointPair> {
        let result = self.result().filter(|_| self.document.is_unclicked());
        result.and_then(|estimate| Some(estimate.trace.as_ref()?.clicks.chosen())).unwrap_or_default()
    }

    /// Returns the matches that replace clicks in the result; none if the result contradicts one of them.
    pub fn standing_in(&self) -> Vec<PointPair> {
        let most = CLICK_DEVIATIONS * self.document.parameters.click_sigma;
        let fits = |pair: &PointPair| {
            self.result().is_some_and(|estimate| sampson_distance(estimate.fundamental(), pair) <= most)
        };
        let found = self.stood_in();
        if found.iter().all(fits) { found } else { Vec::new() }
    }

    /// Returns the matches that become point pairs on request: in each ninth of the left image, the match of
    /// the most similar patches. Without matches, those that replace the clicks.
    pub fn telling_matches(&self) -> Vec<PointPair> {
        let Some(frame) = self.document.frame(Side::Left).filter(|_| !self.stood_in().is_empty()) else {
            return Vec::new();
        };
        let part = |at: f64, size: usize| ((at / size as f64 * 3.0).max(0.0) as usize).min(2);
        let mut best: [Option<RefinedMatch>; 9] = [None; 9];
        for found in self.matches() {
            let point = found.pair.point1;
            let cell = &mut best[3 * part(point.y, frame.height) + part(point.x, frame.width)];
            if cell.is_none_or(|known| found.correlation > known.correlation) {
                *cell = Some(*found);
            }
        }
        let chosen: Vec<PointPair> = best.into_iter().flatten().map(|found| found.pair).collect();
        if chosen.is_empty() { self.standing_in() } else { chosen }
    }

    /// Returns whether any of these matches is not yet a pair.
    pub fn can_keep_matches(&self) -> bool {
        self.telling_matches().iter().any(|pair| !self.document.pairs.contains(pair))
    }
}
