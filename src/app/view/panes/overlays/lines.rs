//! Overlay of the epipolar lines of the clicked points.

use super::Canvas;
use crate::app::model::document::{PointRef, Role};
use crate::app::model::verdict::LineLook;
use crate::app::view::theme;
use crate::geometry::PointPair;

/// Opacity of the line of one of very many pairs.
const FAINT: f32 = 0.3;

pub fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    let color = theme::line_color(canvas.model.line_look()).gamma_multiply(opacity);
    let document = &canvas.model.document;
    let opposite = |pair: &PointPair| canvas.side.other().point(pair);
    let are_matches = !canvas.model.standing_in().is_empty();
    for (number, pair) in (1..).zip(canvas.model.unclicked_places()) {
        let Some(line) = canvas.line_from_other(shown.fundamental, opposite(&pair)) else { continue };
        canvas.epipolar_line(&line, theme::LINE_WIDTH, color);
        if are_matches {
            canvas.dot(canvas.side.point(&pair), theme::HANDLE_RADIUS, color);
            canvas.label(canvas.place(&pair), &format!("match {number}"), color);
        }
    }
    let selected = canvas.at_hand(document.selection).map(|at| at.pair);
    let wanted =
        document.points(canvas.side.other()).filter(|(at, _)| document.role(at.pair) != Role::Excluded);
    for (at, other) in wanted {
        let Some(line) = canvas.line_from_other(shown.fundamental, other) else { continue };
        let strong = selected == Some(at.pair);
        let width = if strong { theme::STRONG_LINE_WIDTH } else { theme::LINE_WIDTH };
        let is_faint = canvas.is_lost_in_a_crowd(at.pair);
        canvas.epipolar_line(&line, width, if is_faint { color.gamma_multiply(FAINT) } else { color });
        // The distance of the point from its line, visible when magnified.
        let own = PointRef { side: canvas.side, ..at };
        let is_drawn = canvas.model.line_look() != LineLook::Hidden;
        if let Some(point) = document.point(own).filter(|_| is_drawn) {
            let color = theme::pair_color(at.pair).gamma_multiply(opacity);
            canvas.segment(point, line.foot(point), theme::LINE_WIDTH, color);
        }
    }
}
