//! What the list of point pairs is sorted by, how rows are chosen, and what can be done with them.

/// What the list is sorted by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PointColumn {
    /// The order of the clicks.
    #[default]
    Number,
    /// The names that were given, those without one last.
    Name,
    /// The position in the left image, from left to right.
    Left,
    /// The position in the right image, from left to right.
    Right,
    /// What it is for.
    Role,
    /// The distance from the epipolar lines.
    Distance,
}

impl PointColumn {
    /// All of them, from left to right.
    pub const ALL: [Self; 6] =
        [Self::Number, Self::Name, Self::Left, Self::Right, Self::Role, Self::Distance];

    /// Heading of the column.
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

    /// What is in it.
    pub fn tooltip(self) -> &'static str {
        match self {
            Self::Number => {
                "The letter or number of the pair, in the order of the clicks. Click it to choose the row."
            }
            Self::Name => {
                "What you call the pair: saved with the session, copied, and shown in the images on request."
            }
            Self::Left => "Position in the left image, px.",
            Self::Right => "Position in the right image, px.",
            Self::Role => "Whether the geometry is estimated from the pair or only checked by it.",
            Self::Distance => {
                "Symmetric distance: the mean distance of the two points from each other's epipolar lines. Up to some \
                 2 px is what a careful click has."
            }
        }
    }
}

/// The order of the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PointOrder {
    /// What it is sorted by.
    pub column: PointColumn,
    /// The last one first.
    pub descending: bool,
    /// Where the next run of chosen rows begins.
    pub anchor: Option<usize>,
}

/// How a row is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choosing {
    /// The row alone.
    Only,
    /// The row as well, or not any more.
    Toggle,
    /// All from the row chosen before to it.
    Through,
}

/// What is done with all chosen pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChosenEdit {
    /// Remove them.
    Delete,
    /// The geometry is estimated from them.
    Use,
    /// The pairs only check it.
    CheckOnly,
    /// The pairs are left out.
    Exclude,
}

/// Something to do with the list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointsCommand {
    /// Sort by a column; again turns the order around.
    SortBy(PointColumn),
    /// Choose rows.
    Choose(usize, Choosing),
    /// Choose all rows.
    ChooseAll,
    /// Do something with the rows that are chosen.
    Edit(ChosenEdit),
    /// Give a pair a name.
    Rename(usize, String),
    /// Copy the chosen pairs, or all, as a table.
    Copy,
    /// Ask the system for what was copied.
    RequestPaste,
    /// Add the pairs of a table.
    Paste(String),
    /// Show the given names in the images, or the letters alone.
    ToggleNames,
}
