//! Overlay of the matches found by the refinement along the epipolar lines.

use egui::Pos2;

use super::{Canvas, Overlay, Pointing};
use crate::app::model::focus::Target;
use crate::app::model::ids::OverlayId;
use crate::app::view::theme;
use crate::estimate::RefinedMatch;
use crate::geometry::Point;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    id: OverlayId::Matches,
    tooltip: "Patches that the refinement matched along the epipolar lines. The geometry is fitted to them.",
    color: theme::MATCH,
    magnified: true,
    draw,
};

fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    let visible = canvas.painter.clip_rect();
    for (number, matched) in shown.estimate.matches().iter().enumerate() {
        let at = canvas.transform.screen_from_image(own(canvas, matched));
        if !visible.contains(at) {
            continue;
        }
        let lit = canvas.at_hand(canvas.model.open.focus.hovered()) == Some(Target::Match(number));
        let (radius, color) = if lit { (5.0, theme::SELECTED) } else { (2.2, theme::MATCH) };
        canvas.painter.circle_filled(at, radius + 1.2, theme::HALO.gamma_multiply(opacity));
        canvas.painter.circle_filled(at, radius, color.gamma_multiply(opacity));
    }
}

/// Returns the match at a screen position.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let (shown, _) = canvas.shown()?;
    let distances = shown.estimate.matches().iter().enumerate().map(|(number, matched)| {
        (number, canvas.transform.screen_from_image(own(canvas, matched)).distance(position))
    });
    let (number, distance) = distances.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (distance < 6.0).then_some(Pointing { target: Target::Match(number), distance })
}

fn own(canvas: &Canvas, matched: &RefinedMatch) -> Point {
    canvas.side.point(&matched.pair)
}
