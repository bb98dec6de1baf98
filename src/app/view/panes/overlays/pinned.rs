//! Overlay of the pinned line pairs: one colour per pair in both images, and a number where there
//! is room.

use egui::{Align2, Color32, FontId, Pos2, Rect, vec2};

use super::Canvas;
use crate::app::model::focus::LineSource;
use crate::app::view::theme;

/// Number of places tried for a number, from the border inwards.
const STEPS: usize = 7;
/// Space between these places, screen points.
const BETWEEN: f32 = 3.0;
/// Share of a line, from the border, on which its number may stand. Farther inwards it would cover
/// the image.
const BORDER: f32 = 0.4;
/// Distance within which a right click hits a line, screen points.
const REACH: f64 = 5.0;

pub fn draw(canvas: &Canvas) {
    let inspected = canvas.at_hand(canvas.model.open.focus.inspected()).map(|pin| pin.source);
    let mut numbers = Vec::new();
    for (number, pinned) in canvas.model.pinned() {
        let color = theme::pin_color(number);
        let strong = inspected == Some(pinned.source);
        let width = if strong { theme::STRONG_LINE_WIDTH } else { theme::LINE_WIDTH };
        let line = pinned.lines[canvas.side.index()].line();
        if matches!(pinned.source, LineSource::Pencil { .. }) {
            canvas.line(&line, width, color);
        } else {
            canvas.epipolar_line(&line, width, color);
        }
        // Only where the line is visible.
        let path = canvas.in_sight(&line);
        if !path.is_empty() {
            numbers.push((!strong, number, path, color));
        }
    }
    // Above all lines; the number of the inspected line comes first.
    numbers.sort_by_key(|(later, number, ..)| (*later, *number));
    for (_, number, path, color) in numbers {
        write_on(canvas, &path, number, color);
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

/// Writes a number onto its line, as near to the left border as other texts allow. Leaves out a
/// number that would cover another one.
fn write_on(canvas: &Canvas, path: &[Pos2], number: usize, color: Color32) {
    let Some(labels) = canvas.labels else { return };
    let font = FontId::proportional(12.0);
    let galley = canvas.painter.layout_no_wrap((number + 1).to_string(), font, color);
    let size = galley.size() + vec2(6.0, 0.0);
    let (Some(a), Some(b)) = (path.first(), path.last()) else { return };
    let from_left: Vec<Pos2> =
        if (a.x, a.y) <= (b.x, b.y) { path.to_vec() } else { path.iter().rev().copied().collect() };
    let length: f32 = path.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    let sight = canvas.sight();
    let step = size.x + BETWEEN;
    let ways =
        (0..STEPS).map(|k| (0.5 + k as f32) * step).take_while(|way| *way <= (BORDER * length).max(step));
    // The number of a line along the border is moved inside.
    let places = ways.map(|way| moved_into(Rect::from_center_size(along(&from_left, way), size), sight));
    let Some(area) = places.into_iter().find(|area| sight.contains_rect(*area) && labels.is_free(*area))
    else {
        return;
    };
    labels.take(area);
    canvas.painter.rect_filled(area, 3.0, theme::LABEL_FILL);
    let corner = Align2::CENTER_CENTER.align_size_within_rect(galley.size(), area).min;
    canvas.painter.galley(corner, galley, color);
}

/// Returns the point of a path at a distance from its start.
fn along(path: &[Pos2], mut way: f32) -> Pos2 {
    for ends in path.windows(2) {
        let length = ends[0].distance(ends[1]);
        if way <= length && length > 0.0 {
            return ends[0] + (ends[1] - ends[0]) * (way / length);
        }
        way -= length;
    }
    path.last().copied().unwrap_or_default()
}

/// Moves a rectangle by the smallest distance that brings it inside another one.
fn moved_into(area: Rect, other: Rect) -> Rect {
    let by = (other.min - area.min).max(vec2(0.0, 0.0)) + (other.max - area.max).min(vec2(0.0, 0.0));
    area.translate(by)
}
