//! A thread that writes sessions and exports, one after the other: writing to a disk may take its time.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::task::{Event, Task, Waiting, panic_text};
use super::waker::Waker;
use crate::app::model::exchange::ExportContent;
use crate::app::model::session::Work;
use crate::io::{OutputFile, SessionFile, WriteError, refuse_clashes};

/// How long the window waits for a disk.
const PATIENCE: Duration = Duration::from_secs(3);

/// Something to write.
pub enum SaveJob {
    /// A session that a person saves.
    Save {
        /// Where.
        path: PathBuf,
        /// What.
        session: Box<SessionFile<Work>>,
        /// The same as the window has it: what is compared with to tell whether something has changed since.
        work: Box<Work>,
        /// Files that are open, which it must not replace.
        inputs: Vec<PathBuf>,
    },
    /// The program's own copy.
    Autosave {
        /// Where.
        path: PathBuf,
        /// What.
        session: Box<SessionFile<Work>>,
    },
    /// A file for other programs.
    Export {
        /// Where.
        path: PathBuf,
        /// What it is, in a few words.
        what: String,
        /// Composes it.
        content: ExportContent,
        /// Files that are open, which it must not replace.
        inputs: Vec<PathBuf>,
    },
    /// The program's own copy is not needed any more.
    Remove(PathBuf),
}

/// What became of something that a person had written.
pub enum Written {
    /// A session.
    Session {
        /// Where.
        path: PathBuf,
        /// What was saved, or why it was not written.
        result: Result<Box<Work>, String>,
    },
    /// The program's own copy of unsaved work; why it was not written, if so.
    Copy(Result<(), String>),
    /// A file for other programs.
    Export {
        /// Where.
        path: PathBuf,
        /// What it is, or why it was not written.
        result: Result<String, String>,
    },
}

/// A handle to the writing thread; dropping it waits until everything is written.
pub struct Saver(Task<SaveJob, Written>);

impl Saver {
    /// Starts the thread; it calls `waker` after each file.
    pub fn new(waker: Waker) -> Self {
        Self(Task::new("save", waker, Waiting::All, |job, _| match job {
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
        }))
    }

    /// Does a job after those before it.
    pub fn ask(&mut self, job: SaveJob) {
        self.0.ask(job);
    }

    /// What was written since the last call.
    pub fn poll(&mut self) -> Option<Written> {
        while let Some((_, event)) = self.0.poll() {
            if let Event::Told(written) | Event::Over(Ok(Some(written))) = event {
                return Some(written);
            }
        }
        None
    }

    /// Waits until everything asked for is written, but not for ever.
    pub fn finish(&self) {
        // A disk that takes longer is not worth a window that stands still.
        self.0.wait(PATIENCE);
    }

    /// Whether something is not written yet.
    pub fn is_busy(&self) -> bool {
        self.0.is_busy()
    }
}

/// Whether a file is none of those that are open.
fn apart(path: &Path, inputs: &[PathBuf]) -> Result<(), WriteError> {
    refuse_clashes(&[path], &inputs.iter().map(PathBuf::as_path).collect::<Vec<_>>())
}

/// Writes a file whole or not at all; the place is tried before the content is composed.
fn export(path: &Path, content: ExportContent) -> Result<(), String> {
    let output = OutputFile::prepare(path).map_err(|error| error.to_string())?;
    let content = catch_unwind(AssertUnwindSafe(content))
        .unwrap_or_else(|payload| Err(format!("composing it failed ({})", panic_text(payload.as_ref()))))?;
    output.write(&content).map_err(|error| error.to_string())
}
