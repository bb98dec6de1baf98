//! The context menu of a point pair.

use egui::Ui;

use super::command_button;
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::document::{Role, pair_name};
use crate::app::model::focus::LineSource;
use crate::app::model::point_table::{ChosenEdit, PointsCommand};
use crate::app::model::suggesting::Repair;

/// Shows the menu of a complete or incomplete pair.
pub fn show(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let document = &model.document;
    let chosen = document.chosen.len();
    let together = chosen > 1 && document.chosen.contains(&pair);
    ui.weak(if together { format!("{chosen} chosen pairs") } else { format!("Pair {}", pair_name(pair)) });
    let mut offer = |ui: &mut Ui, command: Command, enabled: bool| {
        if command_button(ui, command, enabled, commands).clicked() {
            ui.close();
        }
    };
    if together {
        for edit in [ChosenEdit::Use, ChosenEdit::CheckOnly, ChosenEdit::Exclude, ChosenEdit::Delete] {
            offer(ui, PointsCommand::Edit(edit).into(), true);
        }
        return;
    }
    if pair < document.pairs.len() {
        for how in [Repair::Refine, Repair::Rematch] {
            offer(ui, Command::Repair(pair, how), model.repair_question(pair, how).is_some());
        }
        ui.separator();
        let only = document.role(pair) == Role::Used;
        offer(ui, Command::CheckOnly(pair, only), only || document.can_be_used(pair));
        offer(ui, Command::Pin(LineSource::Pair(pair)), model.shown().is_some());
        ui.separator();
    }
    offer(ui, Command::DeletePair(pair), true);
}
