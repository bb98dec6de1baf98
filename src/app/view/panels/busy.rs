//! Activity indicator.

use std::time::Duration;

use egui::{Sense, Stroke, Ui, vec2};

/// Time between two steps of the animation. Smooth animation would redraw all the time, and without
/// a graphics card this would slow the computation down.
const STEP: Duration = Duration::from_millis(125);
const STEPS: f64 = 8.0;

pub fn show(ui: &mut Ui) {
    let (area, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
    let step = (ui.input(|input| input.time) / STEP.as_secs_f64()).floor() % STEPS;
    let start = std::f64::consts::TAU * step / STEPS;
    let arc = (0..=12).map(|k| {
        let (sin, cos) = (start + f64::from(k) * 0.35).sin_cos();
        area.center() + vec2(cos as f32, sin as f32) * 5.5
    });
    ui.painter().line(arc.collect(), Stroke::new(2.0, ui.visuals().weak_text_color()));
    ui.ctx().request_repaint_after(STEP);
}
