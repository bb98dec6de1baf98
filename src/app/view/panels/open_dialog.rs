//! The window for opening files: typed paths, the system's dialog, or files dropped on it.

use std::path::{Path, PathBuf};

use egui::{Button, Key};

use super::dialog::{PathField, dialog, path_of};
use super::{command_button, finish_button};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::command::ExchangeCommand;
use crate::app::model::document::Side;

/// What has been typed.
#[derive(Debug, Clone, Default)]
pub struct OpenDialog {
    /// Whether it is shown.
    pub open: bool,
    paths: [String; 2],
    folder: String,
    import: String,
    just_opened: bool,
}

impl OpenDialog {
    /// Shows it, empty.
    pub fn show_empty(&mut self) {
        *self = Self { open: true, just_opened: true, ..Self::default() };
    }

    /// Fills in a path: the given side, or the first field that is free, or the right one. Shows the
    /// window. Returns both paths when there are two now.
    pub fn offer(&mut self, path: &Path, side: Option<Side>) -> Option<[PathBuf; 2]> {
        if !self.open {
            self.show_empty();
        }
        let free = if self.paths[0].trim().is_empty() { Side::Left } else { Side::Right };
        self.paths[side.unwrap_or(free).index()] = path.display().to_string();
        match self.typed() {
            [Some(left), Some(right)] => Some([left, right]),
            _ => None,
        }
    }

    /// Fills in a folder, and shows the window.
    pub fn offer_folder(&mut self, path: &Path) {
        if !self.open {
            self.show_empty();
        }
        self.folder = path.display().to_string();
    }

    /// Fills in a file to import, and shows the window.
    pub fn offer_import(&mut self, path: &Path) {
        if !self.open {
            self.show_empty();
        }
        self.import = path.display().to_string();
    }

    fn typed(&self) -> [Option<PathBuf>; 2] {
        self.paths.each_ref().map(|text| path_of(text))
    }

    /// What pressing Enter or the button does, if enough has been typed: what is imported is about what is opened.
    fn commands(&self, model: &Model) -> Vec<Command> {
        let import = path_of(&self.import);
        let import = import.map(|path| ExchangeCommand::Import(vec![path]).into());
        self.opening(model).into_iter().chain(import).collect()
    }

    /// What is opened.
    fn opening(&self, model: &Model) -> Option<Command> {
        if let Some(folder) = path_of(&self.folder) {
            return Some(Command::OpenFolder(folder));
        }
        let typed = self.typed();
        let enough = match &model.document.pictures {
            Some(_) => typed.iter().any(Option::is_some),
            None => typed.iter().all(Option::is_some),
        };
        enough.then_some(Command::OpenFiles(typed))
    }

    /// Shows the window.
    pub fn show(&mut self, ctx: &egui::Context, model: &Model, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        let open = dialog(ctx, "Open images", 520.0, |ui| {
            ui.weak("Type or paste the paths of two images or of a session, browse for the files, or drop them on the window.");
            ui.add_space(6.0);
            for (side, name) in Side::BOTH.into_iter().zip(["Left image", "Right image"]) {
                let present = model.document.pictures.as_ref().map(|pictures| &pictures[side.index()].name);
                let hint = present.map_or("path of the image".to_owned(), |name| format!("keep {name}"));
                let browse = format!("Browse for the {} image", side.name());
                let field = field(name, &hint, &browse, Command::Browse(side));
                let field = field.show(ui, &mut self.paths[side.index()], commands);
                if self.just_opened && side == Side::Left {
                    field.request_focus();
                }
            }
            ui.add_space(6.0);
            ui.weak(
                    "Or a folder whose geometry is known: in the VGG layout, or pairs NAMEA.*, NAMEB.* with NAME.txt.",
                );
            ui.add_space(2.0);
            field("Folder", "path of the folder", "Browse for the folder", Command::BrowseFolder).show(
                ui,
                &mut self.folder,
                commands,
            );
            ui.add_space(6.0);
            ui.weak(
                    "For the images, if you have them: point pairs, a fundamental matrix or two cameras, in any of the known formats.",
                );
            ui.add_space(2.0);
            let hint = "path of the file, for the images above or those that are open";
            let browse = ExchangeCommand::BrowseImport.into();
            field("Import", hint, "Browse for a file to import", browse).show(ui, &mut self.import, commands);
            ui.add_space(6.0);
            let typed = self.commands(model);
            ui.horizontal(|ui| {
                let open = ui.add_enabled(!typed.is_empty(), Button::new("Open these"));
                let described = typed.first().cloned().unwrap_or(Command::OpenFiles([None, None]));
                if finish_button(ui, open, described, commands).clicked() {
                    commands.extend(typed.iter().skip(1).cloned());
                }
                command_button(ui, Command::Cancel, true, commands);
            });
            if ui.input(|input| input.key_pressed(Key::Enter)) {
                commands.extend(typed);
            }
        });
        self.just_opened = false;
        if !open {
            self.open = false;
        }
    }
}

fn field<'a>(name: &'a str, hint: &'a str, browse: &'a str, command: Command) -> PathField<'a> {
    PathField { name, hint, width: 330.0, browse, command }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_files_fill_left_then_right() {
        let mut dialog = OpenDialog::default();
        assert_eq!(dialog.offer(Path::new("a.png"), None), None);
        assert!(dialog.open);
        let both = dialog.offer(Path::new("b.png"), None);
        assert_eq!(both, Some(["a.png".into(), "b.png".into()]));
    }

    #[test]
    fn pasted_paths_lose_their_quotes() {
        let dialog =
            OpenDialog { paths: ["  \"/a b.png\" ".into(), "file:///c.png".into()], ..OpenDialog::default() };
        assert_eq!(dialog.typed(), [Some("/a b.png".into()), Some("/c.png".into())]);
    }
}
