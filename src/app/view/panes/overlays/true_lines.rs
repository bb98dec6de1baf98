//! Overlay of the true epipolar lines of the same places as the numbered lines, and of the cursor.

use super::Canvas;
use crate::app::model::document::Side;
use crate::app::view::theme;
use crate::geometry::fan;

pub fn draw(canvas: &Canvas) {
    let model = canvas.model;
    let Some((truth, frames)) = model.truth().zip(model.document.frames()) else { return };
    let truth = &truth.fundamental;
    let shown = model.shown().map_or(truth, |shown| shown.fundamental);
    for place in fan::places(shown, frames[0]) {
        let line = match canvas.side {
            Side::Left => canvas.line_through(truth, place),
            Side::Right => canvas.line_from_other(truth, place),
        };
        if let Some(line) = line {
            canvas.dashed_line(&line, theme::LINE_WIDTH, theme::TRUE);
        }
    }
    let cursor = model.open.hover.filter(|hover| hover.side != canvas.side && !hover.dragging);
    if let Some(line) = cursor.and_then(|hover| canvas.line_from_other(truth, hover.point)) {
        canvas.dashed_line(&line, theme::LINE_WIDTH * 0.75, theme::TRUE.gamma_multiply(0.8));
    }
}
