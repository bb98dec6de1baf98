//! What can be done with the rectified pair.

use std::path::PathBuf;

use super::{Guides, RectifiedLayout, RectifiedView, RectifyQuestion};
use crate::io::{RectifiedOptions, TrustNote};
use crate::rectify::RectifyMethod;

/// Something to do with the rectified pair.
#[derive(Debug, Clone, PartialEq)]
pub enum RectifiedCommand {
    /// Choose how the images are rectified.
    SetMethod(RectifyMethod),
    /// Choose how the pictures are laid out.
    LayOut(RectifiedLayout),
    /// Choose the lines over the pictures.
    SetGuides(Guides),
    /// Show a part of the pictures; `None` is all of them.
    View(Option<RectifiedView>),
    /// Show the right picture so far to the right, px of the pictures as they are written.
    Shift(f64),
    /// Show the left picture up to this part of the width, and the right one from there on.
    Wipe(f32),
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

/// What is to be written, and where.
#[derive(Clone)]
pub struct RectifyOrder {
    /// The pair and its geometry.
    pub question: RectifyQuestion,
    /// The folder; made if missing.
    pub folder: PathBuf,
    /// What is written beside the pictures.
    pub options: RectifiedOptions,
    /// How far the geometry is to be trusted.
    pub trust: Option<TrustNote>,
}

/// How far the writing of a rectified pair is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WritingProgress {
    /// Steps that are done.
    pub done: usize,
    /// All steps.
    pub all: usize,
    /// What is being done.
    pub what: &'static str,
}
