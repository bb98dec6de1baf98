//! What scrolling and pinching over a picture asks for.

use egui::{Pos2, Response, Ui};

/// How much a scroll of one point zooms, as an exponent.
const ZOOM_A_POINT: f32 = 0.005;

/// Where to zoom about and by which factor, if that is asked for.
pub fn zoom_asked(ui: &Ui, response: &Response) -> Option<(Pos2, f64)> {
    let at = response.hover_pos()?;
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    let factor = (scroll * ZOOM_A_POINT).exp() * pinch;
    ((factor - 1.0).abs() > 1e-6).then_some((at, f64::from(factor)))
}
