//! Overlay of the true epipolar lines of the same points.

use super::Canvas;
use crate::app::model::document::Role;
use crate::app::view::theme;

pub fn draw(canvas: &Canvas) {
    let model = canvas.model;
    let Some(truth) = model.truth() else { return };
    let document = &model.document;
    let points =
        document.points(canvas.side.other()).filter(|(at, _)| document.role(at.pair) != Role::Excluded);
    for (_, other) in points {
        if let Some(line) = canvas.line_from_other(&truth.fundamental, other) {
            canvas.dashed_line(&line, theme::LINE_WIDTH + 0.4, theme::TRUE);
        }
    }
    let cursor = model.open.hover.filter(|hover| hover.side != canvas.side && !hover.dragging);
    if let Some(line) = cursor.and_then(|hover| canvas.line_from_other(&truth.fundamental, hover.point)) {
        canvas.dashed_line(&line, theme::LINE_WIDTH * 0.75, theme::TRUE.gamma_multiply(0.8));
    }
}
