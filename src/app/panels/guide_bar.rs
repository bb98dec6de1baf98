//! The sentence that says what to do next, and the button that does it; beside it the pairs of the folder that is
//! open.

use egui::{Align, Button, Layout, RichText, Ui};

use super::{busy, finish_button, pair_chooser};
use crate::app::command::Command;
use crate::app::guide::guide;
use crate::app::scene::Scene;
use crate::app::theme;

/// Shows the bar.
pub fn show(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some((folder, pair)) = scene.folder() {
                pair_chooser::show(ui, scene, folder, pair, commands);
                ui.separator();
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| sentence(ui, scene, commands));
        });
    });
}

fn sentence(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let Scene { document, loading, has_sample_points, .. } = *scene;
    if has_sample_points && document.pairs.is_empty() && document.half.is_none() {
        let palette = theme::palette(ui.visuals());
        let text = RichText::new(Command::ShowMe.name()).color(palette.on_accent);
        let button = ui.add(Button::new(text).fill(palette.accent));
        finish_button(ui, button, Command::ShowMe, commands);
    }
    if loading {
        busy::show(ui);
    }
    let text = guide(scene);
    ui.add(egui::Label::new(RichText::new(text).strong()).truncate());
}
