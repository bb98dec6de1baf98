//! Overlay of numbered epipolar lines of the shown geometry, the same number in both images, and of the lines of
//! single pairs.

use super::Canvas;
use crate::app::model::Target;
use crate::app::model::document::{PointRef, Role};
use crate::app::model::verdict::LineLook;
use crate::app::view::theme;

pub fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    let look = canvas.model.line_look();
    let color = theme::line_color(look).gamma_multiply(opacity);
    let numbered = canvas.model.numbered_lines();
    let parts = || numbered.iter().filter_map(|own| Some((own.number, own.parts[canvas.side.index()]?)));
    for (_, part) in parts() {
        canvas.epipolar_part(&part, theme::LINE_WIDTH, color);
    }
    if look == LineLook::Hidden {
        return;
    }
    let document = &canvas.model.document;
    let selected = canvas.at_hand(document.selection).map(|at| at.pair);
    let hovered = canvas.at_hand(canvas.model.open.focus.hovered());
    let used =
        document.points(canvas.side.other()).filter(|(at, _)| document.role(at.pair) != Role::Excluded);
    for (at, other) in used {
        let Some(line) = canvas.line_from_other(shown.fundamental, other) else { continue };
        let is_off = canvas.model.outvoted(at.pair).is_some();
        if is_off || selected == Some(at.pair) || hovered == Some(Target::Pair(at.pair)) {
            canvas.epipolar_line(&line, theme::STRONG_LINE_WIDTH, color);
        }
        // The distance of the point from its line, visible when magnified.
        let own = PointRef { side: canvas.side, ..at };
        if let Some(point) = document.point(own) {
            let color = theme::pair_color(at.pair).gamma_multiply(opacity);
            canvas.segment(point, line.foot(point), theme::LINE_WIDTH, color);
        }
    }
    // Above all lines, from the outer end inwards.
    for (number, part) in parts() {
        let mut path = canvas.visible(&part);
        path.reverse();
        canvas.label_on(&path, &number.to_string(), color);
    }
}
