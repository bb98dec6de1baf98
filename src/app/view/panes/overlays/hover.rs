//! Overlay of the epipolar line of the cursor in both images.

use super::Canvas;
use crate::app::view::theme;

pub fn draw(canvas: &Canvas) {
    let (Some((shown, opacity)), Some(hover)) = (canvas.shown(), canvas.model.open.hover) else { return };
    if hover.dragging {
        // A dragged point has a line of its own.
        return;
    }
    let f = shown.fundamental;
    let (line, width, opacity) = if hover.side == canvas.side {
        // Faint, since the cursor is in this image.
        (canvas.line_through(f, hover.point), theme::LINE_WIDTH * 0.75, opacity * 0.55)
    } else {
        (canvas.line_from_other(f, hover.point), theme::LINE_WIDTH, opacity)
    };
    if let Some(line) = line {
        canvas.epipolar_line(&line, width, theme::HOVER.gamma_multiply(opacity));
    }
}
