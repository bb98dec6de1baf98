//! The first tab: the hypotheses of the result, or the chart of the step that is shown.

mod barcodes;
mod candidates;
mod crossings;
mod features;
mod fit;
mod gaps;
mod hypotheses;
mod matrix;
pub mod parameters;
mod pencils;
mod race;

use egui::Ui;

use super::{Tab, pale_earlier, say_earlier};
use crate::app::model::replay::ReplayCommand;
use crate::app::model::{Command, MethodStep, Model, TabId, Target};
use crate::estimate::SearchPlan;

/// Registered in [`super::TABS`].
pub const TAB: Tab = Tab { id: TabId::Step, tools, show };

/// Words in place of the plots of pencils that a search does not have.
const NO_PENCILS: &str = "This search has no line pencils.";
/// Words in place of plots without room.
const NO_ROOM: &str = "Enlarge the dock to see the plots.";

fn tools(ui: &mut Ui, model: &Model, _: &mut Vec<Command>) {
    say_earlier(ui, model.open.computation.is_behind());
}

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    pale_earlier(ui, model.open.computation.is_behind());
    let Some(place) = model.replayed() else {
        if features::show_different_scenes(ui, model) {
            return;
        }
        hypotheses::show(ui, model, commands);
        return;
    };
    match place.step {
        MethodStep::Motion | MethodStep::Barcodes => barcodes::show(ui, model, commands),
        MethodStep::Pencils => pencils::show(ui, model, commands),
        MethodStep::Candidates => candidates::show(ui, model, commands),
        MethodStep::Features | MethodStep::Matches => features::show(ui, model),
        MethodStep::Epipoles => crossings::show(ui, model, commands),
        MethodStep::RoundTrip => gaps::show(ui, model, commands),
        MethodStep::Validation => race::show(ui, model, commands),
        MethodStep::Refinement => fit::show(ui, model),
    }
}

/// Lights a part of the replay that is under the cursor, unless the replay plays. A click pauses it and shows the
/// hypothesis that the part belongs to.
fn touch(target: Target, clicked: bool, model: &Model, commands: &mut Vec<Command>) {
    if !model.open.replay.is_playing() {
        commands.push(Command::PointAt(target));
    }
    if clicked {
        commands.push(ReplayCommand::Show(target).into());
    }
}

/// Returns whether the search compares all lines at once, in place of pencils.
fn has_no_pencils(model: &Model) -> bool {
    let plan = model.document.search_plan();
    let all_lines = matches!(plan, SearchPlan::Barcodes | SearchPlan::LinesAlone { .. });
    all_lines && model.document.is_unclicked()
}
