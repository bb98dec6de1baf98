//! The tabs of the dock, one file or folder each.

mod barcodes;
mod compare;
mod inspected;
mod profiles;
pub mod rectified;
mod residuals;
mod step;

use egui::{Align, Button, Label, Layout, RichText, Ui, vec2};

use super::{busy, finish_button, main_button};
use crate::app::model::{Command, Model, TabId, step as steps};
use crate::app::view::theme;

pub use inspected::describe as describe_lines;
pub use rectified::forget_textures;
pub use residuals::px;
pub use step::parameters;

pub struct Tab {
    pub id: TabId,
    /// Tools in the line of headings, shown from right to left.
    pub tools: fn(&mut Ui, &Model, &mut Vec<Command>),
    pub show: fn(&mut Ui, &Model, &mut Vec<Command>),
}

/// The tabs from left to right.
static TABS: [Tab; TabId::ALL.len()] = [step::TAB, profiles::TAB, residuals::TAB, compare::TAB];

/// Room beside the headings from which the tools are in the same line, screen points.
const ROOM_FOR_TOOLS: f32 = 110.0;

/// Width from which the headings have their usual size, screen points.
const ROOM_FOR_HEADINGS: f32 = 320.0;

pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let Some(tab) = TABS.iter().find(|tab| tab.id == model.look.tab) else { return };
    // Small headings fit in one row of the narrowest dock.
    let is_narrow = ui.available_width() < ROOM_FOR_HEADINGS;
    let row = Layout::left_to_right(Align::Center);
    let height = ui.spacing().interact_size.y;
    let has_room = ui.allocate_ui_with_layout(vec2(ui.available_width(), height), row, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.spacing_mut().button_padding.x = if is_narrow { 2.0 } else { 7.0 };
        // A moment of the replay has its own chart; the other tabs are about the result.
        let in_replay = model.open.replay.place.is_some();
        for tab in TABS.iter().filter(|tab| tab.id == TabId::Step || !in_replay) {
            let title = RichText::new(title(tab.id, model));
            let title = if is_narrow { title.small() } else { title };
            let response = ui.add(Button::selectable(model.look.tab == tab.id, title));
            finish_button(ui, response, Command::ShowTab(tab.id), commands);
        }
        let has_room = ui.available_width() >= ROOM_FOR_TOOLS;
        if has_room {
            tools(ui, tab, model, commands);
        }
        has_room
    });
    let has_tools = match tab.id {
        TabId::Profiles => !model.document.pins.is_empty(),
        TabId::Step => model.open.computation.is_behind(),
        TabId::Residuals | TabId::Compare => true,
    };
    if has_tools && !has_room.inner {
        ui.horizontal(|ui| tools(ui, tab, model, commands));
    }
    ui.push_id(tab.id.title(), |ui| (tab.show)(ui, model, commands));
}

/// Returns the heading of a tab. The first one has the name of the step that is shown.
fn title(tab: TabId, model: &Model) -> &'static str {
    let step = model.replayed().filter(|_| tab == TabId::Step);
    step.map_or(tab.title(), |place| steps::title(place.step, model.document.search_plan()))
}

/// Shows the tools of a tab from right to left.
fn tools(ui: &mut Ui, tab: &Tab, model: &Model, commands: &mut Vec<Command>) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = theme::GAP / 2.0;
        (tab.tools)(ui, model, commands);
    });
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
    ui.add_space(4.0);
    ui.add(Label::new(RichText::new(text).weak()).wrap());
}
