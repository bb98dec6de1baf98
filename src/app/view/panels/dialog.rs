//! Parts shared by all dialogs.

use std::path::PathBuf;

use egui::{
    Align, Align2, Button, Context, Key, Layout, Rect, Response, Sense, TextEdit, Ui, UiBuilder, Window, vec2,
};

use super::{command_button, finish_button, main_button};
use crate::app::model::command::{Command, PickPurpose};

/// Width of the labels, screen points. Equal widths align the fields.
const LABEL_WIDTH: f32 = 84.0;

/// Height of a field and its button, screen points.
const HEIGHT: f32 = 26.0;
const BROWSE_WIDTH: f32 = 72.0;

/// Place of the top of a dialog, as a share of the height of the window. A dialog that grows, as with the reason of a
/// failure, keeps its fields where they are.
const TOP: f32 = 0.12;

/// Shows a dialog with content of the given width. Tab moves inside the dialog only. Returns
/// whether it stays open.
pub fn dialog(ctx: &Context, title: &str, width: f32, content: impl FnOnce(&mut Ui)) -> bool {
    let mut open = true;
    let shown = Window::new(title)
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_TOP, vec2(0.0, TOP * ctx.content_rect().height()))
        .show(ctx, |ui| {
            // Small windows have less room.
            ui.set_width(width.min(ctx.content_rect().width() - 56.0));
            content(ui);
        });
    if let Some(shown) = shown {
        ctx.memory_mut(|memory| memory.set_modal_layer(shown.response.layer_id));
    }
    open
}

/// A field for a path, with a button for the system dialog.
pub struct PathField<'a> {
    pub name: &'a str,
    /// Text shown while the field is empty.
    pub hint: &'a str,
    pub width: f32,
    /// Accessible name of the button.
    pub browse: &'a str,
    pub purpose: PickPurpose,
}

impl PathField<'_> {
    /// Shows the field and its button. Returns the field.
    pub fn show(self, ui: &mut Ui, text: &mut String, commands: &mut Vec<Command>) -> Response {
        let (field, place) = self.show_field(ui, text);
        self.show_browse(ui, place, commands);
        field
    }

    /// Shows the field and reserves room for its button. Showing all fields before their buttons
    /// lets Tab move from field to field.
    pub fn show_field(&self, ui: &mut Ui, text: &mut String) -> (Response, Rect) {
        let row = ui.horizontal(|ui| {
            let label = row_label(ui, self.name);
            let room = ui.available_width() - BROWSE_WIDTH - 3.0 * ui.spacing().item_spacing.x;
            let edit = TextEdit::singleline(text).hint_text(self.hint).desired_width(self.width.min(room));
            let field = ui.add(edit).labelled_by(label.id);
            (field, ui.allocate_exact_size(vec2(BROWSE_WIDTH, HEIGHT), Sense::hover()).0)
        });
        row.inner
    }

    /// Shows the button in the reserved room.
    pub fn show_browse(self, ui: &mut Ui, place: Rect, commands: &mut Vec<Command>) -> Response {
        let button = ui.place(place, Button::new("Browse").min_size(place.size()));
        finish_button(ui, named(button, self.browse), Command::Browse(self.purpose), commands)
    }
}

/// Shows the button that ends a dialog, as Enter does, and the one that cancels it. Without a command
/// the first is disabled, and `described` explains it.
pub fn ending(
    ui: &mut Ui,
    text: &str,
    command: Option<Command>,
    described: Command,
    commands: &mut Vec<Command>,
) {
    let button = ui.add_enabled_ui(command.is_some(), |ui| main_button(ui, text)).inner;
    finish_button(ui, button, command.clone().unwrap_or(described), commands);
    command_button(ui, Command::Cancel, true, commands);
    if ui.input(|input| input.key_pressed(Key::Enter)) {
        commands.extend(command);
    }
}

/// Writes the label of a row, aligned with the other rows.
pub fn row_label(ui: &mut Ui, name: &str) -> Response {
    let place = ui.allocate_exact_size(vec2(LABEL_WIDTH, HEIGHT), Sense::hover()).0;
    let left = Layout::left_to_right(Align::Center);
    // A scope would move the cursor back to the end of the text.
    ui.new_child(UiBuilder::new().max_rect(place).layout(left)).label(name)
}

/// Gives a button an accessible name longer than its text.
pub fn named(button: Response, name: &str) -> Response {
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, button.enabled(), name));
    button
}

/// Parses the typed text as a path.
pub fn path_of(text: &str) -> Option<PathBuf> {
    // Pasted paths often have quotes or are URLs.
    let text = text.trim().trim_matches(['"', '\'']);
    let text = text.strip_prefix("file://").unwrap_or(text);
    let home = || std::env::home_dir().filter(|home| !home.as_os_str().is_empty());
    let below_home = match text.strip_prefix('~') {
        Some("") => home(),
        Some(rest) => rest.strip_prefix(['/', std::path::MAIN_SEPARATOR]).zip(home()).map(|(r, h)| h.join(r)),
        None => None,
    };
    below_home.or_else(|| (!text.is_empty()).then(|| PathBuf::from(text)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pasted_paths_lose_their_quotes_and_a_tilde_is_the_home_folder() {
        let home = std::env::home_dir().unwrap();
        for (text, path) in [
            ("  \"/a b.png\" ", PathBuf::from("/a b.png")),
            ("file:///c.png", "/c.png".into()),
            ("~", home.clone()),
            ("~/a/b.png", home.join("a/b.png")),
            ("'~/b.png'", home.join("b.png")),
            ("~other/b.png", "~other/b.png".into()),
        ] {
            assert_eq!(path_of(text), Some(path), "{text}");
        }
        assert_eq!(path_of("  "), None);
    }
}
