//! The context menu of a pinned line pair.

use egui::{RichText, Ui};

use super::command_button;
use super::tabs::describe_lines;
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::ids::TabId;

/// Shows the menu of the pinned line pair with this number.
pub fn show(ui: &mut Ui, model: &Model, number: usize, commands: &mut Vec<Command>) {
    let pins = model.open.focus.pins();
    let Some(place) = pins.iter().position(|pin| pin.number == number) else {
        ui.close();
        return;
    };
    ui.weak(format!("Line pair {}", number + 1));
    ui.label(RichText::new(describe_lines(pins[place].source)).weak().small());
    let look = ui.button("Show its profiles");
    if look.on_hover_text("Compare the intensities along its two lines.").clicked() {
        commands.extend([Command::Inspect(place), Command::ShowTab(TabId::Profiles)]);
        ui.close();
    }
    if command_button(ui, Command::Unpin(place), true, commands).clicked() {
        ui.close();
    }
}
