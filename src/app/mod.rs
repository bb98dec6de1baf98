//! The window: two images, point pairs on them, and their epipolar geometry.
//!
//! | module | contents |
//! |---|---|
//! | [`model`] | state: plain data, testable without a window |
//! | `tasks` | work outside the thread of the window |
//! | `view` | appearance, and the commands a person can give |
//! | `inspector` | holds the three above and applies the commands |
//! | `shell` | the native window of the program |
//!
//! # From a click to a line
//! `view::panes::ImagePane` turns a click into [`model::command::Command::Place`]. The inspector
//! applies the command to the [`model::document::Document`] and records the step in the
//! [`model::history::History`]. At the end of the frame, `tasks::Estimating::follow` notices that
//! the used pairs changed. It starts a search, and refits the latest geometry to the moved points
//! within a frame or two. Results wake the window, and the overlays of the next frame draw the new
//! lines.

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

/// Contents of the window at the start.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Start {
    pub opening: Opening,
    /// Point pairs to place on the pictures.
    pub pairs: Vec<PointPair>,
    /// Files with point pairs or geometries to import once the pictures are open.
    pub imports: Vec<std::path::PathBuf>,
}

/// Opens the window and returns when the user closes the window.
pub fn run(start: Start) -> Result<(), AppError> {
    shell::run(start, Services::default())
}

/// Installs fonts, sizes and colours, for tests that show an [`Inspector`] in their own context.
pub fn install_theme(ctx: &egui::Context) {
    view::theme::install(ctx);
}
