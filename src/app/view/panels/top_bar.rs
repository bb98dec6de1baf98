//! The bar above the pictures: files, undo, the pin tool, the switch of the stage, overlays, export, help.

use egui::containers::menu::MenuButton;
use egui::{Button, Rect, RichText, Ui, UiBuilder, vec2};

use super::dialog::named;
use super::icons::{ICON, Icon, icon_button, menu_button};
use super::{copy_fundamental_menu, finish_button, menu_entry, overlays_menu, pair_chooser};
use crate::app::model::look::Tool;
use crate::app::model::rectified::RectifiedCommand;
use crate::app::model::{Command, ExchangeCommand, Model, SessionCommand, StageId};
use crate::app::view::theme;
use crate::synthetic::Sample;

/// Width from which the search has a field rather than an icon, screen points, and the room that the choice of a
/// pair takes from it.
const ROOM_FOR_SEARCH: f32 = 1000.0;
const PAIR: f32 = 240.0;
/// Width from which the switch is in the middle of the bar, screen points.
const ROOM_FOR_MIDDLE: f32 = 900.0;
/// Width of a button of the switch in the middle, screen points.
const STAGE: f32 = 80.0;

pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let area = ui.max_rect();
    ui.spacing_mut().item_spacing.x = 3.0;
    let middle = area.width() >= ROOM_FOR_MIDDLE && model.folder().is_none();
    ui.horizontal_centered(|ui| {
        icons(ui, model, commands);
        if let Some((folder, pair)) = model.folder() {
            ui.separator();
            pair_chooser::show(ui, model, folder, pair, commands);
        }
        if !middle {
            ui.separator();
            switch(ui, 0.0, model, commands);
        }
        let taken = if model.folder().is_some() { PAIR } else { 0.0 };
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ends(ui, area.width() >= ROOM_FOR_SEARCH + taken, model, commands);
        });
    });
    if middle {
        let place = Rect::from_center_size(
            area.center(),
            vec2(stages(model).count() as f32 * (STAGE + 2.0), area.height()),
        );
        ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
            ui.horizontal_centered(|ui| switch(ui, STAGE, model, commands));
        });
    }
}

fn icons(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let any = model.document.pictures.is_some();
    let mut button = |ui: &mut Ui, icon: Icon, command: Command, enabled: bool, on: bool| {
        let name = match icon {
            Icon::Open => "Open",
            Icon::Save => "Save",
            _ => command.name(),
        };
        let response = named(icon_button(ui, icon, enabled, on), name);
        finish_button(ui, response, command, commands);
    };
    button(ui, Icon::Open, Command::ShowOpenDialog, true, false);
    button(ui, Icon::Save, SessionCommand::Save.into(), any, false);
    ui.separator();
    button(ui, Icon::Undo, Command::Undo, model.history.can_undo(), false);
    button(ui, Icon::Redo, Command::Redo, model.history.can_redo(), false);
    ui.separator();
    button(ui, Icon::Pin, Command::TogglePinTool, any, model.tool == Tool::Inspect);
    button(ui, Icon::Fit, Command::FitAll, any, false);
    button(ui, Icon::Brightness, Command::ToggleStretch, any, model.open.stretched.is_some());
}

/// Returns the stages of the switch. Sequences have no scene.
fn stages(model: &Model) -> impl Iterator<Item = StageId> {
    let has_scene = !model.compares_barcodes();
    StageId::ALL.into_iter().filter(move |stage| *stage != StageId::Scene || has_scene)
}

fn switch(ui: &mut Ui, least_width: f32, model: &Model, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 2.0;
    for stage in stages(model) {
        let shown = model.stage() == stage;
        let enabled = stage == StageId::Pictures || model.can_rectify();
        let button = Button::selectable(shown, stage.title()).min_size(vec2(least_width, 26.0));
        let response = ui.add_enabled(enabled, button);
        finish_button(ui, response, Command::ShowStage(stage), commands);
    }
}

/// Shows the right end of the bar, from right to left.
fn ends(ui: &mut Ui, has_room: bool, model: &Model, commands: &mut Vec<Command>) {
    let any = model.document.pictures.is_some();
    help(ui, commands);
    export(ui, any, model, commands);
    let search = if has_room {
        ui.add(Button::new(RichText::new("Search commands      Ctrl+K").weak()).min_size(vec2(0.0, 26.0)))
    } else {
        icon_button(ui, Icon::Search, true, false)
    };
    finish_button(ui, named(search, Command::TogglePalette.name()), Command::TogglePalette, commands);
    overlays_menu::show(ui, model, commands);
}

fn help(ui: &mut Ui, commands: &mut Vec<Command>) {
    let button = Button::new(RichText::new("?").strong()).min_size(ICON);
    let (menu, _) = MenuButton::from_button(button).ui(ui, |ui| {
        for (command, title) in [
            (Command::ToggleShortcuts, "Keys and mouse"),
            (Command::OpenSample(Sample::Alley), "Open the sample pictures"),
            (Command::OpenSample(Sample::Courtyard), "Open the second sample"),
            (Command::OpenSampleSequences, "Open the sample sequences"),
            (Command::ToggleTheme, "Light or dark theme"),
        ] {
            let entry = ui.button(title);
            if finish_button(ui, entry, command, commands).clicked() {
                ui.close();
            }
        }
    });
    named(menu, "Help").on_hover_text("Keys, samples and theme.");
}

/// Shows the menu of exports. It has the accent colour once there is something to export.
fn export(ui: &mut Ui, any: bool, model: &Model, commands: &mut Vec<Command>) {
    let palette = theme::palette(ui.visuals());
    let has_result = model.geometry_to_write().is_some();
    let (title, fill) = (RichText::new("Export"), has_result.then_some(palette.accent));
    let title = if has_result { title.color(palette.on_accent) } else { title };
    ui.add_enabled_ui(any, |ui| {
        let menu = menu_button(ui, title, fill, |ui| {
            let all = ui.button("Export geometry, points or figure…");
            if finish_button(ui, all, ExchangeCommand::ShowExport(None).into(), commands).clicked() {
                ui.close();
            }
            let can = has_result && model.activity.writing.is_none();
            menu_entry(ui, RectifiedCommand::ShowExport.into(), can, commands);
            ui.separator();
            copy_fundamental_menu(ui, model, commands);
            menu_entry(ui, Command::CopyView, true, commands);
        });
        named(menu, "Export")
            .on_hover_text("Write the geometry, the point pairs, a figure or the rectified pair.");
    });
}
