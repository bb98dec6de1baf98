//! Where the match of a first click may be.

use egui::Stroke;

use super::{Canvas, Overlay, Visibility};
use crate::app::theme;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    name: "Suggested match",
    tooltip: "After the first click of a pair: where the other image looks most alike, with the correlation of the \
              patches. Enter accepts a clear one.",
    color: theme::SUGGESTED,
    visibility: Visibility::Always,
    magnified: true,
    draw,
};

/// Rivals drawn beside the best place.
const RIVALS: usize = 4;

fn draw(canvas: &Canvas) {
    let scene = canvas.scene;
    if scene.document.half.is_none_or(|half| half.side == canvas.side) {
        return;
    }
    let Some(Ok(found)) = scene.suggestion else { return };
    let color = theme::pair_color(scene.document.pairs.len());
    let clear = found.clear().is_some();
    for (rank, candidate) in found.candidates.iter().take(1 + RIVALS).enumerate().rev() {
        let at = canvas.transform.screen_from_image(candidate.position);
        let best = rank == 0;
        let (radius, width) = if best { (11.0, 2.0) } else { (7.0, 1.3) };
        let shade = if best { 1.0 } else { 0.6 };
        for (color, width) in [(theme::HALO, width + 2.5), (theme::SUGGESTED.gamma_multiply(shade), width)] {
            canvas.painter.circle_stroke(at, radius, Stroke::new(width, color));
        }
        if best {
            canvas.painter.circle_filled(at, 2.0, color);
            let score = candidate.correlation;
            let text =
                if clear { format!("match? {score:.2}, Enter") } else { format!("{score:.2}, not clear") };
            canvas.label(at, &text, color);
        } else {
            canvas.label(at, &format!("{:.2}", candidate.correlation), theme::SUGGESTED.gamma_multiply(0.8));
        }
    }
}
