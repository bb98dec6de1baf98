//! Conditions under which actions apply.

use crate::app::model::Model;
use crate::estimate::Search;

pub fn has_neighbour(model: &Model, forward: bool) -> bool {
    model.folder().is_some_and(|(folder, pair)| folder.neighbour(pair, forward).is_some())
}

/// Returns whether the open folder has images besides the open pair.
pub fn has_strip(model: &Model) -> bool {
    model.folder().is_some_and(|(folder, _)| folder.names().len() > 2)
}

pub fn is_published_search(model: &Model) -> bool {
    model.document.parameters.search == Search::Lines
}

pub fn has_rectified(model: &Model) -> bool {
    model.open.rectified.is_some()
}

pub fn has_sequences(model: &Model) -> bool {
    model.recordings().is_some()
}
