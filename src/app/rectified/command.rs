//! What can be done with the rectified pair, with names, tooltips and keys like those of every
//! [`crate::app::command::Command`].

use std::path::PathBuf;

use egui::{Key, KeyboardShortcut, Modifiers};

use super::{Guides, Layout, RectifiedView};
use crate::io::RectifiedOptions;
use crate::rectify::Method;

/// Something to do with the rectified pair.
#[derive(Debug, Clone, PartialEq)]
pub enum RectifiedCommand {
    /// Choose how the images are rectified.
    SetMethod(Method),
    /// Choose how the pictures are laid out.
    LayOut(Layout),
    /// Choose the lines over the pictures.
    SetGuides(Guides),
    /// Show a part of the pictures; `None` is all of them.
    View(Option<RectifiedView>),
    /// Show the other picture in the place of this one.
    Swap,
    /// Let the pictures take turns by the clock, or not.
    RunBlink,
    /// Show the window for writing the pair.
    ShowExport,
    /// Choose the folder with the system's dialog.
    Browse,
    /// Write the pair.
    Export {
        /// The folder; made if missing.
        folder: PathBuf,
        /// What is written.
        options: RectifiedOptions,
    },
    /// Stop writing the pair.
    StopExport,
}

impl RectifiedCommand {
    /// What it is called on buttons and in lists.
    pub fn name(&self) -> &'static str {
        match self {
            Self::SetMethod(_) => "Rectification method",
            Self::LayOut(_) => "Layout of the rectified pair",
            Self::SetGuides(_) => "Guide lines",
            Self::View(_) => "Fit the rectified pair",
            Self::Swap => "Swap",
            Self::RunBlink => "By itself",
            Self::ShowExport => "Export",
            Self::Browse => "Browse",
            Self::Export { .. } => "Export rectified pair",
            Self::StopExport => "Stop",
        }
    }

    /// One sentence about what it does.
    pub fn tooltip(&self) -> &'static str {
        match self {
            Self::SetMethod(Method::Auto) => {
                "Planar where it bends the images little, else polar; the reason is given below."
            }
            Self::SetMethod(Method::Planar) => {
                "One homography an image: straight lines stay straight. Impossible with an epipole inside an image."
            }
            Self::SetMethod(Method::Polar) => {
                "A row for each pair of half epipolar lines: works wherever the epipoles are, but bends straight lines."
            }
            Self::LayOut(_) => "Show the rectified pictures side by side, by turns, or red and cyan.",
            Self::SetGuides(_) => "Horizontal lines over the rectified pictures, to compare rows by.",
            Self::View(_) => "Show the rectified pictures whole; a double click does it, too.",
            Self::Swap => "Show the other rectified picture in the place of this one.",
            Self::RunBlink => "Let the two rectified pictures take turns by the clock.",
            Self::ShowExport => {
                "Write the rectified pair at full size into a folder, with its homographies or tables and its measures."
            }
            Self::Browse => "Choose the folder in the system's dialog.",
            Self::Export { .. } => "Write the files. Files of the same names are replaced.",
            Self::StopExport => "Stop writing the rectified pair.",
        }
    }

    /// Its keys, the first one being the one that is shown.
    pub fn shortcuts(&self) -> &'static [KeyboardShortcut] {
        match self {
            Self::Swap => const { &[KeyboardShortcut::new(Modifiers::NONE, Key::X)] },
            Self::ShowExport => {
                const { &[KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::E)] }
            }
            _ => &[],
        }
    }
}
