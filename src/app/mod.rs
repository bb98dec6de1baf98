//! The window: two images, point pairs on them, and the geometry that follows.
//!
//! | module | what it holds |
//! |---|---|
//! | [`model`] | the state: plain data, testable without a window |
//! | `tasks` | what is done off the window's thread |
//! | `view` | how everything looks, and what a person may do with it |
//! | `inspector` | the three together, and the one place where commands are applied |
//! | `shell` | the program's window around it |
//!
//! # From a click to a line
//! `view::panes::ImagePane` turns a click into [`model::command::Command::Place`]; the inspector applies it to the
//! [`model::document::Document`] and notes it in the [`model::history::History`]; at the end of the frame
//! `tasks::Estimating::follow` sees that the used pairs have changed and has the geometry searched for, and the
//! latest one refitted to the moved points within a frame or two. Their news wake the window, and the next frame's
//! overlays draw the new lines.

#[cfg(test)]
mod fake;
mod inspector;
pub mod model;
mod shell;
mod tasks;
mod view;

pub use inspector::Inspector;
pub use shell::AppError;
pub use tasks::{Opening, Services};

use crate::geometry::PointPair;

/// What the window opens with.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Start {
    /// The pictures.
    pub opening: Opening,
    /// Point pairs placed on them.
    pub pairs: Vec<PointPair>,
    /// Files with point pairs or geometries to import once the pictures are open.
    pub imports: Vec<std::path::PathBuf>,
}

/// Opens the window and returns when it is closed.
pub fn run(start: Start) -> Result<(), AppError> {
    shell::run(start, Services::default())
}

/// Fonts, sizes and colours of the window, for tests that show an [`Inspector`] in a context of their own.
pub fn install_theme(ctx: &egui::Context) {
    view::theme::install(ctx);
}
