//! What the windows in front of the window have in common.

use std::path::PathBuf;

use egui::{Align2, Context, Label, Response, TextEdit, Ui, Window, vec2};

use super::finish_button;
use crate::app::model::command::Command;

/// Width of the names of fields, screen points: all alike, so that the fields line up.
pub const LABEL_WIDTH: f32 = 84.0;

/// A window in the middle, with its content as wide as this; whether it stays open.
pub fn dialog(ctx: &Context, title: &str, width: f32, content: impl FnOnce(&mut Ui)) -> bool {
    let mut open = true;
    Window::new(title)
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, -40.0))
        .show(ctx, |ui| {
            ui.set_width(width);
            content(ui);
        });
    open
}

/// A field for a path, with a button for the system's dialog.
pub struct PathField<'a> {
    /// What it is called.
    pub name: &'a str,
    /// What stands in it while it is empty.
    pub hint: &'a str,
    /// Its width, screen points.
    pub width: f32,
    /// What the button says to those who cannot see where it is.
    pub browse: &'a str,
    /// What the button does.
    pub command: Command,
}

impl PathField<'_> {
    /// Shows it; returns the field.
    pub fn show(self, ui: &mut Ui, text: &mut String, commands: &mut Vec<Command>) -> Response {
        let row = ui.horizontal(|ui| {
            let label = ui.add_sized([LABEL_WIDTH, 26.0], Label::new(self.name));
            let edit = TextEdit::singleline(text).hint_text(self.hint).desired_width(self.width);
            let field = ui.add(edit).labelled_by(label.id);
            let browse = named(ui.button("Browse"), self.browse);
            finish_button(ui, browse, self.command, commands);
            field
        });
        row.inner
    }
}

/// The button under a name that says more than what stands on it.
pub fn named(button: Response, name: &str) -> Response {
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, button.enabled(), name));
    button
}

/// What was typed, as a path.
pub fn path_of(text: &str) -> Option<PathBuf> {
    // Paths are often pasted with quotes or as an address.
    let text = text.trim().trim_matches(['"', '\'']);
    let text = text.strip_prefix("file://").unwrap_or(text);
    (!text.is_empty()).then(|| PathBuf::from(text))
}
