//! Which line pair is inspected: the pinned ones to choose from, and the figures of the sample under the cursor.

use egui::{Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, vec2};

use super::super::command_button;
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::document::pair_name;
use crate::app::model::focus::{LineSource, Target};
use crate::app::model::inspection::Inspection;
use crate::app::view::theme;

/// How near to an inspected line the cursor must be in an image to mark its sample in the plots, px.
const REACH: f64 = 12.0;
/// Shows it from right to left.
pub fn tools(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    if let Some(number) = model.open.focus.inspected_number() {
        command_button(ui, Command::Unpin(number), true, commands);
    }
    for (number, pin) in model.open.focus.pins().iter().enumerate().rev() {
        let chosen = model.open.focus.inspected_number() == Some(number);
        if swatch(ui, pin.color, chosen, &describe(pin.source)) {
            commands.push(Command::Inspect(number));
        }
    }
}

/// The figures of the sample under the cursor, or else which lines they are and how alike; with an explanation.
pub fn read_out(model: &Model) -> Option<(String, &'static str)> {
    let inspected = model.inspected()?;
    if let Some((inspection, sample)) = model.open.inspection.as_ref().zip(marked(model)) {
        let text = describe_sample(inspection, sample);
        return Some((text, "The sample of the left line under the cursor, and what it was matched with."));
    }
    let lines = describe(inspected.source);
    let text = match model.open.inspection.as_ref() {
        Some(inspection) => {
            let matching = &inspection.warped.matching;
            let cost = matching.cost as f64 / matching.sample_costs.len().max(1) as f64;
            format!("{lines}, {cost:.0} grey² a sample")
        }
        None => lines,
    };
    Some((text, "The inspected lines, and the mean cost of their best matching: lower is more alike."))
}

/// A pinned pair to choose; says whether it was chosen.
fn swatch(ui: &mut Ui, color: usize, chosen: bool, text: &str) -> bool {
    let (area, response) = ui.allocate_exact_size(vec2(18.0, 18.0), Sense::click());
    let name = format!("Inspect: {text}");
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, &name));
    ui.painter().rect_filled(area.shrink(2.0), 3.0, theme::PINNED[color]);
    let number = (color + 1).to_string();
    let font = egui::FontId::proportional(12.0);
    ui.painter().text(area.center(), egui::Align2::CENTER_CENTER, number, font, egui::Color32::BLACK);
    if chosen || response.hovered() || response.has_focus() {
        let stroke = Stroke::new(1.5, ui.visuals().strong_text_color());
        ui.painter().rect_stroke(area, 4.0, stroke, StrokeKind::Inside);
    }
    response.on_hover_text(text).clicked()
}

/// Which lines they are.
pub fn describe(source: LineSource) -> String {
    match source {
        LineSource::Pair(pair) => format!("Epipolar lines of {}", pair_name(pair)),
        LineSource::Through { side, point } => {
            format!("Epipolar lines of ({:.0}, {:.0}) in the {} image", point.x, point.y, side.name())
        }
        LineSource::Pencil { pair, angles: [angle1, angle2] } => format!(
            "Lines through {} at {:.1}° and {:.1}°",
            pair_name(pair),
            angle1.to_degrees(),
            angle2.to_degrees()
        ),
    }
}

/// The sample under the cursor: in a plot, or in an image near the line.
pub fn marked(model: &Model) -> Option<i32> {
    match (model.open.focus.hovered(), model.open.hover) {
        (Some(Target::Sample(sample)), _) => Some(sample),
        (_, Some(hover)) => model.open.inspection.as_ref()?.sample_near(hover.side, hover.point, REACH),
        _ => None,
    }
}

/// The figures of one sample.
fn describe_sample(inspection: &Inspection, sample: i32) -> String {
    let warped = &inspection.warped;
    let place = f64::from(sample) * inspection.step;
    let number = (sample - warped.profile1.first) as usize;
    let (Some(left), Some(disparity), Some(cost)) = (
        warped.profile1.get(sample),
        warped.matching.disparities.get(number),
        warped.matching.sample_costs.get(number),
    ) else {
        return String::new();
    };
    let right = warped.warped2.get(number).copied().flatten();
    let right = right.map_or("outside".to_owned(), |value| value.to_string());
    let shift = f64::from(*disparity) * inspection.step;
    format!("At {place:.0} px: left {left}, right {right}, shift {shift:+.0} px, cost {cost}")
}
