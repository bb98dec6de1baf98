//! The epipole of an image, where it is in sight: all epipolar lines pass through it.

use egui::{Stroke, vec2};

use super::{Canvas, Overlay, Visibility};
use crate::app::document::Side;
use crate::app::theme;
use crate::geometry::finite_point;

/// Registered in [`super::OVERLAYS`].
pub const OVERLAY: Overlay = Overlay {
    name: "Epipoles",
    tooltip: "Where this image sees the other camera; all epipolar lines meet there.",
    color: theme::ESTIMATED,
    visibility: Visibility::AtFirst,
    magnified: false,
    draw,
};

fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    let epipole = match canvas.side {
        Side::Left => shown.fundamental.epipole1(),
        Side::Right => shown.fundamental.epipole2(),
    };
    let Some(at) = finite_point(&epipole).map(|point| canvas.transform.screen_from_image(point)) else {
        return;
    };
    if !canvas.transform.rect.contains(at) {
        return;
    }
    let color = theme::ESTIMATED.gamma_multiply(opacity);
    let halo = theme::HALO.gamma_multiply(opacity);
    for (color, width) in [(halo, 4.0), (color, 2.0)] {
        let stroke = Stroke::new(width, color);
        canvas.painter.circle_stroke(at, 9.0, stroke);
        for arm in [vec2(1.0, 0.0), vec2(0.0, 1.0)] {
            canvas.painter.line_segment([at - arm * 14.0, at - arm * 4.0], stroke);
            canvas.painter.line_segment([at + arm * 4.0, at + arm * 14.0], stroke);
        }
    }
    canvas.label(at + vec2(4.0, -2.0), "epipole", theme::ESTIMATED);
}
