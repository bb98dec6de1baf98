//! Overlay of the candidate line pairs through the clicks: mutually most similar lines.

use super::Canvas;
use crate::app::view::heat;
use crate::geometry::AnchoredLine;

/// Number of candidates drawn through each click, by rank.
const DRAWN: usize = 80;

pub fn draw(canvas: &Canvas) {
    // Candidates of earlier points would miss the present ones.
    let Some(pencils) =
        canvas.model.open.computation.pencils().filter(|_| canvas.model.has_current_pencils())
    else {
        return;
    };
    for pencil in pencils {
        let click = canvas.side.point(&pencil.click);
        let drawn = pencil.candidates.len().min(DRAWN);
        // The best candidate comes last, on top.
        for (rank, candidate) in pencil.candidates.iter().take(drawn).enumerate().rev() {
            let likeness = 1.0 - rank as f32 / drawn.max(1) as f32;
            let line = AnchoredLine::at_angle(click, candidate.angles[canvas.side.index()]).line();
            let color = heat::color(likeness).gamma_multiply(0.35 + 0.55 * likeness);
            canvas.thin_line(&line, 0.8 + 0.6 * likeness, color);
        }
    }
}
