//! A thread that writes sessions and exports, one after the other: writing to a disk may take its time.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use super::Work;
use crate::app::exchange::Content;
use crate::app::waker::Waker;
use crate::app::worker::panic_text;
use crate::io::{OutputFile, SessionFile};

/// How long the window waits for a disk.
const PATIENCE: Duration = Duration::from_secs(3);

/// Something to write.
pub enum Job {
    /// A session that a person saves.
    Save {
        /// Where.
        path: PathBuf,
        /// What.
        session: Box<SessionFile<Work>>,
        /// The same as the window has it: what is compared with to tell whether something has changed since.
        work: Box<Work>,
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
        content: Content,
    },
    /// The program's own copy is not needed any more.
    Remove(PathBuf),
    /// Say when everything before is done.
    Answer(Sender<()>),
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
    /// A file for other programs.
    Export {
        /// Where.
        path: PathBuf,
        /// What it is, or why it was not written.
        result: Result<String, String>,
    },
}

/// A handle to the writing thread; dropping it waits until everything is written.
pub struct Saver {
    jobs: Option<Sender<Job>>,
    news: Receiver<Written>,
    thread: Option<std::thread::JoinHandle<()>>,
    waiting: usize,
}

impl Saver {
    /// Starts the thread; it calls `waker` after each file that a person had written.
    pub fn new(waker: Waker) -> Self {
        let (jobs, inbox) = channel::<Job>();
        let (outbox, news) = channel();
        let thread = std::thread::Builder::new().name("save".into()).spawn(move || {
            for job in inbox {
                match job {
                    Job::Save { path, session, work } => {
                        let result = session.write(&path).map_err(|error| error.to_string());
                        let result = result.map(|()| work);
                        // Nobody listens any more when the window has closed.
                        let _ = outbox.send(Written::Session { path, result });
                        waker.wake();
                    }
                    Job::Export { path, what, content } => {
                        let result = export(&path, content).map(|()| what);
                        let _ = outbox.send(Written::Export { path, result });
                        waker.wake();
                    }
                    // A copy that cannot be written is tried again after the next change.
                    Job::Autosave { path, session } => drop(session.write(&path)),
                    // Who asked may have given up waiting.
                    Job::Answer(done) => drop(done.send(())),
                    Job::Remove(path) => drop(std::fs::remove_file(path)),
                }
            }
        });
        Self { jobs: Some(jobs), news, thread: thread.ok(), waiting: 0 }
    }

    /// Does a job after those before it.
    pub fn ask(&mut self, job: Job) {
        let saves = matches!(job, Job::Save { .. } | Job::Export { .. });
        if self.jobs.as_ref().is_some_and(|jobs| jobs.send(job).is_ok()) && saves {
            self.waiting += 1;
        }
    }

    /// What was written since the last call.
    pub fn poll(&mut self) -> Option<Written> {
        let written = self.news.try_recv().ok()?;
        self.waiting -= 1;
        Some(written)
    }

    /// Waits until everything asked for is written, but not for ever.
    pub fn finish(&mut self) {
        let (done, answer) = channel();
        self.ask(Job::Answer(done));
        // A disk that takes longer is not worth a window that stands still.
        let _ = answer.recv_timeout(PATIENCE);
    }

    /// Whether something that a person wants written is not yet.
    pub fn is_busy(&self) -> bool {
        self.waiting > 0
    }
}

/// Writes a file whole or not at all; the place is tried before the content is composed.
fn export(path: &Path, content: Content) -> Result<(), String> {
    let output = OutputFile::prepare(path).map_err(|error| error.to_string())?;
    let content = catch_unwind(AssertUnwindSafe(content))
        .unwrap_or_else(|payload| Err(format!("composing it failed ({})", panic_text(payload.as_ref()))))?;
    output.write(&content).map_err(|error| error.to_string())
}

impl Drop for Saver {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // A panic in it has been reported already.
            let _ = thread.join();
        }
    }
}
