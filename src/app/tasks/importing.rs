//! Reading files of other programs, one import after the other.

use super::task::{Event, Task};
use super::waker::Waker;
use crate::app::model::exchange::{ImportFound, ImportQuestion};

/// The thread that reads.
pub struct Importing {
    task: Task<ImportQuestion, Result<ImportFound, String>>,
    /// What is being read.
    name: String,
}

impl Importing {
    /// Starts the thread.
    pub fn new(waker: Waker) -> Self {
        let task = Task::answering("import", waker, |question: ImportQuestion| Some(question.answer()));
        Self { task, name: String::new() }
    }

    /// Reads files in place of those that are being read.
    pub fn begin(&mut self, question: ImportQuestion) {
        self.name = question.pending.source.name();
        self.task.ask(question);
    }

    /// Drops what is being read: the images are others.
    pub fn forget(&mut self) {
        self.task.forget();
    }

    /// What was found in it, or what happened and what to do, once that is known.
    pub fn poll(&mut self) -> Option<Result<ImportFound, String>> {
        match self.task.poll()?.1 {
            Event::Told(answer) | Event::Over(Ok(Some(answer))) => Some(answer),
            Event::Over(_) => Some(Err(format!(
                "{} could not be imported: reading it failed. Nothing was changed.",
                self.name
            ))),
        }
    }

    /// Whether something is being read.
    pub fn is_busy(&self) -> bool {
        self.task.is_busy()
    }
}
