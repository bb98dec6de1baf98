//! The bar at the top: opening, undo, what is shown, and help.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Align, Button, Layout, PopupCloseBehavior, Ui};

use super::{command_button, finish_button};
use crate::app::command::Command;
use crate::app::panes::overlays::OVERLAYS;
use crate::app::scene::Scene;

/// Shows the bar.
pub fn show(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let open = ui.button("Open");
        finish_button(ui, open, Command::ShowOpenDialog, commands);
        command_button(ui, Command::OpenSample, true, commands);
        ui.separator();
        command_button(ui, Command::Undo, scene.can_undo_redo[0], commands);
        command_button(ui, Command::Redo, scene.can_undo_redo[1], commands);
        ui.separator();
        command_button(ui, Command::FitAll, scene.document.pictures.is_some(), commands);
        let stays_open = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        let (menu, _) =
            MenuButton::new("Show").config(stays_open).ui(ui, |ui| overlay_menu(ui, scene, commands));
        menu.on_hover_text("Choose what is drawn over the images.");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let keys = ui.add(Button::new("Keys"));
            finish_button(ui, keys, Command::ToggleShortcuts, commands);
            let theme = ui.add(Button::new(if ui.visuals().dark_mode { "Light" } else { "Dark" }));
            finish_button(ui, theme, Command::ToggleTheme, commands);
        });
    });
}

/// The list of overlays, which is also their legend.
fn overlay_menu(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    for (number, (overlay, shown)) in OVERLAYS.iter().zip(scene.overlays).enumerate() {
        ui.horizontal(|ui| {
            let (swatch, _) = ui.allocate_exact_size(egui::vec2(14.0, 14.0), egui::Sense::hover());
            ui.painter().rect_filled(swatch, 3.0, overlay.color);
            let mut shown = *shown;
            if ui.checkbox(&mut shown, overlay.name).on_hover_text(overlay.tooltip).changed() {
                commands.push(Command::ToggleOverlay(number));
            }
        });
    }
}
