//! Overlay of suggested matches of a first click: a clear one, or several places that look alike.

use egui::{Pos2, Stroke};

use super::Canvas;
use crate::app::view::theme;
use crate::suggest::Clarity;

/// Number of rivals drawn beside the best match.
const RIVALS: usize = 4;
/// Distance from a better match within which a rival has no ring, screen points.
const RING_ROOM: f32 = 20.0;
/// Distance from a better match within which a rival has no label, screen points.
const LABEL_ROOM: f32 = 70.0;

/// Returns the correlations and places of the suggested matches in this image, best first. Rivals whose
/// rings would overlap with a better one are left out.
pub fn places(canvas: &Canvas) -> Vec<(f64, Pos2)> {
    let model = canvas.model;
    let is_due = model.document.half.is_some_and(|half| half.side != canvas.side);
    let found = model.open.suggestion.as_ref().filter(|_| is_due).and_then(|found| found.as_ref().ok());
    let mut places: Vec<(f64, Pos2)> = Vec::new();
    // Places that hardly look like the click would only mislead.
    let shown = found.filter(|found| matches!(found.verdict, Clarity::Clear | Clarity::Ambiguous));
    for candidate in shown.iter().flat_map(|found| &found.candidates).take(1 + RIVALS) {
        let at = canvas.transform.screen_from_image(candidate.position);
        if places.iter().all(|(_, better)| better.distance(at) > RING_ROOM) {
            places.push((candidate.correlation, at));
        }
    }
    places
}

pub fn draw(canvas: &Canvas) {
    let color = theme::pair_color(canvas.model.document.pairs.len());
    let is_clear = matches!(&canvas.model.open.suggestion, Some(Ok(found)) if found.clear().is_some());
    let places = places(canvas);
    let looks_best = places.iter().skip(1).all(|(rival, _)| *rival <= places[0].0);
    let offer = match (is_clear, looks_best) {
        (true, _) if canvas.model.open.crosshair.is_some_and(|own| own.moved) => "suggestion",
        (true, true) => "Enter to accept",
        (true, false) => "Enter to accept, moves like its neighbours",
        (false, _) => "one of several alike",
    };
    for (rank, (correlation, at)) in places.iter().enumerate().rev() {
        let (radius, width, shade) = if rank == 0 { (11.0, 2.0, 1.0) } else { (7.0, 1.3, 0.6) };
        for (color, width) in [(theme::HALO, width + 2.5), (theme::UNCHECKED.gamma_multiply(shade), width)] {
            canvas.painter.circle_stroke(*at, radius, Stroke::new(width, color));
        }
        if rank == 0 {
            canvas.painter.circle_filled(*at, 2.0, color);
            canvas.label(*at, &format!("{offer}, similarity {correlation:.2} of 1"), color);
        } else if places[..rank].iter().all(|(_, better)| better.distance(*at) > LABEL_ROOM) {
            canvas.label(*at, &format!("{correlation:.2}"), theme::UNCHECKED.gamma_multiply(0.8));
        }
    }
}
