//! The verdict: what was found, how far to trust it, and why.

use egui::{Color32, Grid, RichText, ScrollArea, Ui, vec2};

use super::{Section, command_button, finish_button};
use crate::app::command::Command;
use crate::app::scene::Scene;
use crate::app::theme;
use crate::app::verdict::{Tone, Verdict, verdict};
use crate::estimate::{Method, Preset};

/// Registered in [`super::SECTIONS`].
pub const SECTION: Section = Section { title: "Result", share: 0.5, tools: settings, show };

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
        Grid::new("facts").num_columns(2).min_row_height(18.0).spacing([16.0, 4.0]).show(ui, |ui| {
            for fact in facts {
                ui.weak(fact.name).on_hover_text(fact.tooltip);
                ui.label(fact.value).on_hover_text(fact.tooltip);
                ui.end_row();
            }
        });
    });
}

/// The choices of the estimate, from right to left.
fn settings(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let parameters = &scene.document.parameters;
    for (preset, name) in [(Preset::Paper, "Paper"), (Preset::Robust, "Robust")] {
        let response = ui.selectable_label(parameters.preset == preset, name);
        finish_button(ui, response, Command::SetPreset(preset), commands);
    }
    ui.weak("Preset");
    ui.add_space(theme::GAP);
    for (method, name) in [(Method::ThreePoint, "Three pairs"), (Method::TwoPoint, "Two pairs")] {
        let response = ui.selectable_label(parameters.method == method, name);
        finish_button(ui, response, Command::SetMethod(method), commands);
    }
    ui.weak("From");
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
