//! Terms of the field in texts: a thin dotted line under each, and its meaning as a tooltip.

use std::ops::Range;
use std::sync::Arc;

use egui::text::{CCursor, CharIndex, Galley};
use egui::{Align, FontSelection, Label, Rect, Response, RichText, Shape, TextStyle, Ui, WidgetText};

use crate::app::model::glossary::terms_in;

/// Distance and radius of the dots below a term, screen points.
const DOTS: [f32; 2] = [3.0, 0.6];

/// Shows a text of at most this many rows, with the meanings of its terms. A longer text is whole in its tooltip.
pub fn label(ui: &mut Ui, text: impl Into<RichText>, rows: usize) -> Response {
    let (text, width) = (text.into(), ui.available_width());
    let terms = terms_in(text.text());
    let style = FontSelection::Style(TextStyle::Body);
    let job = WidgetText::from(text).into_layout_job(ui.style(), style, Align::Center);
    let mut job = Arc::unwrap_or_clone(job);
    (job.wrap.max_rows, job.wrap.max_width) = (rows, width);
    let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
    let response = ui.add(Label::new(Arc::clone(&galley)));
    let mut pointed = None;
    for (range, meaning) in terms {
        for area in areas(&galley, range) {
            let area = area.translate(response.rect.min.to_vec2());
            underline(ui, area);
            if response.hover_pos().is_some_and(|at| area.contains(at)) {
                pointed = Some(meaning);
            }
        }
    }
    match pointed {
        Some(meaning) => response.on_hover_text(meaning),
        None => response,
    }
}

/// Underlines a short text that has a term. Returns the meaning of the term.
pub fn mark(ui: &Ui, area: Rect, text: &str) -> Option<&'static str> {
    let (_, meaning) = terms_in(text).next()?;
    underline(ui, area);
    Some(meaning)
}

/// Returns the areas of letters, one for each row of the text that has some.
fn areas(galley: &Galley, letters: Range<usize>) -> Vec<Rect> {
    let mut areas: Vec<Rect> = Vec::new();
    for letter in letters {
        let start = CCursor { prefer_next_row: true, ..CCursor::new(CharIndex(letter)) };
        let [start, end] =
            [start, CCursor::new(CharIndex(letter + 1))].map(|cursor| galley.pos_from_cursor(cursor));
        match areas.last_mut().filter(|area| area.y_range().contains(end.center().y)) {
            Some(area) => area.max.x = end.max.x,
            None => areas.push(Rect::from_min_max(start.min, end.max)),
        }
    }
    areas
}

fn underline(ui: &Ui, area: Rect) {
    let [distance, radius] = DOTS;
    let color = ui.visuals().weak_text_color();
    ui.painter().extend(Shape::dotted_line(
        &[area.left_bottom(), area.right_bottom()],
        color,
        distance,
        radius,
    ));
}
