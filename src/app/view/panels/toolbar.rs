//! The toolbar: files, undo, tools, view and help.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Align, Button, Layout, PopupCloseBehavior, ScrollArea, Ui};

use super::{command_button, finish_button, tones};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::command::ExchangeCommand;
use crate::app::model::command::SessionCommand;
use crate::app::model::look::Tool;
use crate::app::model::point_table::PointsCommand;
use crate::app::view::actions::conditions::has_strip;
use crate::app::view::panes::overlays::OVERLAYS;

/// Width below which the toolbar wraps, screen points.
const ONE_ROW: f32 = 800.0;

/// Shows the bar.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let pinned = !model.open.focus.pins().is_empty();
    if ui.available_width() < ONE_ROW + if pinned { 90.0 } else { 0.0 } {
        ui.horizontal_wrapped(|ui| {
            tools(ui, model, commands);
            ui.separator();
            program(ui, commands);
        });
        return;
    }
    ui.horizontal(|ui| {
        tools(ui, model, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| program(ui, commands));
    });
}

/// Shows the tools for the images.
fn tools(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let any = model.document.pictures.is_some();
    let open = ui.button("Open");
    finish_button(ui, open, Command::ShowOpenDialog, commands);
    command_button(ui, Command::OpenSample, true, commands);
    let save = ui.add_enabled(any, Button::new("Save"));
    finish_button(ui, save, SessionCommand::Save.into(), commands);
    command_button(ui, ExchangeCommand::ShowExport.into(), any, commands);
    ui.separator();
    command_button(ui, Command::Undo, model.history.can_undo(), commands);
    command_button(ui, Command::Redo, model.history.can_redo(), commands);
    ui.separator();
    command_button(ui, Command::FitAll, any, commands);
    let pin = Button::selectable(model.tool == Tool::Inspect, Command::ToggleInspectTool.name());
    let pin = ui.add_enabled(any, pin.frame_when_inactive(true));
    finish_button(ui, pin, Command::ToggleInspectTool, commands);
    if !model.open.focus.pins().is_empty() {
        command_button(ui, Command::UnpinAll, true, commands);
    }
    let stays_open = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (menu, _) = MenuButton::new("View").config(stays_open).ui(ui, |ui| view_menu(ui, model, commands));
    menu.on_hover_text("Choose how the images are shown, and which panels are visible.");
    if any {
        tones::show(ui, model, commands);
    }
}

/// Shows the buttons for the theme and help.
fn program(ui: &mut Ui, commands: &mut Vec<Command>) {
    let keys = ui.add(Button::new("Keys"));
    finish_button(ui, keys, Command::ToggleShortcuts, commands);
    let palette = ui.add(Button::new(Command::TogglePalette.name()));
    finish_button(ui, palette, Command::TogglePalette, commands);
    let theme = ui.add(Button::new(if ui.visuals().dark_mode { "Light" } else { "Dark" }));
    finish_button(ui, theme, Command::ToggleTheme, commands);
}

/// Shows the menu of the view: images, panels and overlays.
fn view_menu(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let look = &model.look;
    let mut switch = |ui: &mut Ui, command: Command, name: &str, mut on: bool| {
        let choice = ui.checkbox(&mut on, name);
        finish_button(ui, choice, command, commands);
    };
    switch(ui, Command::ToggleLink, Command::ToggleLink.name(), look.linked);
    switch(ui, Command::ToggleStacked, Command::ToggleStacked.name(), look.stacked);
    switch(ui, Command::ToggleMap, Command::ToggleMap.name(), look.map);
    switch(ui, Command::ToggleLoupe, Command::ToggleLoupe.name(), look.loupe);
    switch(ui, PointsCommand::ToggleNames.into(), "Pair names", look.names);
    ui.separator();
    switch(ui, Command::FoldSide, "Side panel", !look.side_folded);
    switch(ui, Command::FoldTabs, "Bottom panel", !look.tabs_folded);
    switch(ui, Command::FoldOverlays, "Overlay row", !look.overlays_folded);
    if has_strip(model) {
        switch(ui, Command::FoldStrip, "Images of the folder", !look.strip_folded);
    }
    ui.separator();
    // The overlay row is hidden in a low window.
    ui.menu_button("Overlays", |ui| {
        let room = (ui.ctx().content_rect().height() - 120.0).max(100.0);
        ScrollArea::vertical().max_height(room).show(ui, |ui| {
            for overlay in OVERLAYS.iter().filter(|overlay| model.offers(overlay.id)) {
                let mut on = look.shows(overlay.id);
                if ui.checkbox(&mut on, overlay.id.name()).on_hover_text(overlay.tooltip).clicked() {
                    commands.push(Command::ToggleOverlay(overlay.id));
                }
            }
        });
    });
}
