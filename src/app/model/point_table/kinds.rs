//! Selection and commands of the list of point pairs.

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

/// Edit of all selected pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChosenEdit {
    Delete,
    Use,
    CheckOnly,
    Exclude,
}

/// A command about the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointsCommand {
    Choose(usize, Choosing),
    ChooseAll,
    Edit(ChosenEdit),
    Rename(usize, String),
    /// Copy the selected pairs, or all, as a table.
    Copy,
    /// Request the contents of the clipboard.
    RequestPaste,
    /// Add the pairs of a table.
    Paste(String),
}
