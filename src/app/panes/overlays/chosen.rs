//! The line pairs through the clicks that the geometry shown was built from.

use super::{Canvas, Overlay, Visibility};
use crate::app::computation::Freshness;
use crate::app::theme;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    name: "Chosen lines",
    tooltip: "The two candidate line pairs, one through each click, that the hypothesis shown was built from; \
              they meet in its epipoles.",
    color: theme::PAIRS[0],
    visibility: Visibility::OnRequest,
    magnified: false,
    draw,
};

fn draw(canvas: &Canvas) {
    // Lines of earlier points would miss the points as they are.
    let current = |freshness| !matches!(freshness, Freshness::Stale | Freshness::Followed);
    if !canvas.scene.shown().is_some_and(|shown| current(shown.freshness)) {
        return;
    }
    let Some(construction) = canvas.scene.construction() else { return };
    for (pair, lines) in [construction.p(), construction.q()].into_iter().enumerate() {
        canvas.dashed_line(&canvas.own(lines), theme::LINE_WIDTH, theme::pair_color(pair));
    }
}
