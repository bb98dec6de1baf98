//! The bottom panel: one tab a file, registered in [`TABS`].

mod hypotheses;
mod inspected;
mod matrix;
mod pencils;
mod points;
mod profiles;
mod rectified;
mod residuals;

use egui::{RichText, Ui};

use super::finish_button;
use crate::app::command::Command;
use crate::app::scene::Scene;

/// A tab of the bottom panel.
pub struct Tab {
    /// Its heading.
    pub title: &'static str,
    /// One sentence about what it shows.
    pub tooltip: &'static str,
    /// Whether it shows the inspected line pair, which is matched only while something shows it.
    pub inspects: bool,
    /// Whether it shows the comparison with other methods, which is made only while something shows it.
    pub compares: bool,
    /// Whether it shows the rectified pair, which is made only while something shows it.
    pub rectifies: bool,
    /// Shows what belongs in the line of the headings, from the right.
    pub tools: fn(&mut Ui, &Scene, &mut Vec<Command>),
    /// Shows the rest.
    pub show: fn(&mut Ui, &Scene, &mut Vec<Command>),
}

/// The tabs from left to right. A new one is a new file and a line here.
pub const TABS: [Tab; 6] =
    [points::TAB, profiles::TAB, pencils::TAB, hypotheses::TAB, residuals::TAB, rectified::TAB];

/// With less room than this beside the headings their tools are left to the list of commands, screen points.
const ROOM_FOR_TOOLS: f32 = 100.0;

/// The line of the headings.
pub fn headings(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let padding = ui.spacing().button_padding;
        // Six headings and their tools share a line, in a small window, too.
        ui.spacing_mut().button_padding.x = 7.0;
        for (number, tab) in TABS.iter().enumerate() {
            let shown = scene.tab == Some(number);
            let response = ui.selectable_label(shown, RichText::new(tab.title).strong());
            finish_button(ui, response, Command::ShowTab(number), commands);
        }
        let right_to_left = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(right_to_left, |ui| {
            let fold = ui.button(if scene.tab.is_some() { "Hide" } else { "Show panel" });
            finish_button(ui, fold, Command::FoldTabs, commands);
            if scene.tab.is_some() {
                let (sign, name) =
                    if scene.look.tabs_enlarged { ("▼", "Reduce") } else { ("▲", "Enlarge") };
                let enlarge = ui.button(sign);
                enlarge.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
                finish_button(ui, enlarge, Command::EnlargeTabs, commands);
            }
            ui.spacing_mut().button_padding = padding;
            let room = ui.available_width() > ROOM_FOR_TOOLS;
            if let Some(tab) = scene.tab.and_then(|number| TABS.get(number)).filter(|_| room) {
                (tab.tools)(ui, scene, commands);
            }
        });
    });
}

/// The tab that was chosen.
pub fn chosen(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    if let Some(tab) = scene.tab.and_then(|number| TABS.get(number)) {
        ui.push_id(tab.title, |ui| (tab.show)(ui, scene, commands));
    }
}

/// What an empty tab says: what will appear, and what to do for it.
fn empty(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.weak(text);
}
