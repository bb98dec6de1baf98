//! Zooming by scrolling and pinching.

use egui::{Pos2, Response, Ui};

/// Zoom per scrolled point, as an exponent.
const ZOOM_A_POINT: f32 = 0.005;

/// Returns the centre and the factor of a requested zoom.
pub fn zoom_asked(ui: &Ui, response: &Response) -> Option<(Pos2, f64)> {
    let at = response.hover_pos()?;
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    let factor = (scroll * ZOOM_A_POINT).exp() * pinch;
    ((factor - 1.0).abs() > 1e-6).then_some((at, f64::from(factor)))
}
