//! Overlay of the epipole of an image, where all epipolar lines meet: a ring with four ticks, or an arrow at the edge.

use egui::{Color32, Stroke, vec2};

use super::Canvas;
use super::hypotheses::{mark, place};
use crate::app::model::verdict::{EpipolePlace, LineLook, epipole_places};
use crate::app::view::theme;
use crate::geometry::FundamentalMatrix;

pub fn draw(canvas: &Canvas) {
    let model = canvas.model;
    if let Some(f) = model.lesson() {
        ring(canvas, f, ("the other camera", -2.0), theme::TRUE);
    }
    if let Some(truth) = model.truth() {
        ring(canvas, &truth.fundamental, ("true epipole", 36.0), theme::TRUE);
    }
    let look = model.line_look();
    let Some((shown, opacity)) = canvas.shown().filter(|_| look != LineLook::Hidden) else { return };
    let color = theme::line_color(look).gamma_multiply(opacity);
    // A lens moves the epipoles by more than the matches tell.
    let own = Some(shown.estimate).filter(|_| shown.is_result() && model.offered_lens().is_none());
    let places = epipole_places(&model.document, shown.fundamental, own);
    let told = places.as_ref().map(|places| &places[canvas.side.index()]);
    let is_open = told.is_some_and(EpipolePlace::is_open);
    if ring(canvas, shown.fundamental, (if is_open { OPEN } else { "epipole" }, -2.0), color)
        || canvas.is_figure
    {
        return;
    }
    let epipole = canvas.side.epipole(shown.fundamental);
    let text = match told {
        Some(_) if is_open => OPEN.to_owned(),
        Some(told) => told.label(),
        None => return,
    };
    if !is_open {
        mark(canvas, &epipole, color, 1.4);
    }
    canvas.label(place(canvas, &epipole).0, &text, color);
}

const OPEN: &str = "epipole not determined ◆";

/// Marks an epipole in sight. Returns whether it is.
fn ring(canvas: &Canvas, f: &FundamentalMatrix, (name, below): (&str, f32), color: Color32) -> bool {
    let (at, outwards) = place(canvas, &canvas.side.epipole(f));
    if outwards.is_some() {
        return false;
    }
    let halo = theme::HALO.gamma_multiply(f32::from(color.a()) / 255.0);
    for (color, width) in [(halo, 4.0), (color, 2.0)] {
        let stroke = Stroke::new(width, color);
        canvas.painter.circle_stroke(at, 9.0, stroke);
        for arm in [vec2(1.0, 0.0), vec2(0.0, 1.0)] {
            canvas.painter.line_segment([at - arm * 14.0, at - arm * 4.0], stroke);
            canvas.painter.line_segment([at + arm * 4.0, at + arm * 14.0], stroke);
        }
    }
    canvas.label(at + vec2(4.0, below), name, color);
    true
}
