//! Estimates without clicks, and the matches that replace the clicks.

use super::Model;
use super::document::Document;
use crate::estimate::{Method, Parameters, Search};
use crate::geometry::PointPair;
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

    /// Adds the matches that replaced clicks as pairs. They are only checks until the user accepts
    /// them.
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
    /// Returns whether a search without clicks would give something new.
    pub fn can_find_without_clicks(&self) -> bool {
        let document = &self.document;
        document.pictures.is_some()
            && !document.unclicked
            && document.used().count() < document.pairs_needed()
    }

    /// Returns the matches that replace clicks in the result; none for an estimate from clicks.
    pub fn standing_in(&self) -> Vec<PointPair> {
        let result = self.open.computation.result().filter(|_| self.document.is_unclicked());
        result.and_then(|(estimate, _)| Some(estimate.trace.as_ref()?.clicks.chosen())).unwrap_or_default()
    }

    /// Returns whether any of these matches is not yet a pair.
    pub fn can_keep_matches(&self) -> bool {
        self.standing_in().iter().any(|pair| !self.document.pairs.contains(pair))
    }
}
