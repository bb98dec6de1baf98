//! The pairs of the open folder, and the buttons for its ground truth.

use egui::{Button, ComboBox, ScrollArea, Ui};

use super::dialog::named;
use super::finish_button;
use crate::app::model::document::counted;
use crate::app::model::{Command, Model, Side};
use crate::io::PictureFolder;

/// Shows the choice of the pair.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    folder: &PictureFolder,
    pair: [usize; 2],
    commands: &mut Vec<Command>,
) {
    step(ui, folder, pair, false, commands);
    if folder.pairs_freely() {
        for side in Side::BOTH {
            view_chooser(ui, model, (folder, pair), side, commands);
        }
    } else {
        pair_chooser(ui, model, (folder, pair), commands);
    }
    step(ui, folder, pair, true, commands);
    kept_pairs(ui, model, folder, commands);
}

/// Shows a menu of the other pairs with points or pinned lines.
fn kept_pairs(ui: &mut Ui, model: &Model, folder: &PictureFolder, commands: &mut Vec<Command>) {
    let kept = model.kept_pairs();
    if kept.is_empty() {
        return;
    }
    let menu = ui.menu_button(format!("Pairs with work ({})", kept.len()), |ui| {
        ScrollArea::vertical().show(ui, |ui| {
            for pair in kept {
                let name = format!("{}: {}", folder.pair_name(pair), counted(model.points_on(pair)));
                if ui.button(name).clicked() {
                    commands.push(Command::OpenViews(pair));
                }
            }
        });
    });
    menu.response.on_hover_text(
        "Other pairs with points, pinned lines or a search of their own. They are saved with the session.",
    );
}

pub fn truth_button(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let button = Button::selectable(model.truth().is_some(), Command::ToggleTruth.name());
    let button = ui.add_enabled(model.open.known().is_some(), button.frame_when_inactive(true));
    if model.open.known().is_some() {
        finish_button(ui, button, Command::ToggleTruth, commands);
    } else {
        button.on_disabled_hover_text(model.open.why_no_truth());
    }
}

fn step(ui: &mut Ui, folder: &PictureFolder, pair: [usize; 2], forward: bool, commands: &mut Vec<Command>) {
    let enabled = folder.neighbour(pair, forward).is_some();
    let command = Command::StepPair { forward };
    let button = ui.add_enabled(enabled, Button::new(if forward { "▶" } else { "◀" }));
    finish_button(ui, named(button, command.name()), command, commands);
}

/// Shows the choice of one of the two views.
fn view_chooser(
    ui: &mut Ui,
    model: &Model,
    (folder, pair): (&PictureFolder, [usize; 2]),
    side: Side,
    commands: &mut Vec<Command>,
) {
    let (open, other) = (pair[side.index()], pair[side.other().index()]);
    let mut views = pair;
    let label = format!("The {} view", side.name());
    let response = ComboBox::from_id_salt(("view", side))
        .width(92.0)
        .selected_text(&folder.names()[open])
        .show_ui(ui, |ui| {
            for (number, name) in folder.names().iter().enumerate() {
                let mut opened = pair;
                opened[side.index()] = number;
                let button = Button::selectable(number == open, entry(model, name, opened));
                if ui.add_enabled(number != other, button).clicked() {
                    views = opened;
                }
            }
        });
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
    response.response.on_hover_text(format!("{label} of the folder. Any two views can form a pair."));
    if views != pair {
        commands.push(Command::OpenViews(views));
    }
}

fn pair_chooser(
    ui: &mut Ui,
    model: &Model,
    (folder, pair): (&PictureFolder, [usize; 2]),
    commands: &mut Vec<Command>,
) {
    let response =
        ComboBox::from_id_salt("pair").width(130.0).selected_text(folder.pair_name(pair)).show_ui(ui, |ui| {
            let pairs = (0..folder.names().len()).step_by(2).map(|view| [view, view + 1]);
            for other in pairs {
                let entry = entry(model, &folder.pair_name(other), other);
                if ui.selectable_label(other == pair, entry).clicked() && other != pair {
                    commands.push(Command::OpenViews(other));
                }
            }
        });
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "The pair"));
    response.response.on_hover_text("Choose which pair of the folder is open.");
}

/// Returns the name of an entry, with the number of points placed on the pair that it opens.
fn entry(model: &Model, name: &str, pair: [usize; 2]) -> String {
    match model.points_on(pair) {
        0 => name.to_owned(),
        1 => format!("{name}  (1 point)"),
        count => format!("{name}  ({count} points)"),
    }
}
