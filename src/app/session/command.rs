//! What can be done with sessions.

use std::path::PathBuf;

use super::OpenSession;
use crate::app::document::Side;

/// Something to do with a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SessionCommand {
    /// Save in the file of the session, or ask where.
    Save,
    /// Ask where to save.
    SaveAs,
    /// Save in a file.
    SaveTo(PathBuf),
    /// Choose where to save with the system's dialog.
    BrowseSave,
    /// Open a session.
    Open(OpenSession),
    /// Choose an image that a session cannot find with the system's dialog.
    BrowseLost(Side),
    /// Remove the program's own copy of work that was not saved.
    DiscardLeftBehind(PathBuf),
}

impl SessionCommand {
    /// What it is called on buttons and in lists.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Save | Self::SaveTo(_) => "Save session",
            Self::SaveAs => "Save session as",
            Self::BrowseSave | Self::BrowseLost(_) => "Browse",
            Self::Open(_) => "Open session",
            Self::DiscardLeftBehind(_) => "Discard",
        }
    }

    /// One sentence about what it does.
    pub fn tooltip(&self) -> &'static str {
        match self {
            Self::Save | Self::SaveTo(_) => {
                "Save points, parameters, pinned lines and views in one readable file."
            }
            Self::SaveAs => "Save the session in another file.",
            Self::BrowseSave => "Choose where to save in the system's dialog.",
            Self::Open(_) => "Open this session with its images and points.",
            Self::BrowseLost(_) => "Choose the file in the system's file dialog.",
            Self::DiscardLeftBehind(_) => "Remove the copy of what was not saved.",
        }
    }
}
