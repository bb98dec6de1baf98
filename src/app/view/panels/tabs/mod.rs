//! The bottom panel, one file per tab.

mod barcodes;
mod hypotheses;
mod inspected;
mod matrix;
mod pencils;
mod points;
mod profiles;
mod rectified;
mod residuals;

use egui::{Id, RichText, Ui};

use super::dialog::named;
use super::finish_button;
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::ids::TabId;
use crate::app::view::theme;

pub use inspected::describe as describe_lines;
pub use rectified::forget_textures;

/// A tab of the bottom panel.
pub struct Tab {
    /// Which tab it is.
    pub id: TabId,
    /// Tools in the line of headings, shown from right to left.
    pub tools: fn(&mut Ui, &Model, &mut Vec<Command>),
    /// Content of the tab.
    pub show: fn(&mut Ui, &Model, &mut Vec<Command>),
}

/// The tabs from left to right.
static TABS: [Tab; TabId::ALL.len()] =
    [points::TAB, profiles::TAB, pencils::TAB, hypotheses::TAB, residuals::TAB, rectified::TAB];

/// Room beside the headings below which the tools are hidden, screen points. The list of commands
/// still offers them.
const ROOM_FOR_TOOLS: f32 = 100.0;

/// Width below which the headings wrap to a second row, screen points.
const ONE_ROW: f32 = 580.0;

/// Shows the line of headings.
pub fn headings(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let padding = ui.spacing().button_padding;
    if ui.available_width() < ONE_ROW {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().button_padding.x = 7.0;
            titles(ui, model, commands);
            folding(ui, model, commands);
        });
        return;
    }
    ui.horizontal(|ui| {
        // Narrow padding lets six headings and their tools share a line, even in a small window.
        ui.spacing_mut().button_padding.x = 7.0;
        titles(ui, model, commands);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            folding(ui, model, commands);
            ui.spacing_mut().button_padding = padding;
            let Some(tab) = chosen_tab(model) else { return };
            let id = Id::unique(("width of tools", tab.id.title()));
            let needed = ui.data(|data| data.get_temp(id)).unwrap_or(ROOM_FOR_TOOLS);
            if ui.available_width() > needed {
                let tools = ui.scope(|ui| (tab.tools)(ui, model, commands)).response;
                ui.data_mut(|data| data.insert_temp(id, tools.rect.width().max(ROOM_FOR_TOOLS)));
            }
        });
    });
}

fn titles(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    for tab in &TABS {
        let shown = model.tab() == Some(tab.id);
        let response = ui.selectable_label(shown, RichText::new(tab.id.title()).strong());
        finish_button(ui, response, Command::ShowTab(tab.id), commands);
    }
}

/// Shows the buttons that change the height of the panel.
fn folding(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let is_open = model.tab().is_some();
    let fold = ui.button(if is_open { "Hide" } else { "Show" });
    let fold = named(fold, if is_open { "Hide panel" } else { "Show panel" });
    finish_button(ui, fold, Command::FoldTabs, commands);
    if is_open {
        let (sign, name) = if model.look.tabs_enlarged { ("▼", "Reduce") } else { ("▲", "Enlarge") };
        let enlarge = named(ui.button(sign), name);
        finish_button(ui, enlarge, Command::EnlargeTabs, commands);
    }
}

fn chosen_tab(model: &Model) -> Option<&'static Tab> {
    TABS.iter().find(|tab| Some(tab.id) == model.tab())
}

/// Shows the chosen tab.
pub fn chosen(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    if let Some(tab) = chosen_tab(model) {
        ui.push_id(tab.id.title(), |ui| (tab.show)(ui, model, commands));
    }
}

/// Shows a note that the tab still refers to the points before a move.
fn say_earlier(ui: &mut Ui, is_earlier: bool) {
    if is_earlier {
        ui.weak("from before the move");
    }
}

/// Fades content that still refers to the points before a move.
fn pale_earlier(ui: &mut Ui, is_earlier: bool) {
    if is_earlier {
        ui.set_opacity(theme::STALE_OPACITY);
    }
}

/// Shows the text of an empty tab: what will appear, and how to get there.
fn empty(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.weak(text);
}
