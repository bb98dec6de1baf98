//! A thread that writes sessions and exports in order, as disks can be slow.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use super::task::{Task, Waiting, panic_text};
use super::waker::Waker;
use crate::app::model::exchange::ExportContent;
use crate::app::model::session::Work;
use crate::io::{OutputFile, SessionFile, WriteError, refuse_clashes};

pub type SaveJob = Box<dyn FnOnce() -> Option<Written> + Send>;

pub enum Written {
    Session {
        path: PathBuf,
        /// The saved work, or the reason why it was not written.
        result: Result<Box<Work>, String>,
    },
    /// The program's own copy of unsaved work. The error says why it was not written.
    Copy(Result<(), String>),
    /// A file for other programs.
    Export {
        path: PathBuf,
        /// Description of the file, or the reason why it was not written.
        result: Result<String, String>,
    },
}

/// Starts the writing thread. Dropping the task waits until everything is written.
pub fn saver(waker: Waker) -> Task<SaveJob, Written> {
    Task::new("save", waker, Waiting::All, |job: SaveJob, _| job())
}

/// Saves a session for the user, in none of the open files `inputs`. The outcome has the saved work,
/// for telling later whether anything changed.
pub fn save(path: PathBuf, session: SessionFile<Work>, work: Work, inputs: Vec<PathBuf>) -> SaveJob {
    Box::new(move || {
        let result = apart(&path, &inputs).and_then(|()| session.write(&path));
        let result = result.map_err(|error| error.to_string()).map(|()| Box::new(work));
        Some(Written::Session { path, result })
    })
}

/// Writes the program's own copy of unsaved work.
pub fn copy(path: PathBuf, session: SessionFile<Work>) -> SaveJob {
    Box::new(move || Some(Written::Copy(session.write_private(&path).map_err(|error| error.to_string()))))
}

/// Removes the program's own copy.
pub fn remove(path: PathBuf) -> SaveJob {
    Box::new(move || {
        let _ = std::fs::remove_file(path);
        None
    })
}

/// Writes a file for other programs, in none of the open files `inputs`. `what` describes it.
pub fn export(path: PathBuf, what: String, content: ExportContent, inputs: Vec<PathBuf>) -> SaveJob {
    Box::new(move || {
        let result = apart(&path, &inputs).map_err(|error| error.to_string());
        let result = result.and_then(|()| compose(&path, content)).map(|()| what);
        Some(Written::Export { path, result })
    })
}

/// Runs the work that writes a folder or a file by itself, and returns a description of it.
pub fn export_by(path: PathBuf, work: impl FnOnce() -> Result<String, String> + Send + 'static) -> SaveJob {
    Box::new(move || {
        let result = catch_unwind(AssertUnwindSafe(work))
            .unwrap_or_else(|payload| Err(format!("writing failed ({})", panic_text(payload.as_ref()))));
        Some(Written::Export { path, result })
    })
}

/// Refuses a path that is one of the open files.
fn apart(path: &Path, inputs: &[PathBuf]) -> Result<(), WriteError> {
    refuse_clashes(&[path], &inputs.iter().map(PathBuf::as_path).collect::<Vec<_>>())
}

/// Writes a file whole or not at all. An unusable path fails before the content is composed.
fn compose(path: &Path, content: ExportContent) -> Result<(), String> {
    let output = OutputFile::prepare(path).map_err(|error| error.to_string())?;
    let content = catch_unwind(AssertUnwindSafe(content)).unwrap_or_else(|payload| {
        Err(format!("composing the file failed ({})", panic_text(payload.as_ref())))
    })?;
    output.write(&content).map_err(|error| error.to_string())
}
