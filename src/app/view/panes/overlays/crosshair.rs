//! The crosshair of the keyboard.

use egui::{Stroke, vec2};

use super::Canvas;
use crate::app::view::theme;

/// Length of an arm, and its distance from the place, screen points.
const ARM: f32 = 26.0;
const GAP: f32 = 5.0;

pub fn draw(canvas: &Canvas) {
    let Some(own) = canvas.model.open.crosshair.filter(|own| own.side == canvas.side) else { return };
    let at = canvas.transform.screen_from_image(own.point);
    for stroke in [Stroke::new(4.0, theme::HALO), Stroke::new(1.6, theme::HOVER)] {
        for way in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
            canvas.painter.line_segment([at + way * GAP, at + way * ARM], stroke);
        }
    }
}
