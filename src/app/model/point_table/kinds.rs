//! Order, selection and commands of the list of point pairs.

/// Columns that the list can be sorted by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PointColumn {
    /// Order of the clicks.
    #[default]
    Number,
    /// Given names. Pairs without a name come last.
    Name,
    /// Position in the left image, from left to right.
    Left,
    /// Position in the right image, from left to right.
    Right,
    /// Role of the pair.
    Role,
    /// Distance from the epipolar lines.
    Distance,
}

impl PointColumn {
    /// All columns, from left to right.
    pub const ALL: [Self; 6] =
        [Self::Number, Self::Name, Self::Left, Self::Right, Self::Role, Self::Distance];

    pub fn title(self) -> &'static str {
        match self {
            Self::Number => "Pair",
            Self::Name => "Name",
            Self::Left => "Left x, y",
            Self::Right => "Right x, y",
            Self::Role => "Role",
            Self::Distance => "Distance",
        }
    }

    /// Returns the tooltip of the heading.
    pub fn tooltip(self) -> &'static str {
        match self {
            Self::Number => {
                "The letter or number of the pair, in the order of the clicks. Click it to choose the row."
            }
            Self::Name => {
                "Your name for the pair. It is saved with the session, copied with the pair, and \
                 shown in the images on request."
            }
            Self::Left => "Position in the left image, px.",
            Self::Right => "Position in the right image, px.",
            Self::Role => "Use of the pair: in the estimate, as a check only, or left out.",
            Self::Distance => {
                "Symmetric distance: mean distance of the two points from each other's epipolar \
                 lines. Careful clicks stay below about 2 px."
            }
        }
    }
}

/// Order of the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PointOrder {
    /// The sorted column.
    pub column: PointColumn,
    /// Whether the order is reversed.
    pub descending: bool,
    /// First row of the next range selection.
    pub anchor: Option<usize>,
}

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
    /// Remove the pairs.
    Delete,
    /// Use the pairs in the estimate.
    Use,
    /// Use the pairs as checks only.
    CheckOnly,
    /// Exclude the pairs.
    Exclude,
}

/// A command about the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointsCommand {
    /// Sort by a column. The same column again reverses the order.
    SortBy(PointColumn),
    /// Select rows.
    Choose(usize, Choosing),
    /// Select all rows.
    ChooseAll,
    /// Edit the selected pairs.
    Edit(ChosenEdit),
    /// Name a pair.
    Rename(usize, String),
    /// Copy the selected pairs, or all, as a table.
    Copy,
    /// Request the contents of the clipboard.
    RequestPaste,
    /// Add the pairs of a table.
    Paste(String),
    /// Show given names in the images, or only letters.
    ToggleNames,
}
