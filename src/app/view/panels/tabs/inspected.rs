//! The choice of the inspected line pair, and the figures of the sample under the cursor.

use egui::containers::menu::MenuButton;
use egui::{
    Align, Align2, Color32, FontId, Rect, Role, ScrollArea, Sense, Stroke, StrokeKind, Ui, WidgetInfo,
    style::ScrollAnimation, vec2,
};

use super::super::command_button;
use super::super::dialog::named;
use crate::app::model::inspection::Inspection;
use crate::app::model::{Command, LineSource, Model, Target, pair_name};
use crate::app::view::theme;

/// Distance from an inspected line within which the cursor marks a sample in the plots, px.
const REACH: f64 = 12.0;
/// Largest number of pinned pairs shown as swatches. More are in a menu.
const SWATCHES: usize = 6;

/// Number of passes for which a menu counts as just opened.
const OPENING: u64 = 3;

/// Shows the choice from right to left.
pub fn tools(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let document = &model.document;
    if let Some(pin) = document.inspected_pin() {
        command_button(ui, Command::Unpin(pin.number), true, commands);
    }
    if document.pins.len() > SWATCHES {
        menu(ui, model, commands);
        return;
    }
    for pin in document.pins.iter().rev() {
        let text = describe(model, pin.source);
        let chosen = document.inspected_pin() == Some(pin);
        let (area, response) = ui.allocate_exact_size(vec2(18.0, 18.0), Sense::click());
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, chosen, format!("Inspect: {text}")));
        swatch(ui, area, pin.number);
        if chosen || response.hovered() || response.has_focus() {
            let stroke = Stroke::new(1.5, ui.visuals().strong_text_color());
            ui.painter().rect_stroke(area, 4.0, stroke, StrokeKind::Inside);
        }
        if response.on_hover_text(text).clicked() {
            commands.push(Command::Inspect(pin.number));
        }
    }
}

/// Shows a menu of many pinned pairs, scrolled to the inspected one.
fn menu(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let document = &model.document;
    let title = match document.inspected_pin() {
        Some(pin) => format!("Line pair {} of {}", pin.number + 1, document.pins.len()),
        None => format!("{} line pairs", document.pins.len()),
    };
    let (button, _) = MenuButton::new(title).ui(ui, |ui| {
        let room = (ui.ctx().content_rect().height() - 120.0).max(100.0);
        ScrollArea::vertical().max_height(room).show(ui, |ui| {
            let opening = just_opened(ui);
            for pin in &document.pins {
                ui.horizontal(|ui| {
                    let (area, _) = ui.allocate_exact_size(vec2(18.0, 18.0), Sense::hover());
                    swatch(ui, area, pin.number);
                    let text = describe(model, pin.source);
                    let chosen = document.inspected_pin() == Some(pin);
                    let row = named(ui.selectable_label(chosen, &text), &format!("Inspect: {text}"));
                    // Keep clear of the scroll bar.
                    ui.add_space(8.0);
                    if chosen && opening {
                        row.scroll_to_me_animation(Some(Align::Center), ScrollAnimation::none());
                    }
                    if row.clicked() {
                        commands.push(Command::Inspect(pin.number));
                    }
                });
            }
        });
    });
    button.on_hover_text("Choose which pinned line pair to inspect.");
}

/// Returns whether the surrounding menu was opened within the last few passes.
fn just_opened(ui: &Ui) -> bool {
    let (id, pass) = (ui.scope_id().with("opened"), ui.ctx().cumulative_pass_nr());
    let [opened, last] = ui.data(|data| data.get_temp::<[u64; 2]>(id)).unwrap_or([pass, 0]);
    let opened = if pass > last + 1 { pass } else { opened };
    ui.data_mut(|data| data.insert_temp(id, [opened, pass]));
    // The first pass only measures, and scrolling takes effect in the following one.
    pass < opened + OPENING
}

/// Draws the number of a pinned pair on the colour of pins.
fn swatch(ui: &Ui, area: Rect, number: usize) {
    ui.painter().rect_filled(area.shrink(2.0), 3.0, theme::PINNED);
    let font = FontId::proportional(if number < 9 { 12.0 } else { 11.0 });
    ui.painter().text(area.center(), Align2::CENTER_CENTER, (number + 1).to_string(), font, Color32::BLACK);
}

/// Returns the figures of the sample under the cursor, or else the inspected lines and their cost,
/// with an explanation.
pub fn read_out(model: &Model) -> Option<(String, &'static str)> {
    let inspected = model.inspected()?;
    if let Some((inspection, sample)) = model.open.inspection.as_ref().zip(marked(model)) {
        let text = describe_sample(inspection, sample);
        return Some((
            text,
            "The sample of the left line under the cursor: its place, the grey values of both lines, disparity and cost, grey².",
        ));
    }
    let lines = match inspected.source {
        LineSource::Pair(pair) => format!("Lines of {}", pair_name(pair)),
        LineSource::Through { side, point } => {
            let pixel = model.open.pixel(side, point);
            format!("Lines of {} ({:.0}, {:.0})", side.name(), pixel.x, pixel.y)
        }
        source @ LineSource::Pencil { .. } => describe(model, source),
    };
    let text = match model.open.inspection.as_ref() {
        Some(inspection) => {
            let matching = &inspection.warped.matching;
            let cost = matching.cost as f64 / matching.sample_costs.len().max(1) as f64;
            format!("{lines}, {cost:.0} grey²")
        }
        None => lines,
    };
    Some((
        text,
        "The inspected lines, and the mean cost per sample of their best matching. Similar lines have a low cost.",
    ))
}

/// Describes a line pair by its origin, a place by its pixel in the picture on the screen.
pub fn describe(model: &Model, source: LineSource) -> String {
    match source {
        LineSource::Pair(pair) => format!("Epipolar lines of {}", pair_name(pair)),
        LineSource::Through { side, point } => {
            let pixel = model.open.pixel(side, point);
            format!("Epipolar lines of ({:.0}, {:.0}) in the {} image", pixel.x, pixel.y, side.name())
        }
        LineSource::Pencil { pair, angles: [angle1, angle2] } => format!(
            "Lines through {} at {:.1}° and {:.1}°",
            pair_name(pair),
            angle1.to_degrees(),
            angle2.to_degrees()
        ),
    }
}

/// Returns the sample under the cursor, in a plot or near the line in an image.
pub fn marked(model: &Model) -> Option<i32> {
    match (model.open.focus.hovered(), model.open.hover) {
        (Some(Target::Sample(sample)), _) => Some(sample),
        (_, Some(hover)) => model.open.inspection.as_ref()?.sample_near(hover.side, hover.point, REACH),
        _ => None,
    }
}

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
    format!("{place:.0} px: grey {left}, {right}; disparity {shift:+.0} px; cost {cost}")
}
