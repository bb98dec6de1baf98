//! How far each refined match is from where it should lie, magnified.

use super::{Canvas, Overlay, Visibility};
use crate::app::document::Side;
use crate::app::theme;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    name: "Residuals ×50",
    tooltip: "From each refined match to its epipolar line, 50 times as long as in the image: one pixel off is a \
              stroke of 50 pixels.",
    color: theme::BACKWARD,
    visibility: Visibility::OnRequest,
    magnified: false,
    draw,
};

/// How many times longer than it is a residual is drawn.
const MAGNIFICATION: f64 = 50.0;
/// Strokes drawn at most, spread over the list, which is in the order of the corners.
const DRAWN: usize = 300;

fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    let matches = shown.estimate.matches();
    for matched in matches.iter().step_by(matches.len().div_ceil(DRAWN).max(1)) {
        let pair = &matched.pair;
        let (point, other) = match canvas.side {
            Side::Left => (pair.point1, pair.point2),
            Side::Right => (pair.point2, pair.point1),
        };
        if let Some(line) = canvas.line_from_other(shown.fundamental, other) {
            let end = point + (line.foot(point) - point) * MAGNIFICATION;
            canvas.segment(point, end, 1.2, theme::BACKWARD.gamma_multiply(opacity));
        }
    }
}
