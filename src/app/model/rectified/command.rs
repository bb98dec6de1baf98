//! Commands about the rectified pair, and orders to write it.

use std::path::PathBuf;

use super::{RectifiedLayout, RectifiedView, RectifyQuestion};
use crate::io::{RectifiedOptions, TrustNote};
use crate::rectify::RectifyMethod;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RectifiedCommand {
    SetMethod(RectifyMethod),
    LayOut(RectifiedLayout),
    ToggleGuides,
    /// Show high pictures turned, or as in the files.
    ToggleTurned,
    /// Show a part of the pictures; `None` shows all.
    View(Option<RectifiedView>),
    /// Shift the right picture to the right, px of the written pictures.
    Shift(f64),
    /// Show the other picture in a blink.
    Swap,
    RunBlink,
    /// Show the dialog of exports, for the rectified pair.
    ShowExport,
    StopExport,
}

#[derive(Clone)]
pub struct RectifyOrder {
    pub question: RectifyQuestion,
    /// The folder. It is created if missing.
    pub folder: PathBuf,
    /// Files to write beside the pictures.
    pub options: RectifiedOptions,
    pub trust: Option<TrustNote>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WritingProgress {
    pub done: usize,
    pub all: usize,
    /// Name of the current step.
    pub what: &'static str,
}
