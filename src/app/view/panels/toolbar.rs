//! The bar at the top: opening, undo, the tool, how it is looked at, and help.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Align, Button, Layout, PopupCloseBehavior, Ui};

use super::{command_button, finish_button};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::command::ExchangeCommand;
use crate::app::model::command::SessionCommand;
use crate::app::model::look::Tool;

/// Shows the bar.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let open = ui.button("Open");
        finish_button(ui, open, Command::ShowOpenDialog, commands);
        command_button(ui, Command::OpenSample, true, commands);
        let save = ui.add_enabled(model.document.pictures.is_some(), Button::new("Save"));
        finish_button(ui, save, SessionCommand::Save.into(), commands);
        let export = ExchangeCommand::ShowExport.into();
        command_button(ui, export, model.document.pictures.is_some(), commands);
        ui.separator();
        command_button(ui, Command::Undo, model.history.can_undo(), commands);
        command_button(ui, Command::Redo, model.history.can_redo(), commands);
        ui.separator();
        command_button(ui, Command::FitAll, model.document.pictures.is_some(), commands);
        let inspect = Button::selectable(model.tool == Tool::Inspect, Command::ToggleInspectTool.name());
        let inspect = ui.add_enabled(model.document.pictures.is_some(), inspect.frame_when_inactive(true));
        finish_button(ui, inspect, Command::ToggleInspectTool, commands);
        let stays_open = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        let (menu, _) =
            MenuButton::new("View").config(stays_open).ui(ui, |ui| view_menu(ui, model, commands));
        menu.on_hover_text("Choose how the images are shown.");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let keys = ui.add(Button::new("Keys"));
            finish_button(ui, keys, Command::ToggleShortcuts, commands);
            let palette = ui.add(Button::new(Command::TogglePalette.name()));
            finish_button(ui, palette, Command::TogglePalette, commands);
            let theme = ui.add(Button::new(if ui.visuals().dark_mode { "Light" } else { "Dark" }));
            finish_button(ui, theme, Command::ToggleTheme, commands);
        });
    });
}

/// How the images are shown.
fn view_menu(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let look = &model.look;
    let choices = [
        (Command::ToggleLink, look.linked),
        (Command::ToggleMap, look.map),
        (Command::ToggleLoupe, look.loupe),
    ];
    for (command, mut on) in choices {
        let choice = ui.checkbox(&mut on, command.name());
        finish_button(ui, choice, command, commands);
    }
}
