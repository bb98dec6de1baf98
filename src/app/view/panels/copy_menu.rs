//! The menu that copies F as source code.

use egui::Ui;

use super::command_button;
use crate::app::model::Model;
use crate::app::model::command::{Command, ExchangeCommand};
use crate::io::Notation;

/// Shows the menu "Copy F as", with one entry per notation.
pub fn copy_fundamental_menu(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.add_enabled_ui(model.shown().is_some(), |ui| {
        ui.menu_button("Copy F as", |ui| {
            for notation in Notation::ALL {
                if command_button(ui, ExchangeCommand::CopyFundamental(notation).into(), true, commands)
                    .clicked()
                {
                    ui.close();
                }
            }
        });
    });
}
