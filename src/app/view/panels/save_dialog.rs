//! The dialog for saving a session: a typed path, or the system dialog.

use std::path::{Path, PathBuf};

use super::dialog::{PathField, dialog, ending, path_of};
use crate::app::model::command::{Command, PickPurpose, SessionCommand};
use crate::app::model::session::has_session_extension;

#[derive(Debug, Clone)]
pub struct SaveDialog {
    path: String,
    just_opened: bool,
}

impl SaveDialog {
    pub fn new(path: &Path) -> Self {
        Self { path: path.display().to_string(), just_opened: true }
    }

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
            let file = PathField {
                name: "File",
                hint: "path of the session",
                width: 330.0,
                browse: "Browse for the session file",
                purpose: PickPurpose::Session(path_of(&self.path).unwrap_or_default()),
            };
            let file = file.show(ui, &mut self.path, commands);
            if self.just_opened {
                file.request_focus();
            }
            let path = path_of(&self.path).map(with_extension);
            let replaces = path.as_ref().is_some_and(|path| path.exists());
            ui.label(if replaces { "A file of that name exists and will be replaced." } else { "" });
            ui.add_space(6.0);
            let command = path.map(|path| SessionCommand::SaveTo(path).into());
            ui.horizontal(|ui| ending(ui, "Save", command, SessionCommand::Save.into(), commands));
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
