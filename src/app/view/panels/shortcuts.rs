//! The list of keys and mouse actions.

use egui::gui_zoom::kb_shortcuts;
use egui::{Align2, Grid, KeyboardShortcut, Label, RichText, ScrollArea, TextStyle, Ui, Window, vec2};

use crate::app::view::actions::{ACTIONS, GROUPS};
use crate::app::view::keyboard::key_text;

/// Mouse actions in an image.
const MOUSE: [(&str, &str); 8] = [
    ("Click", "Place a point in one image, then its match in the other"),
    ("Drag a point", "Move the point; the geometry follows"),
    ("Scroll, pinch", "Zoom about the cursor"),
    ("Drag elsewhere", "Move the image; the middle button and Space do the same"),
    ("Right click", "Open the menu of a point, a pinned line, or a place"),
    ("Double click", "Show the whole image"),
    ("Arrow keys", "Move the crosshair or the selected point by 1 px"),
    ("Shift or Alt and arrow keys", "Move it by 10 px or by 0.1 px"),
];

const INTERFACE: [(KeyboardShortcut, &str); 3] = [
    (kb_shortcuts::ZOOM_IN, "Make the texts and buttons larger"),
    (kb_shortcuts::ZOOM_OUT, "Make the texts and buttons smaller"),
    (kb_shortcuts::ZOOM_RESET, "Show the texts and buttons at their usual size"),
];

/// Shows the list. `open` becomes false when the user closes it.
pub fn show(ctx: &egui::Context, open: &mut bool) {
    Window::new(concat!("Keys and mouse, Epiline ", env!("CARGO_PKG_VERSION")))
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .show(ctx, |ui| {
            let width = (ctx.content_rect().width() - 80.0).clamp(200.0, 1360.0);
            let room = (ctx.content_rect().height() - 140.0).max(120.0);
            ui.set_width(width);
            ScrollArea::vertical().max_height(room).min_scrolled_height(room).show(ui, |ui| {
                let mouse = MOUSE.map(|(action, what)| (action.to_owned(), what));
                let groups = GROUPS.map(|name| (name, keys_of(ui.ctx(), name)));
                let groups: Vec<_> = std::iter::once(("Mouse", mouse.to_vec())).chain(groups).collect();
                // A narrow window has fewer columns.
                let ends: &[usize] = match width {
                    _ if width > THREE_COLUMNS => &[4, 6, 8],
                    _ if width > TWO_COLUMNS => &[5, 8],
                    _ => &[8],
                };
                ui.columns(ends.len(), |columns| {
                    let mut first = 0;
                    for (ui, end) in columns.iter_mut().zip(ends) {
                        list(ui, &groups[first..*end]);
                        first = *end;
                    }
                });
            });
        });
}

/// Least widths for two and three columns, screen points.
const TWO_COLUMNS: f32 = 700.0;
const THREE_COLUMNS: f32 = 1160.0;

type ShortcutRows = Vec<(String, &'static str)>;

/// Returns the shortcuts of a group, each with the first sentence of its tooltip.
fn keys_of(ctx: &egui::Context, name: &str) -> ShortcutRows {
    let actions = ACTIONS.iter().filter(|action| !action.keys.is_empty() && action.group == name);
    let mut actions: Vec<_> = actions.collect();
    // The table of actions has the keys with Shift first. People look for the plain key first.
    for k in 1..actions.len() {
        let [before, after] = [k - 1, k].map(|at| actions[at].keys[0]);
        if before.logical_key == after.logical_key && before.modifiers.shift && !after.modifiers.shift {
            actions.swap(k - 1, k);
        }
    }
    let rows = actions.into_iter().map(|action| {
        let keys = key_text(ctx, &action.command).unwrap_or_default();
        (keys, action.tooltip.split(['.', ';']).next().unwrap_or_default())
    });
    let interface = INTERFACE.iter().filter(|_| name == "Program");
    rows.chain(interface.map(|(keys, what)| (ctx.format_shortcut(keys), *what))).collect()
}

/// Shows groups one below the other. The column of keys is as wide as the longest of them.
fn list(ui: &mut Ui, groups: &[(&str, ShortcutRows)]) {
    let font = TextStyle::Body.resolve(ui.style());
    let color = ui.visuals().strong_text_color();
    let width_of = |keys: &str| ui.painter().layout_no_wrap(keys.to_owned(), font.clone(), color).size().x;
    let longest =
        groups.iter().flat_map(|(_, rows)| rows).map(|(keys, _)| width_of(keys)).fold(0.0, f32::max);
    for (name, rows) in groups {
        ui.add_space(6.0);
        ui.label(RichText::new(*name).heading().size(16.0));
        let wide = (ui.available_width() - longest - 24.0).max(80.0);
        Grid::new(*name).num_columns(2).striped(true).min_row_height(20.0).spacing([12.0, 2.0]).show(
            ui,
            |ui| {
                for (keys, what) in rows {
                    ui.scope(|ui| {
                        ui.set_width(longest);
                        ui.label(RichText::new(keys).strong());
                    });
                    ui.scope(|ui| {
                        ui.set_width(wide);
                        ui.add(Label::new(*what).wrap());
                    });
                    ui.end_row();
                }
            },
        );
    }
}
