//! Overlay of the line pairs through the clicks from which the geometry shown was built.

use super::{Canvas, Overlay};
use crate::app::model::computation::Freshness;
use crate::app::model::ids::OverlayId;
use crate::app::view::theme;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    id: OverlayId::ChosenLines,
    tooltip: "The two candidate line pairs, one through each click, from which the hypothesis shown was \
              built. They meet in its epipoles.",
    color: theme::PAIRS[0],
    magnified: false,
    draw,
};

fn draw(canvas: &Canvas) {
    // Lines of earlier points would miss the present ones.
    let current = |freshness| !matches!(freshness, Freshness::Stale | Freshness::Followed);
    if !canvas.model.shown().is_some_and(|shown| current(shown.freshness)) {
        return;
    }
    let Some(construction) = canvas.model.construction() else { return };
    for (pair, lines) in [construction.p(), construction.q()].into_iter().enumerate() {
        canvas.dashed_line(&canvas.own(lines), theme::LINE_WIDTH, theme::pair_color(pair));
    }
}
