//! The measurement: a segment with its length and direction, and the intensities along it.

use egui::{Align2, FontId, Rect, Shape, Stroke, pos2, vec2};

use super::Canvas;
use crate::app::model::look::Tool;
use crate::app::model::measuring::Measuring;
use crate::app::view::theme;
use crate::geometry::Point;

/// Size of the plot of the intensities, screen points.
const PLOT_WIDTH: f32 = 150.0;
const PLOT_HEIGHT: f32 = 44.0;
/// Room around the text and the plot, screen points.
const PADDING: f32 = 5.0;
/// Largest number of samples along the segment.
const MOST_SAMPLES: usize = 300;

/// Draws the measurement of this image. Without a second place, it ends at the cursor.
pub fn draw(canvas: &Canvas) {
    let model = canvas.model;
    let own = canvas.at_hand(model.open.measuring).filter(|measuring| measuring.side == canvas.side);
    let Some(measuring) = own else { return };
    let under = model.open.hover.filter(|hover| hover.side == canvas.side && model.tool == Tool::Measure);
    let end = measuring.end.or(under.map(|hover| hover.point));
    canvas.dot(measuring.start, 3.0, theme::SELECTED);
    let Some(end) = end else { return };
    canvas.segment(measuring.start, end, theme::LINE_WIDTH, theme::SELECTED);
    canvas.dot(end, 3.0, theme::SELECTED);
    let (distance, degrees) = measuring.to(end);
    let text = format!("{distance:.2} px, {degrees:.1}°");
    let profile = measuring.end.map(|end| profile(canvas, &measuring, end)).unwrap_or_default();
    if profile.len() < 3 {
        canvas.label(canvas.transform.screen_from_image(end), &text, theme::SELECTED);
    } else {
        plot(canvas, end, &text, &profile);
    }
}

/// Returns the intensities from the first to the second place, about one per pixel.
fn profile(canvas: &Canvas, measuring: &Measuring, end: Point) -> Vec<f64> {
    let steps = (measuring.to(end).0.ceil() as usize).clamp(1, MOST_SAMPLES);
    let places = (0..=steps).map(|k| measuring.start + (end - measuring.start) * (k as f64 / steps as f64));
    places.filter_map(|place| canvas.model.intensity_at(canvas.side, place)).map(f64::from).collect()
}

/// Draws the text with a plot of the intensities below, beside the end of the segment.
fn plot(canvas: &Canvas, end: Point, text: &str, profile: &[f64]) {
    let Some(labels) = canvas.labels else { return };
    let (low, high) =
        profile.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
    let painter = canvas.painter;
    let write =
        |text: String, size: f32| painter.layout_no_wrap(text, FontId::proportional(size), theme::SELECTED);
    let (title, range) =
        (write(text.to_owned(), 13.0), write(format!("intensity {low:.0} to {high:.0}"), 11.0));
    let size = vec2(PLOT_WIDTH.max(title.size().x), title.size().y + range.size().y + PLOT_HEIGHT + 4.0);
    let at = canvas.transform.screen_from_image(end);
    let area = labels.place(canvas.transform.rect.shrink(2.0), at, size + vec2(2.0 * PADDING, 2.0 * PADDING));
    painter.rect_filled(area, 4.0, theme::LABEL_FILL);
    let inside = area.shrink(PADDING);
    let curve =
        Rect::from_min_size(inside.min + vec2(0.0, title.size().y + 2.0), vec2(inside.width(), PLOT_HEIGHT));
    let below = Align2::LEFT_BOTTOM.align_size_within_rect(range.size(), inside).min;
    painter.galley(inside.min, title, theme::SELECTED);
    painter.galley(below, range, theme::SELECTED);
    let place = |(k, value): (usize, &f64)| {
        let across = k as f32 / (profile.len() - 1) as f32;
        let up = ((value - low) / (high - low).max(1e-9)) as f32;
        pos2(egui::lerp(curve.x_range(), across), egui::lerp(curve.bottom()..=curve.top(), up))
    };
    let points = profile.iter().enumerate().map(place).collect();
    painter.add(Shape::line(points, Stroke::new(1.2, theme::SELECTED)));
}
