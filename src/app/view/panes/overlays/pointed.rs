//! Overlay of the item pointed at elsewhere in the window.

use egui::Stroke;

use super::{Canvas, samples};
use crate::app::model::{PointRef, Side, Target};
use crate::app::view::theme;
use crate::geometry::Point;

pub fn draw(canvas: &Canvas) {
    let model = canvas.model;
    match model.open.focus.hovered() {
        Some(Target::Cell { pair, row, column }) => {
            let lines =
                model.open.computation.pencils().and_then(|pencils| pencils.get(pair)?.lines(row, column));
            if let Some(lines) = lines {
                canvas.line(&lines[canvas.side.index()].line(), theme::STRONG_LINE_WIDTH, theme::HOVER);
            }
        }
        Some(Target::Hypothesis(number)) => {
            let Some((shown, _)) = canvas.shown() else { return };
            let Some(hypothesis) = shown.estimate.hypotheses().get(number) else { return };
            for (_, other) in model.document.points(canvas.side.other()) {
                if let Some(line) = canvas.line_from_other(hypothesis.fundamental(), other) {
                    canvas.line(&line, theme::LINE_WIDTH, theme::UNCHECKED);
                }
            }
        }
        Some(Target::Pair(pair)) => {
            if let Some(point) = model.document.point(PointRef { pair, side: canvas.side }) {
                ring(canvas, point);
            }
        }
        Some(Target::Match(number)) => {
            let matched = canvas.shown().and_then(|(shown, _)| shown.estimate.matches().get(number).copied());
            if let Some(matched) = matched {
                ring(canvas, canvas.side.point(&matched.pair));
            }
        }
        Some(Target::TrueMatch(number)) => {
            if let Some(pair) = model.truth().and_then(|truth| truth.matches.get(number)) {
                ring(canvas, canvas.side.point(pair));
            }
        }
        Some(Target::GivenMatch(number)) => {
            if let Some(pair) = model.document.given.as_ref().and_then(|given| given.pairs().nth(number)) {
                ring(canvas, canvas.side.point(pair));
            }
        }
        Some(Target::Sample(index)) => {
            if let Some(point) = samples::place(canvas, index) {
                ring(canvas, point);
            }
        }
        Some(Target::Rectified { side, at }) => rectified(canvas, side, at),
        // The replay lights its own marks.
        Some(Target::Replayed(_)) | None => {}
    }
}

/// Highlights the pixel and the epipolar line of a position in the rectified pictures.
fn rectified(canvas: &Canvas, side: Side, at: Point) {
    let Some(rectified) = canvas.model.open.rectified.as_ref() else { return };
    let Ok(drawn) = &rectified.outcome else { return };
    let own = side == canvas.side;
    let Some(point) = drawn.shown.maps[side.index()].original_from_rectified(at) else { return };
    let line = if own {
        canvas.line_through(&rectified.fundamental, point)
    } else {
        canvas.line_from_other(&rectified.fundamental, point)
    };
    if let Some(line) = line {
        canvas.line(&line, theme::LINE_WIDTH, theme::HOVER);
    }
    if own && canvas.frame.contains(point) {
        ring(canvas, point);
    }
}

fn ring(canvas: &Canvas, point: Point) {
    let at = canvas.transform.screen_from_image(point);
    canvas.painter.circle_stroke(at, theme::HANDLE_RADIUS + 5.0, Stroke::new(4.0, theme::HALO));
    canvas.painter.circle_stroke(at, theme::HANDLE_RADIUS + 5.0, Stroke::new(2.0, theme::SELECTED));
}
