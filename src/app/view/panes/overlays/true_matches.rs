//! Overlay of the true matches, the same ones in both images.

use egui::{Color32, Painter, Pos2, Stroke, vec2};

use super::{Canvas, Pointing};
use crate::app::model::{Model, Target};
use crate::app::view::theme;
use crate::geometry::PointPair;

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

pub fn draw(canvas: &Canvas) {
    let visible = canvas.painter.clip_rect();
    let many = drawn(canvas.model).nth(FEW).is_some();
    let usual = SIZES[usize::from(many)];
    for (number, pair) in drawn(canvas.model) {
        let at = canvas.place(pair);
        if !visible.contains(at) {
            continue;
        }
        let lit = canvas.at_hand(canvas.model.open.focus.hovered()) == Some(Target::TrueMatch(number));
        let (size, color) = if lit { (usual + 3.0, theme::SELECTED) } else { (usual, theme::TRUE) };
        cross(canvas.painter, at, size, color);
    }
}

/// Draws the mark of a true match. Crosses distinguish true matches from the dots of estimated ones.
pub fn cross(painter: &Painter, at: Pos2, size: f32, color: Color32) {
    for stroke in [Stroke::new(2.6, theme::HALO), Stroke::new(1.2, color)] {
        for arm in [vec2(size, size), vec2(size, -size)] {
            painter.line_segment([at - arm, at + arm], stroke);
        }
    }
}

/// Returns the match at a screen position.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let places = drawn(canvas.model).map(|(number, pair)| (number, canvas.place(pair)));
    Pointing::nearest(places, position, 6.0, Target::TrueMatch)
}
