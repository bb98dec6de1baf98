//! Line pairs that were pinned: one colour each, the same in both images.

use super::{Canvas, Overlay, Visibility};
use crate::app::theme;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    name: "Pinned",
    tooltip: "Line pairs pinned with the inspect tool, each with one colour in both images.",
    color: theme::PINNED[0],
    visibility: Visibility::AtFirst,
    magnified: true,
    draw,
};

fn draw(canvas: &Canvas) {
    let inspected = canvas.scene.focus.inspected().map(|pin| pin.source);
    for pinned in canvas.scene.pinned() {
        let strong = inspected == Some(pinned.source);
        let width = if strong { theme::STRONG_LINE_WIDTH } else { theme::LINE_WIDTH };
        canvas.line(&pinned.lines[canvas.side.index()].line(), width, pinned.color);
    }
}
