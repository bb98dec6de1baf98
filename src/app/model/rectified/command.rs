//! Commands about the rectified pair, and orders to write it.

use std::path::PathBuf;

use super::{RectifiedLayout, RectifiedView, RectifyQuestion};
use crate::io::{RectifiedOptions, TrustNote};
use crate::rectify::RectifyMethod;

/// A command about the rectified pair.
#[derive(Debug, Clone, PartialEq)]
pub enum RectifiedCommand {
    /// Set the method of rectification.
    SetMethod(RectifyMethod),
    /// Set the layout of the pictures.
    LayOut(RectifiedLayout),
    ToggleGuides,
    /// Show a part of the pictures; `None` shows all.
    View(Option<RectifiedView>),
    /// Shift the right picture to the right, px of the written pictures.
    Shift(f64),
    /// Set the position of the wipe, as a fraction of the width.
    Wipe(f32),
    /// Show the other picture in a blink.
    Swap,
    /// Start or stop the automatic blink.
    RunBlink,
    /// Show the dialog of exports, for the rectified pair.
    ShowExport,
    /// Choose the folder with the file dialog of the system.
    Browse,
    /// Stop writing the pair.
    StopExport,
}

/// An order to write the rectified pair.
#[derive(Clone)]
pub struct RectifyOrder {
    /// Pictures and geometry.
    pub question: RectifyQuestion,
    /// The folder. It is created if missing.
    pub folder: PathBuf,
    /// Files to write beside the pictures.
    pub options: RectifiedOptions,
    /// Verdict on the geometry.
    pub trust: Option<TrustNote>,
}

/// Progress of writing a rectified pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WritingProgress {
    /// Number of finished steps.
    pub done: usize,
    /// Number of all steps.
    pub all: usize,
    /// Name of the current step.
    pub what: &'static str,
}
