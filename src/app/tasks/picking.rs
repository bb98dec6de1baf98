//! The system's file dialogs, which return only when they are closed.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::services::{PickFn, SavePickFn};
use super::task::{Event, Task, Waiting};
use super::waker::Waker;
use crate::app::model::command::PickPurpose;

/// A dialog that returns sooner than this cannot have been seen by anybody.
const UNSEEN: Duration = Duration::from_millis(150);

/// What became of a dialog.
pub enum Picked {
    /// Something was chosen.
    Path(PickPurpose, PathBuf),
    /// Nothing was.
    Nothing,
    /// The dialog could not be opened here.
    Unseen,
}

/// The dialog that is open, if any: one at a time.
pub struct Picking(Task<PickPurpose, Picked>);

impl Picking {
    /// Starts the thread. The dialogs are those for a file, for a folder, and for where to save.
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

    /// Shows a dialog, unless one is open; says whether it does.
    pub fn begin(&mut self, purpose: PickPurpose) -> bool {
        let free = !self.0.is_busy();
        if free {
            self.0.ask(purpose);
        }
        free
    }

    /// What became of the dialog, once it is closed.
    pub fn poll(&mut self) -> Option<Picked> {
        match self.0.poll()?.1 {
            Event::Told(picked) | Event::Over(Ok(Some(picked))) => Some(picked),
            Event::Over(_) => Some(Picked::Unseen),
        }
    }

    /// Whether a dialog is open.
    pub fn is_busy(&self) -> bool {
        self.0.is_busy()
    }
}
