//! The verdict: what was found, how far to trust it, and why.

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, RichText, ScrollArea, Ui, vec2};

use super::{Section, busy, command_button, finish_button};
use crate::app::command::Command;
use crate::app::scene::Scene;
use crate::app::theme;
use crate::app::verdict::{Fact, Tone, Verdict, verdict};
use crate::estimate::{Method, Preset};

/// Registered in [`super::SECTIONS`].
pub const SECTION: Section = Section { title: "Result", share: 0.5, tools: settings, show };

fn show(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let Verdict { tone, headline, facts, warnings } = verdict(scene.document, scene.computation);
    ui.horizontal(|ui| {
        let color = tone_color(ui, tone);
        if tone == Tone::Busy {
            busy::show(ui);
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
        // Lines of text, not of buttons.
        ui.spacing_mut().interact_size.y = 18.0;
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(18.0, 4.0);
            for fact in facts {
                ui.add(egui::Label::new(fact_text(ui, &fact)).extend()).on_hover_text(fact.tooltip);
            }
        });
    });
}

/// Name and figure as one piece, so that a line never breaks between them.
fn fact_text(ui: &Ui, fact: &Fact) -> LayoutJob {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let mut job = LayoutJob::default();
    let visuals = ui.visuals();
    for (text, color) in
        [(format!("{} ", fact.name), visuals.weak_text_color()), (fact.value.clone(), visuals.text_color())]
    {
        job.append(&text, 0.0, TextFormat::simple(font.clone(), color));
    }
    job
}

/// The choices of the estimate, from right to left.
fn settings(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let parameters = &scene.document.parameters;
    let roomy = ui.available_width() > 420.0;
    for (preset, name) in [(Preset::Paper, "Paper"), (Preset::Robust, "Robust")] {
        let response = ui.selectable_label(parameters.preset == preset, name);
        finish_button(ui, response, Command::SetPreset(preset), commands);
    }
    if roomy {
        ui.weak("Preset");
    }
    ui.add_space(theme::GAP);
    for (method, name) in [(Method::ThreePoint, "Three pairs"), (Method::TwoPoint, "Two pairs")] {
        let response = ui.selectable_label(parameters.method == method, name);
        finish_button(ui, response, Command::SetMethod(method), commands);
    }
    if roomy {
        ui.weak("From");
    }
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
