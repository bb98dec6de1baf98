//! File dialogs of the system. They block until closed, so a thread shows them.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::services::{PickFn, SavePickFn};
use super::task::{Event, Task, Waiting};
use super::waker::Waker;
use crate::app::model::command::PickPurpose;

/// A dialog that returns sooner was not visible to anybody.
const UNSEEN: Duration = Duration::from_millis(150);

/// Outcome of a dialog.
pub enum Picked {
    /// A path was chosen.
    Path(PickPurpose, PathBuf),
    /// The user cancelled.
    Nothing,
    /// The dialog could not open.
    Unseen,
}

/// The open dialog, one at a time.
pub struct Picking(Task<PickPurpose, Picked>);

impl Picking {
    /// Starts the thread. The functions ask for a file, a folder, and a path for saving.
    pub fn new(waker: Waker, [pick_file, pick_folder]: [Arc<PickFn>; 2], pick_save: Arc<SavePickFn>) -> Self {
        Self(Task::new("file dialog", waker, Waiting::Newest, move |purpose: PickPurpose, _| {
            let start = Instant::now();
            let picked = match &purpose {
                PickPurpose::Image(_) | PickPurpose::Lost(_) | PickPurpose::Import => pick_file(),
                PickPurpose::Folder | PickPurpose::Export => pick_folder(),
                PickPurpose::Session(suggested) | PickPurpose::ExportFile(suggested) => pick_save(suggested),
            };
            Some(match picked {
                Some(path) => Picked::Path(purpose, path),
                None if start.elapsed() > UNSEEN => Picked::Nothing,
                None => Picked::Unseen,
            })
        }))
    }

    /// Shows a dialog unless one is open, and returns whether it does.
    pub fn begin(&mut self, purpose: PickPurpose) -> bool {
        let free = !self.0.is_busy();
        if free {
            self.0.ask(purpose);
        }
        free
    }

    /// Returns the outcome of the dialog, once closed.
    pub fn poll(&mut self) -> Option<Picked> {
        match self.0.poll()?.1 {
            Event::Told(picked) | Event::Over(Ok(Some(picked))) => Some(picked),
            Event::Over(_) => Some(Picked::Unseen),
        }
    }

    /// Returns whether a dialog is open.
    pub fn is_busy(&self) -> bool {
        self.0.is_busy()
    }
}
