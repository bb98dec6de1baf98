//! The list of point pairs with their residuals.

use egui::{Button, Grid, Label, RichText, ScrollArea, Sense, Ui};

use super::super::dialog::named;
use super::super::{command_button, finish_button, pair_menu};
use super::{Tab, empty};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::document::{PointRef, Role, Side, pair_name};
use crate::app::model::focus::{LineSource, Target};
use crate::app::model::ids::TabId;
use crate::app::model::residuals::{Residuals, summary};
use crate::app::model::suggesting::Repair;
use crate::app::view::theme;
use crate::geometry::Point;

/// Registered in [`super::TABS`].
pub const TAB: Tab = Tab { id: TabId::Points, tools, show };

fn tools(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let any = !model.document.pairs.is_empty() || model.document.half.is_some();
    command_button(ui, Command::ClearPairs, any, commands);
}

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let document = &model.document;
    if document.pairs.is_empty() && document.half.is_none() {
        empty(
            ui,
            "The pairs you click appear here with their distances from the epipolar lines. Click a point in the left \
             image, then the same scene point in the right one.",
        );
        return;
    }
    let summary = summary(model);
    if !summary.is_empty() {
        ui.horizontal_wrapped(|ui| {
            for line in summary {
                ui.weak(line.name).on_hover_text(line.tooltip);
                ui.label(line.value).on_hover_text(line.tooltip);
                ui.add_space(theme::GAP);
            }
        });
    }
    ScrollArea::both().id_salt("points").auto_shrink([false, false]).show(ui, |ui| {
        Grid::new("points").num_columns(8).striped(true).min_row_height(22.0).spacing([7.0, 3.0]).show(
            ui,
            |ui| {
                for (title, tooltip) in [
                    ("Pair", "The name of the pair, in the order of the clicks."),
                    ("  Left x, y", "Position in the left image, px."),
                    ("  Right x, y", "Position in the right image, px."),
                    ("Role", "Whether the geometry is estimated from the pair or only checked by it."),
                    ("Symmetric", "Mean distance of the two points from each other's epipolar lines."),
                    ("Sampson", "How far the two points would have to move to fit the geometry exactly."),
                    ("", ""),
                ] {
                    let response = ui.weak(title);
                    if !tooltip.is_empty() {
                        response.on_hover_text(tooltip);
                    }
                }
                ui.end_row();
                for pair in 0..=document.pairs.len() {
                    if pair < document.pairs.len() || document.half.is_some() {
                        row(ui, model, pair, commands);
                    }
                }
            },
        );
    });
}

fn row(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let document = &model.document;
    let name = pair_name(pair);
    let lit = model.open.focus.hovered() == Some(Target::Pair(pair));
    let top_left = ui.cursor().min;
    ui.horizontal(|ui| {
        let (swatch, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), Sense::hover());
        ui.painter().circle_filled(swatch.center(), 5.0, theme::pair_color(pair));
        ui.painter().circle_stroke(swatch.center(), 5.5, egui::Stroke::new(1.0, theme::HALO));
        let text = RichText::new(&name).strong();
        ui.label(if lit { text.underline() } else { text });
    });
    for side in Side::BOTH {
        let at = PointRef { pair, side };
        if let Some(point) = document.point(at) {
            let text = RichText::new(position_text(point)).monospace();
            let selected = document.selection == Some(at);
            let response = ui.selectable_label(selected, text);
            finish_button(ui, response, Command::Select((!selected).then_some(at)), commands);
        } else {
            ui.weak("click it");
        }
    }
    let finished = document.pairs.get(pair);
    role(ui, model, pair, commands);
    let residuals = finished.zip(model.shown()).map(|(pair, shown)| Residuals::of(shown.fundamental, pair));
    for distance in residuals.map_or([f64::NAN; 2], |r| [r.symmetric, r.sampson]) {
        if distance.is_finite() {
            ui.label(RichText::new(format!("{distance:5.2} px")).monospace());
        } else {
            ui.add(Label::new(""));
        }
    }
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let mut offer = |ui: &mut Ui, command: Command, enabled: bool| {
            let label = format!("{}: pair {name}", command.name());
            let button = named(ui.add_enabled(enabled, Button::new(command.name()).small()), &label);
            finish_button(ui, button, command, commands);
        };
        if finished.is_some() {
            for how in [Repair::Refine, Repair::Rematch] {
                offer(ui, Command::Repair(pair, how), model.repair_question(pair, how).is_some());
            }
            offer(ui, Command::Pin(LineSource::Pair(pair)), model.shown().is_some());
        }
        offer(ui, Command::DeletePair(pair), true);
    });
    let bottom_right = egui::pos2(ui.clip_rect().max.x, top_left.y + 24.0);
    ui.end_row();
    let area = egui::Rect::from_min_max(top_left, bottom_right);
    let row = ui.interact(area, ui.scope_id().with(("row", pair)), Sense::hover());
    row.container_context_menu(|ui| pair_menu(ui, model, pair, commands));
    if finished.is_some() && ui.rect_contains_pointer(area) {
        commands.push(Command::PointAt(Target::Pair(pair)));
    }
}

/// What the pair is for, with the switches that change it, and whether the result speaks against it.
fn role(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let document = &model.document;
    if pair >= document.pairs.len() {
        ui.weak("half done");
        return;
    }
    let name = pair_name(pair);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let role = document.role(pair);
        let mut included = role != Role::Excluded;
        let response = ui.checkbox(&mut included, "");
        response.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::CheckBox, true, included, format!("Include pair {name}"))
        });
        let response = response.on_hover_text(Command::IncludePair(pair, included).tooltip());
        if response.changed() {
            commands.push(Command::IncludePair(pair, included));
        }
        for (only, is_chosen) in [(false, role == Role::Used), (true, role == Role::Check)] {
            let command = Command::CheckOnly(pair, only);
            let button = Button::selectable(is_chosen, command.name()).small();
            let response = ui.add_enabled(role != Role::Excluded && (only || document.can_be_used(pair)), button);
            let label = format!("{} pair {name}", command.name());
            response.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::Button, response.enabled(), is_chosen, &label)
            });
            let response = response.on_disabled_hover_text(if role == Role::Excluded {
                "The pair is left out: switch it on first."
            } else {
                "The published method takes no more pairs: let another one check only, or choose the preset Robust."
            });
            finish_button(ui, response, command, commands);
        }
        if let Some(distance) = model.outvoted(pair) {
            let text = RichText::new("outvoted").color(theme::palette(ui.visuals()).caution);
            ui.label(text).on_hover_text(format!(
                "{distance:.1} px off its epipolar line: the images speak against this pair. Check that it shows the same \
                 scene point in both images.",
            ));
        }
    });
}

fn position_text(point: Point) -> String {
    format!("{:6.2}, {:6.2}", point.x, point.y)
}
