//! The bar with the next step: its sentence and button, and the pairs of the open folder.

use egui::{Align, Button, Layout, RichText, Ui};

use super::{busy, finish_button, pair_chooser};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::guide::guide;
use crate::app::view::theme;

/// Shows the bar.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some((folder, pair)) = model.folder() {
                pair_chooser::show(ui, model, folder, pair, commands);
                ui.separator();
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| sentence(ui, model, commands));
        });
    });
}

fn sentence(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let document = &model.document;
    if model.open.show_me.is_some() && document.pairs.is_empty() && document.half.is_none() {
        let palette = theme::palette(ui.visuals());
        let text = RichText::new(Command::ShowMe.name()).color(palette.on_accent);
        let button = ui.add(Button::new(text).fill(palette.accent));
        finish_button(ui, button, Command::ShowMe, commands);
    }
    if model.can_find_without_clicks() && document.half.is_none() {
        let button = ui.button(Command::FindWithoutClicks.name());
        finish_button(ui, button, Command::FindWithoutClicks, commands);
    }
    if model.can_keep_matches() {
        let button = ui.button(Command::KeepMatches.name());
        finish_button(ui, button, Command::KeepMatches, commands);
    }
    if model.activity.loading {
        busy::show(ui);
    }
    let text = guide(model);
    ui.add(egui::Label::new(RichText::new(text).strong()).truncate());
}
