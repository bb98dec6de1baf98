//! Overlay of the matches found by the refinement along the epipolar lines.

use egui::Pos2;

use super::{Canvas, Pointing};
use crate::app::model::focus::Target;
use crate::app::view::theme;

pub fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    // The matches belong to the result, also while the lines are those of another geometry.
    let opacity = if shown.is_result() { opacity } else { opacity.min(theme::STALE_OPACITY) };
    let visible = canvas.painter.clip_rect();
    for (number, matched) in shown.estimate.matches().iter().enumerate() {
        let at = canvas.place(&matched.pair);
        if !visible.contains(at) {
            continue;
        }
        let lit = canvas.at_hand(canvas.model.open.focus.hovered()) == Some(Target::Match(number));
        let (radius, color) = if lit { (5.0, theme::SELECTED) } else { (2.2, theme::UNCHECKED) };
        canvas.painter.circle_filled(at, radius + 1.2, theme::HALO.gamma_multiply(opacity));
        canvas.painter.circle_filled(at, radius, color.gamma_multiply(opacity));
    }
}

/// Returns the match at a screen position.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let (shown, _) = canvas.shown()?;
    let places = shown.estimate.matches().iter().map(|matched| canvas.place(&matched.pair));
    Pointing::nearest(places.enumerate(), position, 6.0, Target::Match)
}
