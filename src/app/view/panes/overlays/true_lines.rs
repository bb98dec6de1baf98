//! Overlay of the true epipolar lines of the same points.

use super::{Canvas, Overlay};
use crate::app::model::document::Role;
use crate::app::model::ids::OverlayId;
use crate::app::view::theme;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    id: OverlayId::TrueLines,
    tooltip: "True epipolar lines of the clicked points and of the cursor, from the ground truth. Dashed, \
              so that an estimated line below shows through.",
    color: theme::TRUE,
    magnified: true,
    draw,
};

fn draw(canvas: &Canvas) {
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
