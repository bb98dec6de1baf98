//! Overlay of the clicked points: rings, which leave the marked pixel visible, and squares for
//! pairs that only check.

use egui::{Pos2, Rect, Stroke, StrokeKind, Vec2};

use super::{Canvas, Pointing};
use crate::app::model::{Role, Target};
use crate::app::view::theme;

pub fn draw(canvas: &Canvas) {
    let document = &canvas.model.document;
    for (at, point) in document.points(canvas.side) {
        let centre = canvas.transform.screen_from_image(point);
        let role = document.role(at.pair);
        let left_out = role == Role::Excluded;
        let color =
            theme::pair_color(at.pair).gamma_multiply(if left_out { theme::STALE_OPACITY } else { 1.0 });
        let painter = canvas.painter;
        let outvoted = canvas.model.outvoted(at.pair).is_some();
        let is_small = canvas.is_lost_in_a_crowd(at.pair);
        let (radius, edge, width) = if is_small { (3.0, 3.0, 1.4) } else { (theme::HANDLE_RADIUS, 4.5, 2.2) };
        if canvas.at_hand(document.selection) == Some(at) {
            painter.circle_stroke(centre, theme::HANDLE_RADIUS + 3.5, Stroke::new(4.0, theme::HALO));
            painter.circle_stroke(centre, theme::HANDLE_RADIUS + 3.5, Stroke::new(1.5, theme::SELECTED));
        }
        for stroke in [Stroke::new(edge, theme::HALO), Stroke::new(width, color)] {
            if role == Role::Check {
                let area = Rect::from_center_size(centre, Vec2::splat(2.0 * radius));
                painter.rect_stroke(area, 1.0, stroke, StrokeKind::Middle);
            } else {
                painter.circle_stroke(centre, radius, stroke);
            }
        }
        if is_small {
            continue;
        }
        painter.circle_filled(centre, 2.2, theme::HALO);
        painter.circle_filled(centre, 1.3, color);
        let mark = if outvoted { " !" } else { "" };
        canvas.label(centre, &(document.name(at.pair) + mark), color);
    }
}

/// Returns the pair with a point at a screen position.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let points = canvas.model.document.points(canvas.side);
    let places = points.map(|(at, point)| (at.pair, canvas.transform.screen_from_image(point)));
    Pointing::nearest(places, position, theme::GRAB_RADIUS, Target::Pair)
}
