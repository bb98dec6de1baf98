//! Overlay of the magnified distances of refined matches from their epipolar lines.

use super::Canvas;
use crate::app::view::theme;

/// Magnification of a residual.
pub(super) const MAGNIFICATION: f64 = 50.0;
/// Largest number of residuals drawn, spread over the list, which is in the order of the corners.
pub(super) const DRAWN: usize = 300;

pub fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    let matches = shown.estimate.matches();
    for matched in matches.iter().step_by(matches.len().div_ceil(DRAWN).max(1)) {
        let pair = &matched.pair;
        let (point, other) = (canvas.side.point(pair), canvas.side.other().point(pair));
        if let Some(line) = canvas.line_from_other(shown.fundamental, other) {
            let end = point + (line.foot(point) - point) * MAGNIFICATION;
            let color = theme::RESIDUAL.gamma_multiply(opacity);
            canvas.segment(point, end, 2.0, color);
            // A dot marks the start, so that the direction and short residuals are visible.
            canvas.dot(point, 2.0, color);
        }
    }
}
