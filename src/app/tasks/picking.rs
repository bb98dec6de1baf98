//! File dialogs of the system. They block until closed, so a thread shows them.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::services::{PickFn, SavePickFn};
use super::task::Task;
use super::waker::Waker;
use crate::app::model::command::PickPurpose;

/// A dialog that returns sooner was not visible to anybody.
const UNSEEN: Duration = Duration::from_millis(150);

pub enum Picked {
    Path(PickPurpose, PathBuf),
    Nothing,
    /// The dialog could not open.
    Unseen(PickPurpose),
}

/// Starts the thread. The functions ask for a file, a folder, and a path for saving.
pub fn picking(
    waker: Waker,
    [pick_file, pick_folder]: [Arc<PickFn>; 2],
    pick_save: Arc<SavePickFn>,
) -> Task<PickPurpose, Picked> {
    Task::answering("file dialog", waker, move |purpose: PickPurpose| {
        let start = Instant::now();
        let picked = match &purpose {
            PickPurpose::Image(_) | PickPurpose::Lost(_) | PickPurpose::Import | PickPurpose::Database => {
                pick_file()
            }
            PickPurpose::Folder | PickPurpose::Export => pick_folder(),
            PickPurpose::Session(suggested) | PickPurpose::ExportFile(suggested) => pick_save(suggested),
        };
        Some(match picked {
            Some(path) => Picked::Path(purpose, path),
            None if start.elapsed() > UNSEEN => Picked::Nothing,
            None => Picked::Unseen(purpose),
        })
    })
}
