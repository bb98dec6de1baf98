//! Overlay of the epipolar line of the cursor in both images. On a sample, it shows what such lines are before anything
//! was placed.

use std::f64::consts::TAU;
use std::time::Duration;

use super::Canvas;
use crate::app::model::document::Side;
use crate::app::model::open_pair::Hover;
use crate::app::view::theme;
use crate::geometry::{FundamentalMatrix, Vector, finite_point};

/// Time of a turn of the line at the start, and their number.
const TURN: f64 = 12.0;
const TURNS: f64 = 2.0;
/// Time between two drawings of the turning line.
const STEP: Duration = Duration::from_millis(33);

pub fn draw(canvas: &Canvas) {
    if let Some(f) = canvas.model.lesson() {
        let turning = || turning(canvas, f);
        if let Some(hover) = canvas.model.open.hover.or_else(turning) {
            both(canvas, f, hover, 1.0);
        }
        return;
    }
    let (Some((shown, opacity)), Some(hover)) = (canvas.shown(), canvas.model.open.hover) else { return };
    // A dragged point has a line of its own.
    if !hover.dragging {
        both(canvas, shown.fundamental, hover, opacity);
    }
}

fn both(canvas: &Canvas, f: &FundamentalMatrix, hover: Hover, opacity: f32) {
    let (line, width, opacity) = if hover.side == canvas.side {
        // Faint, since the cursor is in this image.
        (canvas.line_through(f, hover.point), theme::LINE_WIDTH * 0.75, opacity * 0.55)
    } else {
        (canvas.line_from_other(f, hover.point), theme::LINE_WIDTH, opacity)
    };
    if let Some(line) = line {
        canvas.epipolar_line(&line, width, theme::HOVER.gamma_multiply(opacity));
    }
}

/// Returns a place on the line that turns about the left epipole until the mouse moves over a picture.
fn turning(canvas: &Canvas, f: &FundamentalMatrix) -> Option<Hover> {
    let epipole = finite_point(&f.epipole1())?;
    let context = canvas.painter.ctx();
    let (now, moved) = context.input(|input| (input.time, input.pointer.has_pointer()));
    let id = egui::Id::unique("first moment of the turning line");
    let since = now - context.data_mut(|data| *data.get_temp_mut_or(id, now));
    let moves = !moved && since < TURNS * TURN && !canvas.model.look.still_steps;
    if moves {
        context.request_repaint_after(STEP);
    } else if moved {
        context.data_mut(|data| data.insert_temp(id, f64::NEG_INFINITY));
    }
    let angle = if moves { since / TURN * TAU } else { 0.0 } - TAU / 12.0;
    let way = Vector::new(angle.cos(), angle.sin());
    Some(Hover { side: Side::Left, point: epipole + way * 100.0, dragging: false })
}
