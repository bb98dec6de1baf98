//! What can be done with files of other programs.

use std::path::PathBuf;

use egui::{Key, KeyboardShortcut, Modifiers};

use super::Order;

/// Something to do with a file of another program.
#[derive(Debug, Clone, PartialEq)]
pub enum ExchangeCommand {
    /// Show the window for exporting.
    ShowExport,
    /// Choose the file of the export with the system's dialog, which suggests this path.
    BrowseExport(PathBuf),
    /// Write a file.
    Export(Order),
    /// Choose a file to import with the system's dialog.
    BrowseImport,
    /// Import files.
    Import(Vec<PathBuf>),
    /// Take the matrix that is being imported, in the reading of this number of the list; without a number as it is.
    Accept {
        /// Place in the list of the convention check.
        reading: Option<usize>,
        /// Whether the point pairs of its file take the place of those of the document.
        with_pairs: bool,
    },
    /// Do without the matrix that is being imported.
    Reject,
    /// Remove the imported geometry.
    RemoveImported,
}

impl ExchangeCommand {
    /// What it is called on buttons and in lists.
    pub fn name(&self) -> &'static str {
        match self {
            Self::ShowExport => "Export…",
            Self::BrowseExport(_) | Self::BrowseImport => "Browse",
            Self::Export(_) => "Export this",
            Self::Import(_) => "Import",
            Self::Accept { reading: Some(_), .. } => "Use this reading",
            Self::Accept { reading: None, .. } => "As it is",
            Self::Reject => "Cancel",
            Self::RemoveImported => "Remove the imported geometry",
        }
    }

    /// Its keys.
    pub fn shortcuts(&self) -> &'static [KeyboardShortcut] {
        match self {
            Self::ShowExport => const { &[KeyboardShortcut::new(Modifiers::COMMAND, Key::E)] },
            _ => &[],
        }
    }

    /// One sentence about what it does.
    pub fn tooltip(&self) -> &'static str {
        match self {
            Self::ShowExport => {
                "Write the geometry, the point pairs, the result, a profile or the view as a file for other programs."
            }
            Self::BrowseExport(_) => "Choose where to write in the system's dialog.",
            Self::Export(_) => "Write the file; one of the same name is replaced.",
            Self::BrowseImport => {
                "Choose a file with point pairs or a fundamental matrix in the system's dialog."
            }
            Self::Import(_) => {
                "Import point pairs, a fundamental matrix or two cameras for the images that are open."
            }
            Self::Accept { reading: Some(_), .. } => {
                "Take the matrix in the reading that is marked, and show its geometry in the whole window."
            }
            Self::Accept { reading: None, .. } => {
                "Take the matrix as its file has it, whatever the matches say."
            }
            Self::Reject => "Import nothing of this file.",
            Self::RemoveImported => "Remove the imported geometry. Undo brings it back.",
        }
    }
}
