//! Overlay of the matches from elsewhere, coloured by whether they fit the shown geometry.

use egui::{Pos2, Stroke};

use super::{Canvas, Pointing};
use crate::app::model::document::GIVEN_FIT;
use crate::app::model::{Model, Target};
use crate::app::view::theme;
use crate::geometry::{PointPair, sampson_distance};

/// Largest number of matches drawn, spread over the list.
const DRAWN: usize = 2000;

/// Returns the matches that are drawn, with their indices.
fn drawn(model: &Model) -> impl Iterator<Item = (usize, &PointPair)> {
    let given = model.document.given.iter().flat_map(|given| given.pairs().enumerate());
    let step = model.document.given.as_ref().map_or(0, |given| given.matches.len()).div_ceil(DRAWN);
    given.step_by(step.max(1))
}

pub fn draw(canvas: &Canvas) {
    let visible = canvas.painter.clip_rect();
    let shown = canvas.shown().map(|(shown, _)| *shown.fundamental);
    for (number, pair) in drawn(canvas.model) {
        let at = canvas.place(pair);
        if !visible.contains(at) {
            continue;
        }
        let fits = shown.map(|f| sampson_distance(&f, pair) < GIVEN_FIT);
        let lit = canvas.at_hand(canvas.model.open.focus.hovered()) == Some(Target::GivenMatch(number));
        let (radius, color) = match fits {
            _ if lit => (5.0, theme::SELECTED),
            Some(false) => (2.6, theme::UNRELIABLE),
            _ => (2.6, theme::UNCHECKED),
        };
        // Rings distinguish them from the dots of the program's own matches.
        canvas.painter.circle_stroke(at, radius, Stroke::new(2.8, theme::HALO));
        canvas.painter.circle_stroke(at, radius, Stroke::new(1.3, color));
    }
}

/// Returns the match at a screen position.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let places = drawn(canvas.model).map(|(number, pair)| (number, canvas.place(pair)));
    Pointing::nearest(places, position, 6.0, Target::GivenMatch)
}
