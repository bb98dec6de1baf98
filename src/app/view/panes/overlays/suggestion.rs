//! Overlay of suggested matches of a first click: a clear one, or several places that look alike.

use egui::Stroke;

use super::Canvas;
use crate::app::view::theme;
use crate::suggest::Clarity;

/// Number of rivals drawn beside the best match.
const RIVALS: usize = 4;
/// Distance from a better match within which a rival has no label, screen points.
const LABEL_ROOM: f32 = 70.0;

pub fn draw(canvas: &Canvas) {
    let model = canvas.model;
    if model.document.half.is_none_or(|half| half.side == canvas.side) {
        return;
    }
    let Some(Ok(found)) = model.open.suggestion.as_ref() else { return };
    // Places that hardly look like the click would only mislead.
    let offer = match found.verdict {
        Clarity::Clear => "Enter to accept",
        Clarity::Ambiguous => "one of several alike",
        Clarity::Weak | Clarity::NoReturn => return,
    };
    let color = theme::pair_color(model.document.pairs.len());
    let places = found
        .candidates
        .iter()
        .take(1 + RIVALS)
        .map(|candidate| (candidate.correlation, canvas.transform.screen_from_image(candidate.position)));
    let places: Vec<_> = places.collect();
    for (rank, (correlation, at)) in places.iter().enumerate().rev() {
        let (radius, width, shade) = if rank == 0 { (11.0, 2.0, 1.0) } else { (7.0, 1.3, 0.6) };
        for (color, width) in [(theme::HALO, width + 2.5), (theme::SUGGESTED.gamma_multiply(shade), width)] {
            canvas.painter.circle_stroke(*at, radius, Stroke::new(width, color));
        }
        if rank == 0 {
            canvas.painter.circle_filled(*at, 2.0, color);
            canvas.label(*at, &format!("{offer}, similarity {correlation:.2} of 1"), color);
        } else if places[..rank].iter().all(|(_, better)| better.distance(*at) > LABEL_ROOM) {
            canvas.label(*at, &format!("{correlation:.2}"), theme::SUGGESTED.gamma_multiply(0.8));
        }
    }
}
