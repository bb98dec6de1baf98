//! Commands about the list of point pairs.

use egui::{Context, ViewportCommand};

use super::Inspector;
use crate::app::model::point_table::PointsCommand;

impl Inspector {
    /// Applies a command about the list of point pairs.
    pub(super) fn apply_to_points(&mut self, ctx: &Context, command: PointsCommand) {
        let model = &mut self.model;
        match command {
            PointsCommand::SortBy(column) => model.sort_points(column),
            PointsCommand::Choose(pair, how) => model.choose_pair(pair, how),
            PointsCommand::ChooseAll => model.choose_all_pairs(),
            PointsCommand::Edit(what) => model.edit_chosen(what),
            PointsCommand::Rename(pair, name) => model.rename_pair(pair, &name),
            PointsCommand::Copy if model.document.pairs.is_empty() => {}
            PointsCommand::Copy => {
                let text = model.copied_pairs();
                let count = text.lines().count() - 1;
                let plural = if count == 1 { "" } else { "s" };
                model.open.done.tell(format!("Copied {count} point pair{plural} as a table"));
                ctx.copy_text(text);
            }
            PointsCommand::RequestPaste => ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
            PointsCommand::Paste(text) => model.paste_pairs(&text),
            PointsCommand::ToggleNames => model.look.names = !model.look.names,
        }
    }
}
