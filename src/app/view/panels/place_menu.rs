//! The context menu of a place in an image without a point or a pinned line.

use egui::{Button, Ui};

use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::document::{Side, pair_name};
use crate::app::model::focus::LineSource;
use crate::geometry::Point;

/// Shows the menu of a place.
pub fn show(ui: &mut Ui, model: &Model, side: Side, point: Point, commands: &mut Vec<Command>) {
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
            "Measure from here",
            true,
            "Measure distance and direction from this place to the next click.",
            Command::MeasureFrom(side, point),
        ),
        (
            "Turn this view by 90°",
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
}
