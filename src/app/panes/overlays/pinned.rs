//! Line pairs that were pinned: one colour each, the same in both images.

use egui::Pos2;

use super::{Canvas, Overlay, Pointing, Visibility};
use crate::app::focus::Target;
use crate::app::theme;
use crate::geometry::AnchoredLine;

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

/// The sample of the inspected line nearest to a place of the screen, when that is near the line.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let inspected = canvas.scene.inspected()?;
    let line: AnchoredLine = inspected.lines[canvas.side.index()];
    let point = canvas.transform.image_from_screen(position);
    let distance = (line.line().distance(point) * canvas.transform.scale) as f32;
    // Samples are counted along the line of image 1.
    if canvas.side.index() != 0 || distance > theme::GRAB_RADIUS {
        return None;
    }
    let index = (point - line.anchor).dot(&line.direction).round();
    Some(Pointing { target: Target::Sample(index as i32), distance })
}
