//! The dialog for opening files: typed paths, the system dialog, or dropped files.

use std::path::{Path, PathBuf};

use egui::{Button, Key, Label, Response, RichText, ScrollArea, Ui};

use super::dialog::{PathField, dialog, path_of};
use super::{busy, command_button, finish_button};
use crate::app::model::command::PickPurpose;
use crate::app::model::recents::recent_name;
use crate::app::model::{Command, ExchangeCommand, Model, Side};
use crate::app::view::theme;
use crate::io::is_importable;

/// Height below the part that scrolls, for the buttons and for the reason of a failure, screen points.
const FOOT: [f32; 2] = [76.0, 64.0];

/// Number of the field of a file to import, from the top.
const IMPORT: usize = 3;

#[derive(Debug, Clone, Default)]
pub struct OpenDialog {
    pub open: bool,
    paths: [String; 2],
    folder: String,
    import: String,
    /// Reason why the last attempt opened nothing.
    problem: Option<String>,
    /// Number of the field that was typed in last, from the top.
    last: usize,
    just_opened: bool,
}

impl OpenDialog {
    /// Opens the dialog with empty fields.
    pub fn show_empty(&mut self) {
        *self = Self { open: true, just_opened: true, ..Self::default() };
    }

    /// Opens the dialog with empty fields, for a file to import.
    pub fn show_import(&mut self) {
        self.show_empty();
        self.last = IMPORT;
    }

    /// Opens the dialog with empty fields, unless it is open.
    fn opened(&mut self) -> &mut Self {
        if !self.open {
            self.show_empty();
        }
        self
    }

    /// Fills in the path of an image and opens the dialog. Without a side, fills the left field, or
    /// the right one if the left is taken. Returns both paths once there are two.
    pub fn offer(&mut self, path: &Path, side: Option<Side>) -> Option<[PathBuf; 2]> {
        self.opened();
        let free = if self.paths[0].trim().is_empty() { Side::Left } else { Side::Right };
        self.paths[side.unwrap_or(free).index()] = path.display().to_string();
        match self.typed() {
            [Some(left), Some(right)] => Some([left, right]),
            _ => None,
        }
    }

    /// Fills in a folder and opens the dialog.
    pub fn offer_folder(&mut self, path: &Path) {
        self.opened().folder = path.display().to_string();
    }

    /// Fills in a file to import and opens the dialog.
    pub fn offer_import(&mut self, path: &Path) {
        self.opened().import = path.display().to_string();
    }

    /// Shows why nothing was opened, and keeps the fields.
    pub fn refuse(&mut self, problem: String) {
        self.problem = Some(problem);
        self.just_opened = true;
    }

    /// Returns the side without a path, if the other one has a path.
    pub fn missing(&self) -> Option<Side> {
        match self.typed() {
            [Some(_), None] => Some(Side::Right),
            [None, Some(_)] => Some(Side::Left),
            _ => None,
        }
    }

    /// Returns the only path, if exactly one is filled in.
    pub fn waiting(&self) -> Option<PathBuf> {
        match self.typed() {
            [Some(one), None] | [None, Some(one)] => Some(one),
            _ => None,
        }
    }

    fn typed(&self) -> [Option<PathBuf>; 2] {
        self.paths.each_ref().map(|text| path_of(text))
    }

    /// Returns the commands of the Open button. The import follows, as it refers to the opened
    /// images.
    fn commands(&self) -> Vec<Command> {
        let import = path_of(&self.import);
        let import = import.map(|path| ExchangeCommand::Import(vec![path]).into());
        self.opening().into_iter().chain(import).collect()
    }

    fn opening(&self) -> Option<Command> {
        if let Some(folder) = path_of(&self.folder) {
            return Some(Command::OpenFolder(folder));
        }
        let typed: Vec<PathBuf> = self.typed().into_iter().flatten().collect();
        (!typed.is_empty()).then_some(Command::OpenFiles(typed))
    }

    /// Returns whether the paths can be opened. One path alone may be a folder, a session or a file to
    /// import, but no image. Enter tells what is missing.
    fn is_enough(&self) -> bool {
        let lone = self.waiting().filter(|_| path_of(&self.folder).is_none());
        lone.is_none_or(|one| is_importable(&one) || one.is_dir())
    }

    /// Notes a field with the focus. The field that was typed in last gets the focus again after a failure.
    fn keep_focus(&mut self, number: usize, field: &Response) {
        if field.has_focus() {
            self.last = number;
        }
        if self.just_opened && self.last == number {
            field.request_focus();
        }
    }

