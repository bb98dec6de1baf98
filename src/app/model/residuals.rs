//! Distances of the check pairs from the shown geometry, in words.

use super::Model;
use super::document::Role;
use crate::comparison::Spread;
use crate::geometry::symmetric_epipolar_distance;

/// Summarises the distances of the check pairs. `None` without any, or without a geometry.
pub fn check_summary(model: &Model) -> Option<String> {
    let shown = model.shown()?;
    let document = &model.document;
    let pairs = document.pairs.iter().enumerate().filter(|(pair, _)| document.role(*pair) == Role::Check);
    let distances = pairs.map(|(_, pair)| symmetric_epipolar_distance(shown.fundamental, pair));
    let spread = Spread::of(&distances.filter(|distance| distance.is_finite()).collect::<Vec<_>>())?;
    let Spread { count, mean, median, .. } = spread;
    Some(format!("Check pairs {count}, mean {mean:.2} px, median {median:.2} px"))
}
