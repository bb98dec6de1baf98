//! The list of keys and mouse actions.

use egui::{Align2, Grid, Label, RichText, ScrollArea, Ui, Window, vec2};

use crate::app::model::command::Command;
use crate::app::model::rectified::RectifiedCommand;
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

/// What the actions are about, in the order of the list.
const GROUPS: [&str; 6] = ["Points", "Files", "Looking", "Panels", "Result", "Program"];

/// Which of the groups an action belongs to.
fn group(command: &Command) -> &'static str {
    match command {
        Command::ShowOpenDialog
        | Command::StepPair { .. }
        | Command::Session(_)
        | Command::Exchange(_)
        | Command::Rectified(RectifiedCommand::ShowExport) => "Files",
        Command::ToggleInspectTool
        | Command::ToggleLink
        | Command::ToggleMap
        | Command::FitAll
        | Command::ToggleStacked
        | Command::ToggleLoupe
        | Command::Tones(_)
        | Command::Player(_)
        | Command::Rectified(_) => "Looking",
        Command::ShowTab(_)
        | Command::FoldTabs
        | Command::FoldSide
        | Command::FoldOverlays
        | Command::FoldStrip
        | Command::EnlargeTabs => "Panels",
        Command::ToggleTruth
        | Command::RandomTrial(_)
        | Command::Recompute
        | Command::ChooseHypothesis(_)
        | Command::ChooseContestant(_) => "Result",
        Command::TogglePalette
        | Command::ToggleTheme
        | Command::ToggleShortcuts
        | Command::Cancel
        | Command::Quit => "Program",
        _ => "Points",
    }
}

/// Shows the list; `open` becomes false when it is closed.
pub fn show(ctx: &egui::Context, open: &mut bool) {
    Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .show(ctx, |ui| {
            let width = (ctx.content_rect().width() - 80.0).clamp(200.0, 1000.0);
            let room = (ctx.content_rect().height() - 140.0).max(120.0);
            ui.set_width(width);
            ScrollArea::vertical().max_height(room).min_scrolled_height(room).show(ui, |ui| {
                let mouse = MOUSE.map(|(action, what)| (action.to_owned(), what));
                let [points, files, looking, panels, result, program] =
                    GROUPS.map(|name| (name, keys_of(ui.ctx(), name)));
                let halves =
                    [vec![("Mouse", mouse.to_vec()), points, files], vec![looking, panels, result, program]];
                // A narrow window has one group below the other.
                if width > TWO_COLUMNS {
                    ui.columns(2, |columns| {
                        for (ui, groups) in columns.iter_mut().zip(&halves) {
                            list(ui, groups);
                        }
                    });
                } else {
                    list(ui, &halves.concat());
                }
            });
        });
}

/// Width from which on the groups stand beside each other, screen points.
const TWO_COLUMNS: f32 = 700.0;
/// Width of the keys, screen points.
const KEYS: f32 = 150.0;

type Rows = Vec<(String, &'static str)>;

/// The keys of a group with the first sentence of what they do.
fn keys_of(ctx: &egui::Context, name: &str) -> Rows {
    let actions = ACTIONS.iter().filter(|action| !action.keys.is_empty() && group(&action.command) == name);
    let rows = actions.map(|action| {
        let keys = key_text(ctx, &action.command).unwrap_or_default();
        (keys, action.tooltip.split(['.', ';']).next().unwrap_or_default())
    });
    rows.collect()
}

fn list(ui: &mut Ui, groups: &[(&str, Rows)]) {
    for (name, rows) in groups {
        ui.add_space(6.0);
        ui.label(RichText::new(*name).heading().size(16.0));
        let wide = (ui.available_width() - KEYS - 24.0).max(80.0);
        Grid::new(*name).num_columns(2).striped(true).min_row_height(20.0).spacing([12.0, 3.0]).show(
            ui,
            |ui| {
                for (keys, what) in rows {
                    ui.scope(|ui| {
                        ui.set_width(KEYS);
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
