//! Overlay of the magnified distances of matches from their epipolar lines.

use super::Canvas;
use crate::app::model::comparison::PointSet;
use crate::app::model::document::GIVEN_FIT;
use crate::app::model::{Model, TabId};
use crate::app::view::theme;
use crate::estimate::Estimate;
use crate::geometry::{PointPair, sampson_distance};

const MAGNIFICATION: f64 = 50.0;
/// Largest number of residuals drawn, spread over the list, which is in the order of the corners.
const DRAWN: usize = 300;

pub fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    let pairs = measured(canvas.model, shown.estimate);
    for pair in pairs.iter().step_by(pairs.len().div_ceil(DRAWN).max(1)) {
        let (point, other) = (canvas.side.point(pair), canvas.side.other().point(pair));
        if let Some(line) = canvas.line_from_other(shown.fundamental, other) {
            let end = point + (line.foot(point) - point) * MAGNIFICATION;
            let color = theme::UNCHECKED.gamma_multiply(opacity);
            canvas.segment(point, end, 2.0, color);
            // A dot marks the start, so that the direction and short residuals are visible.
            canvas.dot(point, 2.0, color);
        }
    }
}

/// Returns the matches whose distances are drawn: the matches of the geometry, or the given matches that fit
/// it while the tab measures on given matches.
fn measured(model: &Model, estimate: &Estimate) -> Vec<PointPair> {
    let of_given = model.open.comparison.as_ref().is_some_and(|found| found.measured == PointSet::Given);
    match &model.document.given {
        Some(given) if of_given && model.tab() == Some(TabId::Residuals) => {
            let fits = |pair: &&PointPair| sampson_distance(estimate.fundamental(), pair) < GIVEN_FIT;
            given.pairs().filter(fits).copied().collect()
        }
        _ => estimate.matches().iter().map(|found| found.pair).collect(),
    }
}
