//! A geometry that nobody clicked for, and the matches that stand in for the clicks.

use super::Model;
use super::document::Document;
use crate::estimate::{Method, Parameters, Search};
use crate::geometry::PointPair;
use crate::io::PairOrigin;

impl Document {
    /// Whether the images alone have to do: a person asked for it, and has not clicked enough since.
    pub fn is_unclicked(&self) -> bool {
        self.unclicked && self.used().count() < self.pairs_needed()
    }

    /// The parameters that the search is given: the published methods are a choice of the published search alone, and
    /// without enough pairs it compares all lines.
    pub fn search_parameters(&self) -> Parameters {
        let method = match self.parameters.search {
            Search::Lines if self.is_unclicked() => Method::LinesAlone,
            Search::Lines if self.most_pairs().is_some() => self.parameters.method,
            _ => Method::TwoPoint,
        };
        Parameters { method, ..self.parameters.clone() }
    }

    /// Makes pairs of the matches that stood in for clicks, for a person to look at and correct; they only check until
    /// somebody has.
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
    /// Whether a search without clicks would be something new.
    pub fn can_find_without_clicks(&self) -> bool {
        let document = &self.document;
        document.pictures.is_some()
            && !document.unclicked
            && document.used().count() < document.pairs_needed()
    }

    /// The matches that stand in for clicks in the result; none where clicks hold it.
    pub fn standing_in(&self) -> Vec<PointPair> {
        let result = self.open.computation.result().filter(|_| self.document.is_unclicked());
        result.and_then(|(estimate, _)| Some(estimate.trace.as_ref()?.clicks.chosen())).unwrap_or_default()
    }

    /// Whether some of these are no pairs yet.
    pub fn can_keep_matches(&self) -> bool {
        self.standing_in().iter().any(|pair| !self.document.pairs.contains(pair))
    }
}
