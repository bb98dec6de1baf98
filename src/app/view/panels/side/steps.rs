//! The steps of the algorithm, each with its progress, findings and parameters.

use egui::collapsing_header::CollapsingState;
use egui::{Label, RichText, Ui};

use super::super::busy;
use super::parameters;
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::step::{StepProgress, progress, result_text};
use crate::app::view::theme;
use crate::estimate::Stage;

/// Shows all steps, one below the other.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    for (number, stage) in Stage::ALL.into_iter().enumerate() {
        let id = ui.make_persistent_id(("step", number));
        let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, false);
        let changed = parameters::is_any_changed(stage, &model.document.parameters);
        let header = ui.horizontal(|ui| {
            state.show_toggle_button(ui, egui::collapsing_header::paint_default_icon);
            let name = format!("{}  {}{}", number + 1, stage.label(), if changed { " *" } else { "" });
            let title = ui.add(Label::new(RichText::new(name)).selectable(false).sense(egui::Sense::click()));
            let clicked = title.on_hover_text(tooltip(stage)).clicked();
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                state_of(ui, progress(stage, &model.open.computation));
            });
            clicked
        });
        if header.inner {
            state.toggle(ui);
        }
        state.store(ui.ctx());
        if let Some(text) = result_text(stage, &model.document, &model.open.computation) {
            ui.indent(("found", number), |ui| {
                ui.add(Label::new(RichText::new(text).weak().small()).wrap());
            });
        }
        state.show_body_indented(&header.response, ui, |ui| {
            parameters::show(ui, stage, &model.document.parameters, commands);
        });
        ui.add_space(2.0);
    }
}

/// Returns a short description of a step.
fn tooltip(stage: Stage) -> &'static str {
    match stage {
        Stage::Pyramid => "Makes smaller versions of the images, since most of the search needs no detail.",
        Stage::Pencils => {
            "Compares all lines through a clicked point in one image with all lines through its match in \
             the other."
        }
        Stage::Hypotheses => {
            "Combines a line pair through p with one through q: their intersections are the epipoles. A \
             third line pair gives the map between the lines."
        }
        Stage::Validation => "Scores the best hypotheses over the whole of both images.",
        Stage::Refinement => "Fits the best geometry to image patches at full resolution.",
        Stage::Features => {
            "If the result is doubtful, proposes further geometries from features that tolerate rotation, \
             scale and distant viewpoints."
        }
    }
}

/// Shows the progress of a step in a word.
fn state_of(ui: &mut Ui, progress: StepProgress) {
    let palette = theme::palette(ui.visuals());
    match progress {
        StepProgress::Waiting => {
            ui.weak("waiting");
        }
        StepProgress::Running => {
            ui.label("running");
            busy::show(ui);
        }
        StepProgress::Done(None) => {
            ui.colored_label(palette.good, "done");
        }
        StepProgress::Done(Some(seconds)) => {
            ui.colored_label(palette.good, format!("done in {}", duration(seconds)));
        }
        StepProgress::Stopped => {
            ui.colored_label(palette.caution, "stopped");
        }
        StepProgress::Failed => {
            ui.colored_label(palette.bad, "failed");
        }
    }
}

fn duration(seconds: f64) -> String {
    let ms = seconds * 1000.0;
    if ms < 9.95 {
        format!("{ms:.1} ms")
    } else if ms < 999.5 {
        format!("{ms:.0} ms")
    } else {
        format!("{seconds:.2} s")
    }
}
