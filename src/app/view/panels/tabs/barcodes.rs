//! Motion barcodes of the inspected line pair: the frames in which something moving crosses either
//! line.

use egui::{Align2, Color32, Rect, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::inspected::describe;
use crate::app::model::recording::{InspectedBarcodes, PlayerCommand};
use crate::app::model::{Command, Model};
use crate::app::view::theme;

/// Width of the names at the left, screen points.
const NAMES: f32 = 64.0;
/// Height of the frame numbers, screen points.
const SCALE: f32 = 18.0;
/// Largest height of a stripe, screen points.
const HIGHEST: f32 = 64.0;
/// Least distance between marks of the scale, screen points.
const APART: f32 = 60.0;

/// A stripe: its name, its colour, and whether it is set in a frame.
type BarcodeRow<'a> = (&'a str, Color32, &'a dyn Fn(usize) -> bool);

/// Shows the barcodes. A click or a drag goes to a frame.
pub fn show(ui: &mut Ui, model: &Model, inspected: &InspectedBarcodes, commands: &mut Vec<Command>) {
    ui.label(in_words(model, inspected));
    ui.add_space(4.0);
    let area = ui.available_rect_before_wrap().shrink2(vec2(4.0, 2.0));
    let [left, right] = &inspected.barcodes;
    let count = left.len().max(1);
    let height = ((area.height() - SCALE - 2.0 * theme::GAP) / 3.0).clamp(8.0, HIGHEST);
    let stripes = Rect::from_min_max(pos2(area.min.x + NAMES, area.min.y), area.max);
    let x_of = |frame: usize| stripes.min.x + stripes.width() * frame as f32 / count as f32;
    let response = ui.allocate_rect(area, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Motion barcodes"));
    let painter = ui.painter_at(area);
    // Motion has the same colour as in the images.
    let (paper, ink) = (theme::palette(ui.visuals()).canvas, theme::MOVING);
    let font = egui::FontId::proportional(12.0);
    let weak = ui.visuals().weak_text_color();
    let rows: [BarcodeRow; 3] = [
        ("Left line", ink, &|frame| left.is_set(frame)),
        ("Right line", ink, &|frame| right.is_set(frame)),
        ("Mismatch", theme::palette(ui.visuals()).bad, &|frame| left.is_set(frame) != right.is_set(frame)),
    ];
    let mut bottom = area.min.y;
    for (k, (name, color, is_set)) in rows.into_iter().enumerate() {
        // The mismatches have a thinner stripe than the two lines.
        let own = if k == 2 { height / 3.0 } else { height };
        let stripe = Rect::from_min_max(pos2(stripes.min.x, bottom), pos2(stripes.max.x, bottom + own));
        painter.rect_filled(stripe, 0.0, paper);
        for run in runs(count, is_set) {
            let (from, to) = (x_of(run.start), x_of(run.end));
            painter.rect_filled(Rect::from_x_y_ranges(from..=to, stripe.y_range()), 0.0, color);
        }
        painter.text(pos2(area.min.x, stripe.center().y), Align2::LEFT_CENTER, name, font.clone(), weak);
        bottom = stripe.max.y + theme::GAP / 2.0;
    }
    for frame in (0..count).step_by(step_of(count, stripes.width())) {
        let text = (inspected.first + frame).to_string();
        painter.text(pos2(x_of(frame), bottom), Align2::LEFT_TOP, text, font.clone(), weak);
    }
    if let Some(shown) = model.shown_frames().and_then(|[left, _]| left.checked_sub(inspected.first)) {
        let x = x_of(shown) + 0.5 * stripes.width() / count as f32;
        painter.vline(x, area.min.y..=bottom, Stroke::new(3.0, theme::HALO));
        painter.vline(x, area.min.y..=bottom, Stroke::new(1.5, theme::HOVER));
    }
    let seeks = response.clicked() || response.dragged();
    if let Some(at) = response.interact_pointer_pos().filter(|at| seeks && at.x >= stripes.min.x) {
        let frame = ((at.x - stripes.min.x) / stripes.width() * count as f32) as usize;
        commands.push(PlayerCommand::Seek(inspected.first + frame.min(count - 1)).into());
    }
}

/// Describes the lines and their correlation.
fn in_words(model: &Model, inspected: &InspectedBarcodes) -> String {
    let lines = model.inspected().map_or_else(String::new, |inspected| describe(model, inspected.source));
    let [left, right] = &inspected.barcodes;
    let crossed = format!("crossed in {} and {} of {} frames", left.ones(), right.ones(), left.len());
    match inspected.correlation() {
        Some(correlation) => format!("{lines}: correlation {correlation:.2}, {crossed}."),
        None => format!("{lines}: {crossed}, too few changes to compare."),
    }
}

/// Returns the ranges of consecutive frames that are set.
pub(super) fn runs(count: usize, is_set: &dyn Fn(usize) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for frame in (0..count).filter(|frame| is_set(*frame)) {
        match runs.last_mut() {
            Some(run) if run.end == frame => run.end += 1,
            _ => runs.push(frame..frame + 1),
        }
    }
    runs
}

/// Returns the number of frames between two marks: a round number, far enough apart.
fn step_of(count: usize, width: f32) -> usize {
    let least = (count as f32 * APART / width.max(1.0)).ceil() as usize;
    let round = [1, 2, 5, 10, 20, 50, 100, 200, 500];
    round.into_iter().find(|step| *step >= least).unwrap_or(1000)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_of_neighbouring_frames_and_marks_are_round() {
        assert_eq!(runs(8, &|frame| [0, 1, 2, 5, 7].contains(&frame)), [0..3, 5..6, 7..8]);
        assert!(runs(4, &|_| false).is_empty());
        assert_eq!((step_of(300, 900.0), step_of(10, 900.0), step_of(2000, 300.0)), (20, 1, 500));
    }
}
