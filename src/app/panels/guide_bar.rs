//! The sentence that says what to do next, and the button that does it.

use egui::{Button, RichText, Ui};

use super::{busy, finish_button};
use crate::app::command::Command;
use crate::app::guide::guide;
use crate::app::scene::Scene;
use crate::app::theme;

/// Shows the bar.
pub fn show(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let Scene { document, loading, has_sample_points, .. } = *scene;
    let palette = theme::palette(ui.visuals());
    ui.horizontal(|ui| {
        if has_sample_points && document.pairs.is_empty() && document.half.is_none() {
            let text = RichText::new(Command::ShowMe.name()).color(palette.on_accent);
            let button = ui.add(Button::new(text).fill(palette.accent));
            finish_button(ui, button, Command::ShowMe, commands);
        }
        if loading {
            busy::show(ui);
        }
        let text = guide(scene);
        ui.add(egui::Label::new(RichText::new(text).strong()).truncate());
    });
}
