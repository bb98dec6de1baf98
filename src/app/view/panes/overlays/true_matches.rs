//! Overlay of the true matches, the same ones in both images.

use egui::{Pos2, Stroke};

use super::{Canvas, Overlay, Pointing};
use crate::app::model::Model;
use crate::app::model::focus::Target;
use crate::app::model::ids::OverlayId;
use crate::app::view::theme;
use crate::geometry::PointPair;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    id: OverlayId::TrueMatches,
    tooltip: "Points whose match in the other image is known. Point at one to see its match. At most 300 \
              are drawn.",
    color: theme::TRUE,
    magnified: false,
    draw,
};

/// Largest number of matches drawn, spread over the list.
const DRAWN: usize = 300;
/// Half-width of a mark, screen points, for few and for many matches. Many large marks would hide
/// the image.
const SIZES: [f32; 2] = [3.4, 2.2];
/// Largest number of matches that counts as few.
const FEW: usize = 80;

/// Returns the true matches that are drawn, with their indices.
pub fn drawn(model: &Model) -> impl Iterator<Item = (usize, &PointPair)> {
    let matches: &[PointPair] = model.truth().map_or(&[], |truth| &truth.matches);
    matches.iter().enumerate().step_by(matches.len().div_ceil(DRAWN).max(1))
}

fn draw(canvas: &Canvas) {
    let visible = canvas.painter.clip_rect();
    let many = drawn(canvas.model).nth(FEW).is_some();
    let usual = SIZES[usize::from(many)];
    for (number, pair) in drawn(canvas.model) {
        let at = canvas.transform.screen_from_image(canvas.side.point(pair));
        if !visible.contains(at) {
            continue;
        }
        let lit = canvas.at_hand(canvas.model.open.focus.hovered()) == Some(Target::TrueMatch(number));
        let (size, color) = if lit { (usual + 3.0, theme::SELECTED) } else { (usual, theme::TRUE) };
        // Crosses distinguish true matches from the dots of estimated ones.
        for (x, y) in [(1.0, 1.0), (1.0, -1.0)] {
            let arm = egui::vec2(x, y) * size;
            canvas.painter.line_segment([at - arm, at + arm], Stroke::new(2.6, theme::HALO));
        }
        for (x, y) in [(1.0, 1.0), (1.0, -1.0)] {
            let arm = egui::vec2(x, y) * size;
            canvas.painter.line_segment([at - arm, at + arm], Stroke::new(1.2, color));
        }
    }
}

/// Returns the match at a screen position.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let distances = drawn(canvas.model).map(|(number, pair)| {
        (number, canvas.transform.screen_from_image(canvas.side.point(pair)).distance(position))
    });
    let (number, distance) = distances.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (distance < 6.0).then_some(Pointing { target: Target::TrueMatch(number), distance })
}
