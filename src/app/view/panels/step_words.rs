//! The left column of the dock while a step is shown: what happens in it, its figures, and its parameters.

use egui::{Align, Button, CollapsingHeader, Label, Layout, RichText, ScrollArea, Ui};

use super::tabs::parameters;
use super::{finish_button, terms};
use crate::app::model::step::{sentence, title};
use crate::app::model::{Command, MethodStep, Model};
use crate::app::view::theme;
use crate::estimate::{Method, Preset, Search};

pub fn show(ui: &mut Ui, step: MethodStep, model: &Model, commands: &mut Vec<Command>) {
    ScrollArea::vertical().id_salt("step").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.set_max_width(ui.available_width() - theme::SCROLL_BAR);
        let title = title(step, model.document.search_plan());
        let strong = ui.visuals().strong_text_color();
        terms::label(ui, RichText::new(title).size(theme::VERDICT).color(strong), 1);
        terms::label(ui, sentence(step, model.document.search_plan()), usize::MAX);
        ui.add_space(2.0);
        let figures = model.open.replay.moment().map_or(&[][..], |moment| &moment.figures);
        ui.scope(|ui| {
            ui.spacing_mut().interact_size.y = 0.0;
            for figure in figures {
                ui.horizontal(|ui| {
                    ui.weak(&figure.name);
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        ui.add(Label::new(&figure.value).truncate());
                    });
                });
            }
        });
        let course = model.course();
        let state = course.steps.iter().find(|timed| timed.step == step).map(|timed| timed.state.in_words());
        if let Some(text) = state.filter(|text| !text.is_empty()) {
            ui.add(Label::new(RichText::new(text).weak()).wrap());
        }
        if !step.stages().is_empty() {
            all_parameters(ui, step, model, commands);
        }
    });
}

fn all_parameters(ui: &mut Ui, step: MethodStep, model: &Model, commands: &mut Vec<Command>) {
    let own = &model.document.parameters;
    let is_changed = step.stages().iter().any(|stage| parameters::is_any_changed(*stage, own));
    let title = if is_changed { "Parameters *" } else { "Parameters" };
    CollapsingHeader::new(title).id_salt(("parameters", step.title())).show_unindented(ui, |ui| {
        choices(ui, model, commands);
        for stage in step.stages() {
            parameters::show(ui, *stage, own, commands);
        }
    });
}

/// Shows the preset and, for the published search, the method.
fn choices(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let parameters = &model.document.parameters;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.weak("Preset");
        for (preset, name) in [(Preset::Robust, "Robust"), (Preset::Paper, "As published")] {
            let response = ui.selectable_label(parameters.preset == preset, name);
            finish_button(ui, response, Command::SetPreset(preset), commands);
        }
        if parameters.search == Search::Lines {
            for (method, name) in [(Method::TwoPoint, "Two-point"), (Method::ThreePoint, "Three-point")] {
                let response = ui.selectable_label(parameters.method == method, name);
                finish_button(ui, response, Command::SetMethod(method), commands);
            }
        }
        let reset = *parameters != parameters.with_preset(parameters.preset);
        let button = ui.add_enabled(reset, Button::new("Reset all").small());
        finish_button(ui, button, Command::ResetParameters, commands);
    });
}
