//! The list of point pairs with their residuals.

use egui::{Grid, Label, RichText, ScrollArea, Sense, Ui};

use super::{Section, command_button, finish_button};
use crate::app::command::Command;
use crate::app::document::{PointRef, Role, Side, pair_name};
use crate::app::scene::Scene;
use crate::app::theme;
use crate::geometry::{Point, symmetric_epipolar_distance};

/// Registered in [`super::SECTIONS`].
pub const SECTION: Section = Section { title: "Point pairs", share: 0.5, tools, show };

fn tools(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let any = !scene.document.pairs.is_empty() || scene.document.half.is_some();
    command_button(ui, Command::ClearPairs, any, commands);
}

fn show(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let document = scene.document;
    if document.pairs.is_empty() && document.half.is_none() {
        ui.weak("The pairs you click appear here with their distances from the epipolar lines.");
        return;
    }
    ScrollArea::both().id_salt("points").auto_shrink([false, false]).show(ui, |ui| {
        Grid::new("points").num_columns(6).striped(true).min_row_height(22.0).spacing([10.0, 3.0]).show(
            ui,
            |ui| {
                for title in ["Pair", "   Left x, y", "   Right x, y", "Use", "  Residual", ""] {
                    ui.weak(title);
                }
                ui.end_row();
                for pair in 0..=document.pairs.len() {
                    if pair < document.pairs.len() || document.half.is_some() {
                        row(ui, scene, pair, commands);
                    }
                }
            },
        );
    });
}

fn row(ui: &mut Ui, scene: &Scene, pair: usize, commands: &mut Vec<Command>) {
    let document = scene.document;
    let name = pair_name(pair);
    ui.horizontal(|ui| {
        let (swatch, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), Sense::hover());
        ui.painter().circle_filled(swatch.center(), 5.0, theme::pair_color(pair));
        ui.painter().circle_stroke(swatch.center(), 5.5, egui::Stroke::new(1.0, theme::HALO));
        ui.strong(&name);
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
    match (finished, document.role(pair)) {
        (None, _) => ui.weak("half done"),
        (Some(_), Role::Used) => ui.label("estimate").on_hover_text("The geometry is estimated from it."),
        (Some(_), Role::Check) => {
            ui.label("check").on_hover_text("It only shows how well the geometry fits elsewhere.")
        }
    };
    let residual =
        finished.zip(scene.shown()).map(|(pair, shown)| symmetric_epipolar_distance(shown.fundamental, pair));
    match residual {
        Some(distance) if distance.is_finite() => ui
            .label(RichText::new(format!("{distance:6.2} px")).monospace())
            .on_hover_text("Mean distance of the two points from each other's epipolar lines."),
        _ => ui.add(Label::new("")),
    };
    let delete = ui.small_button("Delete").on_hover_text(Command::DeletePair(pair).tooltip());
    delete.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Delete pair {name}")));
    if delete.clicked() {
        commands.push(Command::DeletePair(pair));
    }
    ui.end_row();
}

fn position_text(point: Point) -> String {
    format!("{:7.2}, {:7.2}", point.x, point.y)
}
