//! Selection and commands of the list of point pairs.

use crate::app::model::document::Role;

/// Effect of a click on the selection of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choosing {
    /// Selects the row alone.
    Only,
    /// Adds the row to the selection, or removes it.
    Toggle,
    /// Selects all rows from the last selected row to this one.
    Through,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointsCommand {
    Choose(usize, Choosing),
    ChooseAll,
    SetRole(Role),
    Delete,
    Rename(usize, String),
    /// Copy the selected pairs, or all, as a table.
    Copy,
    RequestPaste,
    Paste(String),
}

/// The edits of all selected pairs, in the order of menus.
pub const CHOSEN_EDITS: [PointsCommand; 4] = [
    PointsCommand::SetRole(Role::Used),
    PointsCommand::SetRole(Role::Check),
    PointsCommand::SetRole(Role::Excluded),
    PointsCommand::Delete,
];
