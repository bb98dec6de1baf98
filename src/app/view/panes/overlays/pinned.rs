//! Line pairs that were pinned: a number and a colour each, the same in both images.

use super::{Canvas, Overlay};
use crate::app::model::ids::OverlayId;
use crate::app::view::theme;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    id: OverlayId::Pinned,
    tooltip: "Line pairs pinned with the pin tool, each with a colour and a number in both images.",
    color: theme::PINNED[0],
    magnified: true,
    draw,
};

/// Places for numbers along a line.
const PLACES: usize = 17;

fn draw(canvas: &Canvas) {
    let inspected = canvas.at_hand(canvas.model.open.focus.inspected()).map(|pin| pin.source);
    for (number, pinned) in canvas.model.pinned() {
        let color = theme::pin_color(number);
        let strong = inspected == Some(pinned.source);
        let width = if strong { theme::STRONG_LINE_WIDTH } else { theme::LINE_WIDTH };
        let line = pinned.lines[canvas.side.index()].line();
        canvas.line(&line, width, color);
        // Where the line is in sight, each at a place of its own, or the numbers of lines near each other would cover
        // each other.
        let Some([start, end]) = canvas.in_sight(&line) else { continue };
        let along = 0.08 + 0.05 * (number % PLACES) as f32;
        canvas.label(start.lerp(end, along), &(number + 1).to_string(), color);
    }
}
