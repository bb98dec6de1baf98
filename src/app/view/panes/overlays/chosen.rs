//! Overlay of the line pairs through the clicks from which the geometry shown was built.

use super::Canvas;
use crate::app::view::theme;

pub fn draw(canvas: &Canvas) {
    // Lines of earlier points would miss the present ones.
    if canvas.model.shown().is_none_or(|shown| shown.freshness.is_behind()) {
        return;
    }
    let Some(construction) = canvas.model.construction() else { return };
    for (pair, lines) in [construction.p(), construction.q()].into_iter().enumerate() {
        canvas.dashed_line(&canvas.own(lines), theme::LINE_WIDTH, theme::pair_color(pair));
    }
}
