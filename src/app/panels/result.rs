//! The verdict: what was found, how far to trust it, and why.

use egui::{Color32, Grid, RichText, ScrollArea, Ui, vec2};

use super::{Section, command_button};
use crate::app::command::Command;
use crate::app::scene::Scene;
use crate::app::theme;
use crate::app::verdict::{Tone, Verdict, verdict};
use crate::estimate::{Method, Preset};

/// Registered in [`super::SECTIONS`].
pub const SECTION: Section = Section { title: "Result", share: 0.5, show };

fn show(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let Verdict { tone, headline, facts, warnings } = verdict(scene.document, scene.computation);
    ui.horizontal(|ui| {
        let color = tone_color(ui, tone);
        if tone == Tone::Busy {
            ui.add(egui::Spinner::new().size(14.0));
        } else {
            let (dot, _) = ui.allocate_exact_size(vec2(14.0, 14.0), egui::Sense::hover());
            ui.painter().circle_filled(dot.center(), 5.0, color);
        }
        ui.add(egui::Label::new(RichText::new(headline).strong()).wrap());
        if scene.computation.is_running() {
            command_button(ui, Command::Stop, true, commands);
        }
    });
    ScrollArea::vertical().id_salt("result").auto_shrink([false, false]).show(ui, |ui| {
        for warning in warnings {
            let color = tone_color(ui, Tone::Caution);
            ui.add(egui::Label::new(RichText::new(warning).color(color)).wrap());
        }
        Grid::new("facts").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
            for fact in facts {
                ui.weak(fact.name).on_hover_text(fact.tooltip);
                ui.label(fact.value).on_hover_text(fact.tooltip);
                ui.end_row();
            }
        });
        ui.add_space(theme::GAP / 2.0);
        settings(ui, scene, commands);
    });
}

/// The choices of the estimate.
fn settings(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let parameters = &scene.document.parameters;
    ui.horizontal_wrapped(|ui| {
        ui.weak("Estimate from");
        for (method, name) in [(Method::TwoPoint, "Two pairs"), (Method::ThreePoint, "Three pairs")] {
            let command = Command::SetMethod(method);
            let response = ui.selectable_label(parameters.method == method, name);
            super::finish_button(ui, response, command, commands);
        }
        ui.add_space(theme::GAP);
        ui.weak("Preset");
        for (preset, name) in [(Preset::Robust, "Robust"), (Preset::Paper, "Paper")] {
            let command = Command::SetPreset(preset);
            let response = ui.selectable_label(parameters.preset == preset, name);
            super::finish_button(ui, response, command, commands);
        }
    });
}

fn tone_color(ui: &Ui, tone: Tone) -> Color32 {
    let palette = theme::palette(ui.visuals());
    match tone {
        Tone::Idle | Tone::Busy => ui.visuals().weak_text_color(),
        Tone::Good => palette.good,
        Tone::Caution => palette.caution,
        Tone::Bad => palette.bad,
    }
}
