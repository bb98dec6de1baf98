//! A thread that writes sessions and exports in order, as disks can be slow.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use super::task::{Task, Waiting, panic_text};
use super::waker::Waker;
use crate::app::model::exchange::ExportContent;
use crate::app::model::session::Work;
use crate::io::{OutputFile, SessionFile, WriteError, refuse_clashes};

/// A job of the writing thread.
pub enum SaveJob {
    /// Save a session for the user.
    Save {
        /// Path of the session.
        path: PathBuf,
        /// Contents of the file.
        session: Box<SessionFile<Work>>,
        /// The saved work, for telling later whether anything changed.
        work: Box<Work>,
        /// Open files that must not be replaced.
        inputs: Vec<PathBuf>,
    },
    /// Write the program's own copy of unsaved work.
    Autosave {
        /// Path of the copy.
        path: PathBuf,
        /// Contents of the copy.
        session: Box<SessionFile<Work>>,
    },
    /// Write a file for other programs.
    Export {
        /// Path of the file.
        path: PathBuf,
        /// Short description of the file.
        what: String,
        /// Composer of the contents.
        content: ExportContent,
        /// Open files that must not be replaced.
        inputs: Vec<PathBuf>,
    },
    /// Remove the program's own copy.
    Remove(PathBuf),
}

/// Outcome of a job.
pub enum Written {
    /// A session.
    Session {
        /// Path of the session.
        path: PathBuf,
        /// The saved work, or the reason why it was not written.
        result: Result<Box<Work>, String>,
    },
    /// The program's own copy of unsaved work. The error says why it was not written.
    Copy(Result<(), String>),
    /// A file for other programs.
    Export {
        /// Path of the file.
        path: PathBuf,
        /// Description of the file, or the reason why it was not written.
        result: Result<String, String>,
    },
}

/// Starts the writing thread. Dropping the task waits until everything is written.
pub fn saver(waker: Waker) -> Task<SaveJob, Written> {
    Task::new("save", waker, Waiting::All, |job, _| match job {
        SaveJob::Save { path, session, work, inputs } => {
            let result = apart(&path, &inputs).and_then(|()| session.write(&path));
            let result = result.map_err(|error| error.to_string()).map(|()| work);
            Some(Written::Session { path, result })
        }
        SaveJob::Export { path, what, content, inputs } => {
            let result = apart(&path, &inputs).map_err(|error| error.to_string());
            let result = result.and_then(|()| export(&path, content)).map(|()| what);
            Some(Written::Export { path, result })
        }
        SaveJob::Autosave { path, session } => {
            Some(Written::Copy(session.write_private(&path).map_err(|error| error.to_string())))
        }
        SaveJob::Remove(path) => {
            let _ = std::fs::remove_file(path);
            None
        }
    })
}

/// Refuses a path that is one of the open files.
fn apart(path: &Path, inputs: &[PathBuf]) -> Result<(), WriteError> {
    refuse_clashes(&[path], &inputs.iter().map(PathBuf::as_path).collect::<Vec<_>>())
}

/// Writes a file whole or not at all. An unusable path fails before the content is composed.
fn export(path: &Path, content: ExportContent) -> Result<(), String> {
    let output = OutputFile::prepare(path).map_err(|error| error.to_string())?;
    let content = catch_unwind(AssertUnwindSafe(content)).unwrap_or_else(|payload| {
        Err(format!("composing the file failed ({})", panic_text(payload.as_ref())))
    })?;
    output.write(&content).map_err(|error| error.to_string())
}
