//! Overlay of the pinned line pairs, each with its number where there is room.

use egui::Pos2;

use super::Canvas;
use crate::app::model::document::LineSource;
use crate::app::view::theme;

/// Distance within which a right click hits a line, screen points.
const REACH: f64 = 5.0;

pub fn draw(canvas: &Canvas) {
    let inspected = canvas.at_hand(canvas.model.document.inspected_pin()).map(|pin| pin.source);
    let mut numbers = Vec::new();
    for (number, pinned) in canvas.model.pinned() {
        let strong = inspected == Some(pinned.source);
        let width = if strong { theme::STRONG_LINE_WIDTH } else { theme::LINE_WIDTH };
        let line = pinned.lines[canvas.side.index()].line();
        if matches!(pinned.source, LineSource::Pencil { .. }) {
            canvas.line(&line, width, theme::PINNED);
        } else {
            canvas.epipolar_line(&line, width, theme::PINNED);
        }
        // Only where the line is visible.
        let path = canvas.in_sight(&line);
        if !path.is_empty() {
            numbers.push((!strong, number, path));
        }
    }
    // Above all lines; the number of the inspected line comes first.
    numbers.sort_by_key(|(later, number, ..)| (*later, *number));
    for (_, number, mut path) in numbers {
        if path.first().zip(path.last()).is_some_and(|(a, b)| (a.x, a.y) > (b.x, b.y)) {
            path.reverse();
        }
        canvas.label_on(&path, &format!("pin {}", number + 1), theme::PINNED);
    }
}

/// Returns the number of the pinned line under the cursor.
pub fn number_at(canvas: &Canvas, position: Pos2) -> Option<usize> {
    let at = canvas.transform.image_from_screen(position);
    let away = canvas.model.pinned().map(|(number, pinned)| {
        let distance = pinned.lines[canvas.side.index()].line().distance(at) * canvas.transform.scale;
        (number, distance)
    });
    let near = away.filter(|(_, distance)| *distance <= REACH && canvas.frame.contains(at));
    near.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(number, _)| number)
}
