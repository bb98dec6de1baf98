//! The dialog for saving a session: a typed path, or the system dialog.

use std::path::{Path, PathBuf};

use egui::{Button, Key, TextEdit};

use super::dialog::{dialog, path_of};
use super::{command_button, finish_button};
use crate::app::model::command::Command;
use crate::app::model::command::SessionCommand;
use crate::app::model::session::has_session_extension;

/// Content of the dialog.
#[derive(Debug, Clone)]
pub struct SaveDialog {
    path: String,
    just_opened: bool,
}

impl SaveDialog {
    /// Creates the dialog with a suggested path.
    pub fn new(path: &Path) -> Self {
        Self { path: path.display().to_string(), just_opened: true }
    }

    /// Fills in a chosen path.
    pub fn offer(&mut self, path: &Path) {
        self.path = path.display().to_string();
    }

    /// Shows the dialog. Returns whether it stays open.
    pub fn show(&mut self, ctx: &egui::Context, commands: &mut Vec<Command>) -> bool {
        let open = dialog(ctx, "Save session", 520.0, |ui| {
            ui.weak(
                "Saves points, parameters, pinned lines and views in one JSON file. The images stay where \
                 they are.",
            );
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let label = ui.label("File");
                let edit = TextEdit::singleline(&mut self.path).hint_text("path of the session");
                let response = ui.add(edit.desired_width(400.0)).labelled_by(label.id);
                if self.just_opened {
                    response.request_focus();
                }
                let browse = ui.button("Browse");
                finish_button(ui, browse, SessionCommand::BrowseSave.into(), commands);
            });
            let path = path_of(&self.path).map(with_extension);
            let replaces = path.as_ref().is_some_and(|path| path.exists());
            ui.label(if replaces { "A file of that name exists and will be replaced." } else { "" });
            ui.add_space(6.0);
            let command = path.map(|path| SessionCommand::SaveTo(path).into());
            ui.horizontal(|ui| {
                let save = ui.add_enabled(command.is_some(), Button::new("Save"));
                let described = command.clone().unwrap_or(SessionCommand::Save.into());
                finish_button(ui, save, described, commands);
                command_button(ui, Command::Cancel, true, commands);
            });
            if ui.input(|input| input.key_pressed(Key::Enter)) {
                commands.extend(command);
            }
        });
        self.just_opened = false;
        open
    }
}

/// Appends the extension of sessions unless the path has it.
fn with_extension(path: PathBuf) -> PathBuf {
    if has_session_extension(&path) {
        return path;
    }
    let mut name = path.into_os_string();
    name.push(".json");
    name.into()
}
