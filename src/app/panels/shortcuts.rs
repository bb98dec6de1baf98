//! The list of keys and mouse actions.

use egui::{Align2, Grid, RichText, Window, vec2};

use crate::app::command::{Command, key_text};

/// What the mouse does in an image.
const MOUSE: [(&str, &str); 7] = [
    ("Click", "Place a point, first in one image, then its match in the other"),
    ("Drag a point", "Move it; the geometry follows"),
    ("Scroll, pinch", "Zoom about the cursor"),
    ("Drag beside the points", "Move the image; so do the middle button and Space"),
    ("Double click", "Show the whole image"),
    ("Arrow keys", "Move the selected point by 0.1 px"),
    ("Shift and arrow keys", "Move the selected point by 1 px"),
];

/// Shows the list; `open` becomes false when it is closed.
pub fn show(ctx: &egui::Context, open: &mut bool) {
    Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .show(ctx, |ui| {
            Grid::new("keys").num_columns(2).striped(true).spacing([24.0, 6.0]).show(ui, |ui| {
                for (action, what) in MOUSE {
                    ui.label(RichText::new(action).strong());
                    ui.label(what);
                    ui.end_row();
                }
                for command in Command::with_keys() {
                    ui.label(RichText::new(key_text(ui.ctx(), &command).unwrap_or_default()).strong());
                    ui.label(command.name()).on_hover_text(command.tooltip());
                    ui.end_row();
                }
            });
        });
}
