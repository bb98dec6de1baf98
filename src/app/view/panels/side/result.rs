//! The verdict: the result, its reliability, and the reasons.

use egui::{Grid, Label, RichText, Ui, vec2};

use super::super::dialog::named;
use super::super::gauge::{self, tone_color};
use super::super::{busy, command_button, finish_button};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::command::ExchangeCommand;
use crate::app::model::comparison::Contestant;
use crate::app::model::verdict::{
    Fact, Tone, VerdictInWords, epipoles, hypothesis_facts, import_facts, import_warning, verdict,
};
use crate::app::view::theme;

/// Shows the verdict.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.strong("Result");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let fold = named(ui.add(egui::Button::new("▶").min_size(vec2(22.0, 22.0))), "Hide side panel");
            finish_button(ui, fold, Command::FoldSide, commands);
            if model.open.computation.is_running() {
                command_button(ui, Command::Stop, true, commands);
            }
        });
    });
    if let Some(shown) = model.shown() {
        if let Some((number, hypothesis)) = shown.hypothesis {
            another_shown(ui, &format!("hypothesis {}", number + 1), commands);
            list(
                ui,
                true_error(model).chain(hypothesis_facts(
                    &model.document,
                    hypothesis,
                    model.open.computation.searched(),
                )),
            );
            return;
        }
        if let Some(contestant) = shown.contestant {
            let name = match contestant {
                Contestant::Truth => "the true geometry".to_owned(),
                Contestant::Imported => "the imported geometry".to_owned(),
                other => format!("the {} geometry", other.name()),
            };
            if model.has_result() {
                another_shown(ui, &name, commands);
            } else {
                let text = format!(
                    "The images show {name}. Mark two point pairs to estimate a geometry for comparison."
                );
                ui.add(Label::new(RichText::new(text).strong()).wrap());
            }
            let imported = model.document.imported.as_ref().filter(|_| contestant == Contestant::Imported);
            if let Some(warning) = imported.and_then(import_warning) {
                ui.add(
                    Label::new(RichText::new(warning).color(tone_color(ui.visuals(), Tone::Caution))).wrap(),
                );
            }
            let facts = imported.map(import_facts).unwrap_or_default().into_iter();
            list(ui, true_error(model).chain(facts).chain(epipoles(&model.document, shown.fundamental)));
            if imported.is_some() {
                let remove = ExchangeCommand::RemoveImported.into();
                let button = ui.button("Remove it");
                finish_button(ui, button, remove, commands);
            }
            return;
        }
    }
    let VerdictInWords { tone, headline, facts, warnings } =
        verdict(&model.document, &model.open.computation);
    ui.horizontal_top(|ui| {
        let color = tone_color(ui.visuals(), tone);
        if tone == Tone::Busy {
            busy::show(ui);
        } else {
            let (dot, _) = ui.allocate_exact_size(vec2(14.0, 18.0), egui::Sense::hover());
            ui.painter().circle_filled(dot.center(), 5.0, color);
        }
        ui.add(Label::new(RichText::new(headline).strong()).wrap());
    });
    for warning in warnings {
        let color = tone_color(ui.visuals(), Tone::Caution);
        ui.add(Label::new(RichText::new(warning).color(color)).wrap());
    }
    if let Some(Some(next)) = model.open.next_click {
        let text = format!(
            "Add a pair at the mark in the left image: equally plausible geometries differ by up to {:.0} \
             px there.",
            next.disagreement
        );
        ui.add(Label::new(text).wrap());
    }
    list(ui, true_error(model).chain(facts));
}

/// Shows the verdict as a coloured light, with its headline as the tooltip.
pub fn light(ui: &mut Ui, model: &Model) {
    let VerdictInWords { tone, headline, .. } = verdict(&model.document, &model.open.computation);
    if tone == Tone::Busy {
        busy::show(ui);
    } else {
        let (dot, response) = ui.allocate_exact_size(vec2(18.0, 18.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 6.0, tone_color(ui.visuals(), tone));
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &headline));
        response.on_hover_text(headline);
    }
}

/// Returns the true error of the geometry shown, if ground truth is in use.
fn true_error(model: &Model) -> impl Iterator<Item = Fact> + use<> {
    let known = model.truth().zip(model.open.comparison.as_ref()).filter(|_| model.shown().is_some());
    let fact = known.and_then(|(_, comparison)| {
        let (error, least) = (comparison.true_error?, comparison.truth_error?);
        Some(Fact::new(
            "True error",
            format!("{error:.2} px (ground truth itself: {least:.2} px)"),
            "Mean symmetric epipolar distance of all true matches under the geometry shown. The value of \
             the ground truth itself shows how exact the matches are. No estimate can be much better.",
        ))
    });
    fact.into_iter()
}

/// Shows named figures.
fn list(ui: &mut Ui, facts: impl Iterator<Item = Fact>) {
    Grid::new("facts").num_columns(2).min_row_height(18.0).spacing([10.0, 3.0]).show(ui, |ui| {
        for fact in facts {
            let tooltip = fact.explained();
            ui.weak(fact.name).on_hover_text(&tooltip);
            ui.vertical(|ui| {
                // The row is as high as its text.
                ui.spacing_mut().interact_size.y = 0.0;
                ui.spacing_mut().item_spacing = vec2(6.0, 1.0);
                ui.horizontal_top(|ui| {
                    if let Some(tone) = fact.tone.filter(|_| fact.gauge.is_none()) {
                        let (dot, _) = ui.allocate_exact_size(vec2(8.0, 16.0), egui::Sense::hover());
                        ui.painter().circle_filled(dot.center(), 4.0, tone_color(ui.visuals(), tone));
                    }
                    ui.add(Label::new(fact.value).wrap()).on_hover_text(&tooltip);
                });
                if let Some(bar) = &fact.gauge {
                    gauge::show(ui, fact.name, bar).on_hover_text(tooltip);
                }
            });
            ui.end_row();
        }
    });
}

/// Shows that the window displays another geometry, with a button back to the result.
fn another_shown(ui: &mut Ui, name: &str, commands: &mut Vec<Command>) {
    let palette = theme::palette(ui.visuals());
    egui::Frame::new()
        .stroke(egui::Stroke::new(1.0, palette.accent))
        .corner_radius(6.0)
        .inner_margin(egui::Margin::symmetric(8, 6))
        .show(ui, |ui| {
            let text = format!("The images show {name}, not the result.");
            ui.add(Label::new(RichText::new(text).color(palette.accent)).wrap());
            command_button(ui, Command::ChooseHypothesis(None), true, commands);
        });
}
