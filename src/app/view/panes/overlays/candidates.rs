//! Overlay of the candidate line pairs through the clicks: mutually most similar lines.

use egui::Color32;

use super::{Canvas, Overlay};
use crate::app::model::ids::OverlayId;
use crate::app::view::heat;
use crate::geometry::AnchoredLine;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    id: OverlayId::Candidates,
    tooltip: "Candidate epipolar lines through p and q: the most similar line pairs, from yellow (best) to \
              violet, as in the step Pencils.",
    color: Color32::from_rgb(92, 200, 99),
    magnified: false,
    draw,
};

/// Number of candidates drawn through each click, by rank.
const DRAWN: usize = 80;

fn draw(canvas: &Canvas) {
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
