//! Overlay of the magnified differences between the rows of matching points: a map of how far a pair is from
//! being rectified.

use super::Canvas;
use super::residuals::{DRAWN, MAGNIFICATION};
use crate::app::view::theme;

pub fn draw(canvas: &Canvas) {
    let Some((shown, _)) = canvas.shown() else { return };
    let matches = shown.estimate.matches();
    for matched in matches.iter().step_by(matches.len().div_ceil(DRAWN).max(1)) {
        let (point, other) = (canvas.side.point(&matched.pair), canvas.side.other().point(&matched.pair));
        let mut end = point;
        end.y += (other.y - point.y) * MAGNIFICATION;
        canvas.segment(point, end, 2.0, theme::UNCHECKED);
        canvas.dot(point, 2.0, theme::UNCHECKED);
    }
}
