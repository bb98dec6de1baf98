//! The side panel: the verdict, then the steps of the algorithm in order.

mod parameters;
mod result;
mod steps;

use egui::{Button, Frame, Margin, ScrollArea, Ui, vec2};

use super::dialog::named;
use super::finish_button;
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::estimate::{Method, Preset, Search};

/// Height of a reliable result with all its figures, screen points.
const RESULT_HEIGHT: f32 = 240.0;

/// Shows the panel.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ScrollArea::vertical().id_salt("side").auto_shrink([false, false]).show(ui, |ui| {
        // The space of the scroll bar is always reserved, so that nothing jumps.
        let room = Margin { right: 10, ..Margin::ZERO };
        Frame::new().inner_margin(room).show(ui, |ui| {
            // The height of a full result is always reserved, so that the choices below stay in
            // place.
            ui.vertical(|ui| {
                ui.set_min_height(RESULT_HEIGHT);
                result::show(ui, model, commands);
            });
            ui.add_space(2.0);
            ui.separator();
            choices(ui, model, commands);
            ui.add_space(4.0);
            steps::show(ui, model, commands);
        });
    });
}

/// Shows the folded panel: the light of the verdict, and the button that unfolds the panel.
pub fn folded(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.vertical_centered(|ui| {
        ui.set_width(22.0);
        let show = named(ui.add(Button::new("◀").min_size(vec2(22.0, 22.0))), "Show side panel");
        finish_button(ui, show, Command::FoldSide, commands);
        ui.add_space(8.0);
        result::light(ui, model);
    });
}

/// Shows the preset and, for the published search, the method.
fn choices(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let parameters = &model.document.parameters;
    ui.horizontal(|ui| {
        ui.strong("Steps");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let defaults = parameters.with_preset(parameters.preset);
            let reset = ui.add_enabled(*parameters != defaults, egui::Button::new("Reset all"));
            finish_button(ui, reset, Command::ResetParameters, commands);
        });
    });
    egui::Grid::new("choices").num_columns(2).spacing([10.0, 4.0]).show(ui, |ui| {
        ui.weak("Preset");
        ui.horizontal(|ui| {
            for (preset, name) in [(Preset::Robust, "Robust"), (Preset::Paper, "As published")] {
                let response = ui.selectable_label(parameters.preset == preset, name);
                finish_button(ui, response, Command::SetPreset(preset), commands);
            }
        });
        ui.end_row();
        if parameters.search == Search::Lines {
            ui.weak("Method");
            ui.horizontal(|ui| {
                for (method, name) in [(Method::TwoPoint, "Two-point"), (Method::ThreePoint, "Three-point")] {
                    let response = ui.selectable_label(parameters.method == method, name);
                    finish_button(ui, response, Command::SetMethod(method), commands);
                }
            });
            ui.end_row();
        }
    });
}
