//! The list of keys and mouse actions.

use egui::{Align2, Grid, Label, RichText, ScrollArea, Window, vec2};

use crate::app::view::actions::ACTIONS;
use crate::app::view::keyboard::key_text;

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
            // A narrow window wraps what the keys do.
            let width = (ctx.content_rect().width() - 80.0).clamp(200.0, 760.0);
            let room = (ctx.content_rect().height() - 140.0).max(120.0);
            ScrollArea::vertical().max_height(room).min_scrolled_height(room).show(ui, |ui| {
                Grid::new("keys")
                    .num_columns(2)
                    .striped(true)
                    .max_col_width(width - 170.0)
                    .min_row_height(20.0)
                    .spacing([24.0, 4.0])
                    .show(ui, |ui| {
                        for (action, what) in MOUSE {
                            ui.label(RichText::new(action).strong());
                            ui.add(Label::new(what).wrap());
                            ui.end_row();
                        }
                        for action in ACTIONS.iter().filter(|action| !action.keys.is_empty()) {
                            ui.label(
                                RichText::new(key_text(ui.ctx(), &action.command).unwrap_or_default())
                                    .strong(),
                            );
                            let first_sentence = action.tooltip.split('.').next().unwrap_or_default();
                            ui.add(Label::new(first_sentence).wrap());
                            ui.end_row();
                        }
                    });
            });
        });
}
