//! Line pairs that were pinned: one colour each, the same in both images.

use super::{Canvas, Overlay};
use crate::app::model::ids::OverlayId;
use crate::app::view::theme;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    id: OverlayId::Pinned,
    tooltip: "Line pairs pinned with the inspect tool, each with one colour in both images.",
    color: theme::PINNED[0],
    magnified: true,
    draw,
};

fn draw(canvas: &Canvas) {
    let inspected = canvas.model.open.focus.inspected().map(|pin| pin.source);
    for (color, pinned) in canvas.model.pinned() {
        let strong = inspected == Some(pinned.source);
        let width = if strong { theme::STRONG_LINE_WIDTH } else { theme::LINE_WIDTH };
        canvas.line(&pinned.lines[canvas.side.index()].line(), width, theme::PINNED[color]);
    }
}
