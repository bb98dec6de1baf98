//! Overlay of the uncertainty: bands around epipolar lines, and the ellipse of the epipole.

use egui::{Mesh, Shape, Stroke};

use super::Canvas;
use crate::app::model::document::Side;
use crate::app::model::verdict::LineLook;
use crate::app::view::theme;
use crate::estimate::{EpipoleEllipse, Uncertainty};
use crate::geometry::{Point, Segment, Vector};

/// Half-width of a band, in standard deviations.
const REACH: f64 = 2.0;
/// Number of pieces of a band, whose edges are hyperbolas.
const PIECES: usize = 24;
/// Width below which a band is hidden by its line, screen points.
const LEAST: f32 = 1.2;

pub fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    // The covariance belongs to the result only.
    let (None, None, Some(uncertainty)) = (shown.hypothesis, shown.contestant, shown.estimate.uncertainty())
    else {
        return;
    };
    if canvas.model.line_look() == LineLook::Hidden {
        return;
    }
    let hovered = canvas
        .at_hand(canvas.model.open.hover)
        .filter(|hover| hover.side != canvas.side)
        .map(|hover| hover.point);
    for lines in canvas.model.numbered_lines() {
        let [own, other] = [canvas.side, canvas.side.other()].map(|side| lines.parts[side.index()]);
        if let Some((own, other)) = own.zip(other) {
            band(canvas, uncertainty, nalgebra::center(&other.start, &other.end), &own, opacity);
        }
    }
    if let Some(other) = hovered {
        let line = canvas.line_from_other(shown.fundamental, other);
        if let Some(own) = line.and_then(|line| canvas.frame.clip(&line)) {
            band(canvas, uncertainty, other, &own, opacity);
        }
    }
    // Where only a plane is certain, other epipoles explain the matches as well.
    if shown.estimate.assessment.plane.is_some() {
        return;
    }
    let ellipse = match canvas.side {
        Side::Left => uncertainty.epipole1(),
        Side::Right => uncertainty.epipole2(),
    };
    if let Some(ellipse) = ellipse {
        outline(canvas, &ellipse, opacity);
    }
}

/// Draws the band of a part of a line, which is the epipolar line of the point `other`.
fn band(canvas: &Canvas, uncertainty: &Uncertainty, other: Point, segment: &Segment, opacity: f32) {
    let Some(along) = (segment.end - segment.start).try_normalize(f64::EPSILON) else { return };
    let normal = Vector::new(-along.y, along.x);
    let color = theme::BAND.gamma_multiply(0.45 * opacity);
    let (mut mesh, mut widest) = (Mesh::default(), 0f32);
    for k in 0..=PIECES {
        let at = segment.start + (segment.end - segment.start) * (k as f64 / PIECES as f64);
        let deviation = match canvas.side {
            Side::Left => uncertainty.line1_deviation(other, at),
            Side::Right => uncertainty.line2_deviation(other, at),
        };
        let Some(deviation) = deviation.filter(|deviation| deviation.is_finite()) else { return };
        let offset = normal * (REACH * deviation);
        for edge in [at + offset, at - offset] {
            mesh.colored_vertex(canvas.transform.screen_from_image(edge), color);
        }
        widest = widest.max((2.0 * REACH * deviation * canvas.transform.scale) as f32);
    }
    for k in 0..PIECES as u32 {
        mesh.add_triangle(2 * k, 2 * k + 1, 2 * k + 2);
        mesh.add_triangle(2 * k + 1, 2 * k + 2, 2 * k + 3);
    }
    if widest > LEAST {
        canvas.painter.add(Shape::mesh(mesh));
    }
}

fn outline(canvas: &Canvas, ellipse: &EpipoleEllipse, opacity: f32) {
    let (sin, cos) = ellipse.angle.sin_cos();
    let [long, short] = ellipse.half_axes.map(|half| half * REACH);
    // The ellipse of a distant epipole would look like a line through the image.
    if !canvas.frame.contains(ellipse.centre) {
        return;
    }
    let points = (0..48).map(|k| {
        let (v, u) = (f64::from(k) / 48.0 * std::f64::consts::TAU).sin_cos();
        let offset = Vector::new(cos * long * u - sin * short * v, sin * long * u + cos * short * v);
        canvas.transform.screen_from_image(ellipse.centre + offset)
    });
    let stroke = Stroke::new(1.5, theme::ESTIMATED.gamma_multiply(opacity));
    canvas.painter.add(Shape::closed_line(points.collect(), stroke));
}
