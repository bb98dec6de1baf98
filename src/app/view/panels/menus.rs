//! The context menus of the images, and the menu that copies F.

use egui::{Button, RichText, Ui};

use super::menu_entry;
use super::tabs::describe_lines;
use crate::app::model::{Command, ExchangeCommand, LineSource, Model, Role, Side, TabId, pair_name};
use crate::geometry::Point;
use crate::io::Notation;

/// Shows the menu of a complete or incomplete pair.
pub fn pair_menu(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let document = &model.document;
    ui.weak(format!("Pair {}", pair_name(pair)));
    if pair < document.pairs.len() {
        menu_entry(ui, Command::Refine(pair), model.repair_question(pair).is_some(), commands);
        menu_entry(ui, Command::MoveToMatch(pair), model.better_place(pair).is_some(), commands);
        ui.separator();
        for role in Role::ALL.into_iter().filter(|role| *role != document.role(pair)) {
            menu_entry(ui, Command::SetRole(pair, role), document.can_have(pair, role), commands);
        }
        menu_entry(ui, Command::Pin(LineSource::Pair(pair)), model.shown().is_some(), commands);
        ui.separator();
    }
    menu_entry(ui, Command::DeletePair(pair), true, commands);
}

/// Shows the menu of the pinned line pair with this number.
pub fn pin_menu(ui: &mut Ui, model: &Model, number: usize, commands: &mut Vec<Command>) {
    let Some(pin) = model.document.pins.iter().find(|pin| pin.number == number) else {
        ui.close();
        return;
    };
    ui.weak(format!("Line pair {}", number + 1));
    ui.label(RichText::new(describe_lines(model, pin.source)).weak().small());
    let look = ui.button("Show its profiles");
    if look.on_hover_text("Compare the intensities along its two lines.").clicked() {
        commands.extend([Command::Inspect(number), Command::ShowTab(TabId::Profiles)]);
        ui.close();
    }
    menu_entry(ui, Command::Unpin(number), true, commands);
}

/// Shows the menu of a place in an image without a point or a pinned line.
pub fn place_menu(ui: &mut Ui, model: &Model, side: Side, point: Point, commands: &mut Vec<Command>) {
    let document = &model.document;
    let pixel = model.open.pixel(side, point);
    ui.weak(format!("x {:.2}   y {:.2}", pixel.x, pixel.y));
    let next = pair_name(document.pairs.len());
    let place = match document.half {
        Some(half) if half.side != side => format!("Match of {next} is here"),
        Some(_) => format!("Move {next} here"),
        None => format!("Add pair {next} here"),
    };
    let has_lines = model.shown().is_some();
    let pin = Command::Pin(LineSource::Through { side, point });
    for (text, enabled, tooltip, command) in [
        (&*place, true, "Place a point here, as a click does.", Command::Place(side, point)),
        ("Pin the lines here", has_lines, "Keep the epipolar lines through this place on the images.", pin),
        ("Copy coordinates", true, "Copy x and y of this place, px.", Command::CopyPosition(pixel)),
        (
            "Turn clockwise by 90°",
            true,
            "Turn the image on the screen clockwise. Its coordinates stay as they are.",
            Command::TurnView(side),
        ),
    ] {
        let entry = ui.add_enabled(enabled, Button::new(text)).on_hover_text(tooltip);
        if entry.on_disabled_hover_text("There is no geometry yet.").clicked() {
            commands.push(command);
            ui.close();
        }
    }
    for (command, is_there) in [
        (Command::SwapImages, document.is_of_files()),
        (ExchangeCommand::RemoveGiven.into(), document.given.is_some()),
        (Command::RemoveCalibration, model.open.views().is_some()),
    ] {
        if is_there {
            menu_entry(ui, command, true, commands);
        }
    }
}

/// Shows the menu "Copy F as", with one entry per notation.
pub fn copy_fundamental_menu(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.add_enabled_ui(model.geometry_to_write().is_some(), |ui| {
        ui.menu_button("Copy F as", |ui| {
            for notation in Notation::ALL {
                menu_entry(ui, ExchangeCommand::CopyFundamental(notation).into(), true, commands);
            }
        });
    });
}
