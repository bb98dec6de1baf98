//! A thread that writes sessions, one after the other: writing to a disk may take its time.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::Work;
use crate::app::waker::Waker;
use crate::io::SessionFile;

/// Something to write.
pub enum Job {
    /// A session that a person saves.
    Save {
        /// Where.
        path: PathBuf,
        /// What.
        session: Box<SessionFile<Work>>,
    },
    /// The program's own copy.
    Autosave {
        /// Where.
        path: PathBuf,
        /// What.
        session: Box<SessionFile<Work>>,
    },
    /// The program's own copy is not needed any more.
    Remove(PathBuf),
}

/// A session that a person saved, or why it was not.
pub struct Saved {
    /// Where.
    pub path: PathBuf,
    /// What is in the file now, or a sentence.
    pub result: Result<Work, String>,
}

/// A handle to the writing thread; dropping it waits until everything is written.
pub struct Saver {
    jobs: Option<Sender<Job>>,
    news: Receiver<Saved>,
    thread: Option<std::thread::JoinHandle<()>>,
    waiting: usize,
}

impl Saver {
    /// Starts the thread; it calls `waker` after each session that a person saved.
    pub fn new(waker: Waker) -> Self {
        let (jobs, inbox) = channel::<Job>();
        let (outbox, news) = channel();
        let thread = std::thread::Builder::new().name("save".into()).spawn(move || {
            for job in inbox {
                match job {
                    Job::Save { path, session } => {
                        let result = session.write(&path).map_err(|error| error.to_string());
                        let result = result.map(|()| session.content);
                        // Nobody listens any more when the window has closed.
                        let _ = outbox.send(Saved { path, result });
                        waker.wake();
                    }
                    // A copy that cannot be written is tried again after the next change.
                    Job::Autosave { path, session } => drop(session.write(&path)),
                    Job::Remove(path) => drop(std::fs::remove_file(path)),
                }
            }
        });
        Self { jobs: Some(jobs), news, thread: thread.ok(), waiting: 0 }
    }

    /// Does a job after those before it.
    pub fn ask(&mut self, job: Job) {
        let saves = matches!(job, Job::Save { .. });
        if self.jobs.as_ref().is_some_and(|jobs| jobs.send(job).is_ok()) && saves {
            self.waiting += 1;
        }
    }

    /// A session that was saved since the last call.
    pub fn poll(&mut self) -> Option<Saved> {
        let saved = self.news.try_recv().ok()?;
        self.waiting -= 1;
        Some(saved)
    }

    /// Whether a session is being saved.
    pub fn is_busy(&self) -> bool {
        self.waiting > 0
    }
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
