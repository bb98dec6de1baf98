//! The left column of the dock while a step is shown: what happens in it, its figures, and its parameters.

use egui::{Align, Button, CollapsingHeader, Label, Layout, RichText, ScrollArea, Ui};

use super::tabs::parameters;
use super::{finish_button, timeline};
use crate::app::model::step::result_text;
use crate::app::model::{Command, MethodStep, Model};
use crate::app::view::theme;
use crate::estimate::{Method, Preset, Search, SearchPlan};

/// Explains a step of the search of this document in one or two sentences.
pub fn sentence(step: MethodStep, model: &Model) -> String {
    let plan = model.document.search_plan();
    let (compares_all, by_barcodes) =
        (matches!(plan, SearchPlan::Barcodes | SearchPlan::LinesAlone { .. }), plan == SearchPlan::Barcodes);
    match step {
        MethodStep::Pencils if by_barcodes => {
            "A line turns about p on the left. Its best partner on the right is the line across which things move in \
             the same frames."
        }
        MethodStep::Pencils if plan == SearchPlan::Unclicked => {
            "As a test, lines through two matches are compared: each with its most similar line on the right."
        }
        MethodStep::Pencils => {
            "A line turns about p on the left. Its best partner on the right is the line with the most similar \
             brightness."
        }
        MethodStep::Candidates => "Candidates are line pairs of which each line is the best partner of the other.",
        MethodStep::Features => {
            "Distinctive places are matched by their surroundings, anywhere in the pictures. Matches that fit no \
             common geometry fade."
        }
        MethodStep::Epipoles if plan == SearchPlan::Unclicked => {
            "Small samples of the matches give hypotheses. Each has an epipole in either picture: where the other \
             camera might be."
        }
        MethodStep::Epipoles if compares_all => {
            "Three line pairs at a time give a hypothesis. Each has an epipole in either picture: where the other \
             camera might be."
        }
        MethodStep::Epipoles => {
            "A candidate of p and one of q cross. Where they cross, the other camera might be: a hypothesis."
        }
        MethodStep::RoundTrip => {
            "H maps a line l to the other picture, and G maps it back. The smaller the area between l and G H l, the \
             better both maps agree."
        }
        MethodStep::Validation if by_barcodes => {
            "The best hypotheses are fitted to the barcodes of lines all over both pictures. The best fit wins."
        }
        MethodStep::Validation => {
            "The best hypotheses race: each place of the picture supports those along whose lines it finds a match."
        }
        MethodStep::Refinement if by_barcodes => {
            "The best hypothesis is fitted to the barcodes in full size. Fits without some frames give its uncertainty."
        }
        MethodStep::Refinement => "The best hypothesis is fitted to matches along its lines, again and again.",
    }
    .to_owned()
}

/// Shows the words of a step.
pub fn show(ui: &mut Ui, step: MethodStep, model: &Model, commands: &mut Vec<Command>) {
    ScrollArea::vertical().id_salt("step").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.set_max_width(ui.available_width() - theme::SCROLL_BAR);
        let title = timeline::title(step, model.document.search_plan());
        let strong = ui.visuals().strong_text_color();
        ui.label(RichText::new(title).size(theme::VERDICT).color(strong));
        ui.add(Label::new(sentence(step, model)).wrap());
        ui.add_space(2.0);
        if let Some(moment) = model.open.replay.moment() {
            for figure in &moment.figures {
                ui.horizontal(|ui| {
                    ui.spacing_mut().interact_size.y = 0.0;
                    ui.weak(&figure.name);
                    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                        ui.add(Label::new(&figure.value).truncate());
                    });
                });
            }
        }
        for stage in step.stages() {
            if let Some(text) = result_text(*stage, &model.document, &model.open.computation) {
                ui.add(Label::new(RichText::new(text).weak()).wrap());
            }
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
