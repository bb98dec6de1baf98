//! Overlay of the matched samples of the inspected line pair. Matching samples have the same
//! colour, which is faint where they are not alike.

use egui::{Pos2, Rect, Vec2};

use super::{Canvas, Pointing};
use crate::app::model::inspection::Inspection;
use crate::app::model::{Side, Target};
use crate::app::view::{heat, theme};
use crate::geometry::Point;

/// Radius of a dot with its dark edge, screen points.
const RADIUS: f32 = 5.0;
/// Approximate number of dots on a line.
const DOTS: i32 = 32;

pub fn draw(canvas: &Canvas) {
    // A pair that is inspected without being pinned would be in the way all the time.
    let pinned = canvas.model.document.inspected_pin().is_some();
    let Some(inspection) = inspection(canvas).filter(|_| pinned) else { return };
    let samples = inspection.samples();
    let (first, count) = (samples.start, samples.end - samples.start);
    for sample in samples.step_by((count / DOTS).max(1) as usize) {
        if let [Some(own), other] = places(canvas, inspection, sample) {
            let at = canvas.transform.screen_from_image(own);
            // The number of a line is more important than one of its dots.
            let area = Rect::from_center_size(at, Vec2::splat(2.0 * RADIUS));
            if canvas.labels.is_some_and(|labels| !labels.is_free(area)) {
                continue;
            }
            canvas.painter.circle_filled(at, RADIUS, theme::HALO);
            // A sample whose match is outside the other image has no colour.
            if other.is_some() {
                let color = heat::color((sample - first) as f32 / count.max(1) as f32);
                canvas.painter.circle_filled(at, 3.8, color.gamma_multiply(inspection.likeness(sample)));
            }
        }
    }
}

/// Returns the inspection of the present line pair.
fn inspection<'a>(canvas: &Canvas<'a>) -> Option<&'a Inspection> {
    let lines = canvas.model.inspected()?.lines;
    canvas.model.open.inspection.as_ref().filter(|inspection| inspection.lines == lines)
}

/// Returns the position of a sample in this image, and in the other one.
fn places(canvas: &Canvas, inspection: &Inspection, sample: i32) -> [Option<Point>; 2] {
    let (left, right) = (inspection.point1(sample), inspection.point2(sample));
    match canvas.side {
        Side::Left => [left, right],
        Side::Right => [right, left],
    }
}

/// Returns the position of a sample in this image.
pub fn place(canvas: &Canvas, sample: i32) -> Option<Point> {
    places(canvas, inspection(canvas)?, sample)[0]
}

/// Returns the sample at a screen position.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let inspection = inspection(canvas)?;
    let point = canvas.transform.image_from_screen(position);
    let reach = f64::from(theme::GRAB_RADIUS) / canvas.transform.scale;
    let sample = inspection.sample_near(canvas.side, point, reach)?;
    let distance = inspection.lines[canvas.side.index()].line().distance(point) * canvas.transform.scale;
    Some(Pointing { target: Target::Sample(sample), distance: distance as f32 })
}
