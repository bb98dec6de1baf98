//! Overlay of the epipole of an image, if visible. All epipolar lines pass through it.

use egui::{Color32, Stroke, vec2};

use super::Canvas;
use crate::app::view::theme;
use crate::geometry::{FundamentalMatrix, finite_point};

pub fn draw(canvas: &Canvas) {
    if let Some(truth) = canvas.model.truth() {
        mark(canvas, &truth.fundamental, ("true epipole", 36.0), theme::TRUE, 1.0);
    }
    if let Some((shown, opacity)) = canvas.shown() {
        let color = theme::line_color(canvas.model.line_look());
        mark(canvas, shown.fundamental, ("epipole", -2.0), color, opacity);
    }
}

fn mark(canvas: &Canvas, f: &FundamentalMatrix, (name, below): (&str, f32), color: Color32, opacity: f32) {
    let epipole = canvas.side.epipole(f);
    let Some(at) = finite_point(&epipole).map(|point| canvas.transform.screen_from_image(point)) else {
        return;
    };
    if !canvas.transform.rect.contains(at) {
        return;
    }
    let halo = theme::HALO.gamma_multiply(opacity);
    for (color, width) in [(halo, 4.0), (color.gamma_multiply(opacity), 2.0)] {
        let stroke = Stroke::new(width, color);
        canvas.painter.circle_stroke(at, 9.0, stroke);
        for arm in [vec2(1.0, 0.0), vec2(0.0, 1.0)] {
            canvas.painter.line_segment([at - arm * 14.0, at - arm * 4.0], stroke);
            canvas.painter.line_segment([at + arm * 4.0, at + arm * 14.0], stroke);
        }
    }
    canvas.label(at + vec2(4.0, below), name, color);
}
