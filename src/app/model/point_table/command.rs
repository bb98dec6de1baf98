//! Commands about the list of point pairs.

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointsCommand {
    Rename(usize, String),
    /// Copy all pairs as a table.
    Copy,
    RequestPaste,
    Paste(String),
}
