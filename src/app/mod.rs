//! The window: two images, point pairs on them, and the geometry that follows.
//!
//! | module | what it holds |
//! |---|---|
//! | [`document`] | what is edited: plain data, without a window |
//! | [`command`] | every action, with its name, tooltip and keys |
//! | `keyboard` | which commands the keys stand for |
//! | [`history`] | undo and redo |
//! | [`focus`] | what is pointed at and what is chosen, shared by all panes and panels |
//! | `computation`, [`worker`] | the estimate and the thread that computes it |
//! | `background` | a thread that answers the newest of many questions |
//! | `services` | what threads and the system do for the window; tests put something else in their place |
//! | [`comparison`] | the result beside other methods and the truth, measured in a thread |
//! | `truth` | what is known about the pictures that are open |
//! | [`rectified`] | the rectified pair: made in a thread, looked at, written |
//! | `suggesting` | the suggested match of a first click |
//! | [`look`] | what is drawn, remembered between runs |
//! | `inspection` | the intensities of the inspected line pair, matched in a third thread |
//! | `exchange` | files from and for other programs: exports, imports, and what an imported matrix means |
//! | `session` | saving what a person set, opening it again, and keeping it through a crash |
//! | `loader` | opening pictures off the window's thread |
//! | `panes` | the images: view transforms, textures, one file an overlay |
//! | `panels` | everything around them, one file each |
//! | `inspector` | the state, and the one place where commands are applied |
//! | `shell` | the program's window around it |
//!
//! # From a click to a line
//! `panes::ImagePane` turns a click into [`command::Command::Place`]; the inspector applies it to the
//! [`document::Document`] and notes it in the [`history::History`]; at the end of the frame
//! `computation::Computation::follow` sees that the used pairs have changed and hands them to the
//! [`worker::Worker`] for a search, and the latest geometry to the follower, which has it refitted to the moved
//! points within a frame or two. Their news wake the window, and the next frame's overlays draw the new lines.

mod background;
pub mod command;
pub mod comparison;
mod computation;
pub mod document;
mod exchange;
#[cfg(test)]
mod fake;
pub mod focus;
mod guide;
mod heat;
pub mod history;
mod inspection;
mod inspector;
mod keyboard;
mod loader;
pub mod look;
mod panels;
mod panes;
pub mod rectified;
mod residuals;
mod sample;
mod scene;
mod services;
mod session;
mod shell;
mod step;
mod suggesting;
mod theme;
mod truth;
mod verdict;
mod waker;
pub mod worker;

pub use inspector::Inspector;
pub use loader::Opening;
pub use services::Services;
pub use shell::AppError;

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
    run_with(start, Services::default())
}

/// [`run`] with other services in place of the estimator and the system's file dialog.
pub fn run_with(start: Start, services: Services) -> Result<(), AppError> {
    shell::run(start, services)
}

/// Fonts, sizes and colours of the window, for tests that show an [`Inspector`] in a context of their own.
pub fn install_theme(ctx: &egui::Context) {
    theme::install(ctx);
}
