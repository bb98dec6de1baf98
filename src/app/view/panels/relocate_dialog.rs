//! The dialog for images of a session that are missing or have changed.

use std::path::Path;

use egui::{Button, Key, Label, TextEdit};

use super::dialog::{dialog, named, path_of};
use super::{command_button, finish_button};
use crate::app::model::command::PickPurpose;
use crate::app::model::session::{Lost, OpenSession, Relocation, SessionOwner};
use crate::app::model::{Command, SessionCommand, Side};

/// The missing images and the typed paths.
#[derive(Debug, Clone)]
pub struct RelocateDialog {
    relocation: Relocation,
    paths: [String; 2],
}

impl RelocateDialog {
    pub fn new(relocation: Relocation) -> Self {
        Self { relocation, paths: [String::new(), String::new()] }
    }

    pub fn offer(&mut self, side: Side, path: &Path) {
        self.paths[side.index()] = path.display().to_string();
    }

    /// Fills in the path of a dropped file for the first missing image without a path.
    pub fn offer_dropped(&mut self, path: &Path) {
        let wanting = Side::BOTH
            .into_iter()
            .find(|side| self.relocation.lost[side.index()].is_some() && self.paths[side.index()].is_empty());
        if let Some(side) = wanting {
            self.offer(side, path);
        }
    }

    /// Returns the command that opens the session with the typed images. Only the user can accept
    /// changed images.
    fn again(&self, accepts_changed: bool) -> Command {
        let mut session: OpenSession = self.relocation.session.clone();
        for (given, typed) in session.images.iter_mut().zip(&self.paths) {
            if let Some(path) = path_of(typed) {
                *given = Some(path);
            }
        }
        session.accepts_changed = accepts_changed;
        SessionCommand::Open(session).into()
    }

    /// Shows the dialog. Returns whether it stays open.
    pub fn show(&mut self, ctx: &egui::Context, commands: &mut Vec<Command>) -> bool {
        dialog(ctx, "Find the images", 560.0, |ui| {
            let session = &self.relocation.session;
            let what = if session.owner == SessionOwner::Autosave {
                "The unsaved work".to_owned()
            } else {
                format!("The session {}", session.path.display())
            };
            ui.add(Label::new(format!("{what} needs images that are missing or have changed.")).wrap());
            let mut all_there = true;
            for side in Side::BOTH {
                let Some(lost) = &self.relocation.lost[side.index()] else { continue };
                ui.add_space(8.0);
                let text = match lost {
                    Lost::Missing(path) => {
                        format!("The {} image was not found: {}", side.name(), path.display())
                    }
                    Lost::Changed(path) => format!(
                        "The {} image has changed since the session was saved, or is a different image: {}",
                        side.name(),
                        path.display()
                    ),
                };
                ui.add(Label::new(text).wrap());
                let typed = &mut self.paths[side.index()];
                let missing = matches!(lost, Lost::Missing(_));
                ui.horizontal(|ui| {
                    let label = ui.label(format!("New {} image", side.name()));
                    let hint =
                        if missing { "its present path" } else { "path of the original, if there is one" };
                    let edit = TextEdit::singleline(typed).hint_text(hint).desired_width(340.0);
                    ui.add(edit).labelled_by(label.id);
                    let label = format!("Browse for the {} image", side.name());
                    let browse = named(ui.button("Browse"), &label);
                    finish_button(ui, browse, Command::Browse(PickPurpose::Lost(side)), commands);
                });
                all_there &= !missing || path_of(typed).is_some();
            }
            ui.add_space(8.0);
            let changed = self.relocation.lost.iter().flatten().any(|l| matches!(l, Lost::Changed(_)));
            ui.horizontal(|ui| {
                let open = ui.add_enabled(all_there, Button::new("Open with these"));
                finish_button(ui, open, self.again(false), commands);
                if changed {
                    let anyway = ui.add_enabled(all_there, Button::new("Use changed images as they are"));
                    let hint = "The points of the session are kept. Check that they still fit.";
                    if anyway.on_hover_text(hint).clicked() {
                        commands.push(self.again(true));
                    }
                }
                command_button(ui, Command::Cancel, true, commands);
            });
            if all_there && ui.input(|input| input.key_pressed(Key::Enter)) {
                commands.push(self.again(false));
            }
        })
    }
}
