//! The bars, the dock and the dialogs around the images, one file each. They read the [`crate::app::model::Model`] and
//! return commands.

mod busy;
mod card;
mod dialog;
pub mod dock;
mod export;
mod focal_dialog;
mod icons;
mod menus;
mod messages;
mod open_dialog;
mod overlays_menu;
mod pair_chooser;
mod pairs;
mod palette;
mod player;
mod reading;
mod relocate_dialog;
mod save_dialog;
mod shortcuts;
mod status;
mod step_words;
mod table;
pub mod tabs;
mod terms;
pub mod timeline;
mod top_bar;

use egui::{Button, Response, RichText, Ui};

use crate::app::model::command::Command;
use crate::app::view::keyboard::key_text;
use crate::app::view::theme;

pub use export::FileExport;
pub use focal_dialog::FocalDialog;
pub use menus::{copy_fundamental_menu, pair_menu, pin_menu, place_menu};
pub use open_dialog::OpenDialog;
pub use palette::CommandPalette;
pub use reading::ReadingDialog;
pub use relocate_dialog::RelocateDialog;
pub use save_dialog::SaveDialog;

pub use messages::show as messages;
pub use pair_chooser::truth_button;
pub use shortcuts::show as shortcuts;
pub use status::show as status;
pub use top_bar::show as top_bar;

/// Shows a command's button, with its name, tooltip and shortcut.
fn command_button(ui: &mut Ui, command: Command, enabled: bool, commands: &mut Vec<Command>) -> Response {
    let response = ui.add_enabled(enabled, Button::new(command.name()));
    finish_button(ui, response, command, commands)
}

/// Shows a command's button in a menu. A click, or a key on it, closes the menu.
fn menu_entry(ui: &mut Ui, command: Command, enabled: bool, commands: &mut Vec<Command>) {
    if command_button(ui, command, enabled, commands).clicked() {
        ui.close();
    }
}

/// Shows a button in the accent colour.
fn main_button(ui: &mut Ui, name: &str) -> Response {
    let palette = theme::palette(ui.visuals());
    ui.add(Button::new(RichText::new(name).color(palette.on_accent)).fill(palette.accent))
}

/// Adds the tooltip to a command's button, and pushes the command when it is clicked.
fn finish_button(ui: &Ui, response: Response, command: Command, commands: &mut Vec<Command>) -> Response {
    let tooltip = match key_text(ui.ctx(), &command) {
        Some(key) => format!("{} ({key})", command.tooltip()),
        None => command.tooltip().to_owned(),
    };
    let response = response.on_hover_text(&tooltip).on_disabled_hover_text(tooltip);
    if response.clicked() {
        commands.push(command);
    }
    response
}