    pub fn show(&mut self, ctx: &egui::Context, model: &Model, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        let open = dialog(ctx, "Open images", 520.0, |ui| {
            let mut elsewhere = false;
            let foot = FOOT[0] + if self.problem.is_some() { FOOT[1] } else { 0.0 };
            let room = ctx.content_rect().bottom() - ui.cursor().top() - foot;
            let mut area = ScrollArea::vertical().max_height(room.max(foot));
            if self.just_opened && self.last != IMPORT {
                area = area.vertical_scroll_offset(0.0);
            }
            area.show(ui, |ui| {
                ui.weak(
                    "Enter the paths of two images, two sequences (folders of frames or videos) or a session. \
                     You can also browse for the files or drop them on the window.",
                );
                ui.add_space(6.0);
                let rows = [
                    ("Left image", "Browse for the left image", Side::Left),
                    ("Right image", "Browse for the right image", Side::Right),
                ];
                let rows = rows.map(|(name, browse, side)| {
                    let row = row_of(name, "path of the image", browse, PickPurpose::Image(side));
                    let (field, place) = row.show_field(ui, &mut self.paths[side.index()]);
                    self.keep_focus(side.index(), &field);
                    (row, place)
                });
                for (row, place) in rows {
                    elsewhere |= row.show_browse(ui, place, commands).has_focus();
                }
                ui.add_space(6.0);
                ui.weak(
                    "Or open a folder of images and choose any two. If the folder has ground truth (VGG layout, \
                     or pairs NAMEA.*, NAMEB.* with NAME.txt or NAME_F.txt), results can be compared with it.",
                );
                ui.add_space(2.0);
                let row = row_of("Folder", "path of the folder", "Browse for the folder", PickPurpose::Folder);
                let (field, place) = row.show_field(ui, &mut self.folder);
                self.keep_focus(2, &field);
                elsewhere |= row.show_browse(ui, place, commands).has_focus();
                ui.add_space(6.0);
                ui.weak(
                    "Optional: point pairs, a fundamental matrix, two cameras or a calibration for the images above \
                     or the open ones (text, CSV, JSON or YAML).",
                );
                ui.add_space(2.0);
                let browse = "Browse for a file to import";
                let row = row_of("Import", "path of the file", browse, PickPurpose::Import);
                let (field, place) = row.show_field(ui, &mut self.import);
                self.keep_focus(IMPORT, &field);
                elsewhere |= row.show_browse(ui, place, commands).has_focus();
                ui.add_space(6.0);
                elsewhere |= recents(ui, model, commands);
                elsewhere |= unsaved_work(ui, model, commands);
            });
            if let Some(problem) = &self.problem {
                let color = theme::palette(ui.visuals()).bad;
                ui.add(Label::new(RichText::new(problem).color(color)).wrap());
                ui.add_space(6.0);
            }
            let typed = if model.activity.loading { Vec::new() } else { self.commands() };
            let mut begun = false;
            ui.horizontal(|ui| {
                let open = ui.add_enabled(!typed.is_empty() && self.is_enough(), Button::new("Open these"));
                let described = typed.first().cloned().unwrap_or(Command::OpenFiles(Vec::new()));
                let open = finish_button(ui, open, described, commands);
                if open.clicked() {
                    commands.extend(typed.iter().skip(1).cloned());
                    begun = true;
                }
                elsewhere |= open.has_focus();
                elsewhere |= command_button(ui, Command::Cancel, true, commands).has_focus();
                if model.activity.loading {
                    busy::show(ui);
                    ui.weak("Opening");
                }
            });
            // Enter on a focused button presses that button.
            if !elsewhere && ui.input(|input| input.key_pressed(Key::Enter)) && !typed.is_empty() {
                commands.extend(typed);
                begun = true;
            }
            if begun {
                self.problem = None;
            }
        });
        self.just_opened = false;
        self.open &= open;
    }
}

/// Lists all unsaved work. Returns whether one of its buttons has the keyboard focus.
fn unsaved_work(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> bool {
    let mut focused = false;
    if model.left_behind.is_empty() {
        return focused;
    }
    ui.weak("Unsaved work");
    for copy in &model.left_behind {
        ui.horizontal_top(|ui| {
            for action in copy.actions() {
                let button = ui.add(Button::new(action.label).small());
                focused |= finish_button(ui, button, action.command, commands).has_focus();
            }
            ui.add(Label::new(copy.told()).wrap());
        });
    }
    ui.add_space(6.0);
    focused
}

/// Shows the recently opened files. Returns whether one of their buttons has the keyboard focus.
fn recents(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> bool {
    let mut focused = false;
    if model.recents.list().next().is_none() {
        return focused;
    }
    ui.weak("Recent");
    for paths in model.recents.list() {
        let entry =
            ui.add_enabled(!model.activity.loading, Button::new(recent_name(paths)).small().truncate());
        focused |= entry.has_focus();
        let whole: Vec<_> = paths.iter().map(|path| path.display().to_string()).collect();
        if entry.on_hover_text(whole.join("\n")).clicked() {
            commands.push(Command::OpenFiles(paths.to_vec()));
        }
    }
    ui.add_space(6.0);
    focused
}

fn row_of<'a>(name: &'a str, hint: &'a str, browse: &'a str, purpose: PickPurpose) -> PathField<'a> {
    PathField { name, hint, width: 330.0, browse, purpose }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_image_is_not_enough_and_one_session_or_folder_is() {
        let folder = tempfile::tempdir().unwrap();
        for (path, opens) in [(Path::new("a.png"), false), (Path::new("a.json"), true), (folder.path(), true)]
        {
            let mut dialog = OpenDialog::default();
            dialog.offer(path, None);
            assert_eq!(dialog.is_enough(), opens, "{path:?}");
        }
    }
}
