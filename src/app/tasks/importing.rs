//! Reads files of other programs, one import after the other.

use super::task::{Event, Task};
use super::waker::Waker;
use crate::app::model::exchange::{ImportQuestion, ImportedFile};

/// The reading thread.
pub struct Importing {
    task: Task<ImportQuestion, Result<ImportedFile, String>>,
    /// Name of the files being read.
    name: String,
}

impl Importing {
    /// Starts the thread.
    pub fn new(waker: Waker) -> Self {
        let task = Task::answering("import", waker, |question: ImportQuestion| Some(question.answer()));
        Self { task, name: String::new() }
    }

    /// Reads files in the thread.
    pub fn begin(&mut self, question: ImportQuestion) {
        self.name = question.pending.source.name();
        self.task.ask(question);
    }

    /// Cancels the import, because other images were opened.
    pub fn forget(&mut self) {
        self.task.forget();
    }

    /// Returns the contents of the files or a message, once reading has ended.
    pub fn poll(&mut self) -> Option<Result<ImportedFile, String>> {
        match self.task.poll()?.1 {
            Event::Told(answer) | Event::Over(Ok(Some(answer))) => Some(answer),
            Event::Over(_) => Some(Err(format!(
                "{} could not be imported, because reading it failed. Nothing was changed.",
                self.name
            ))),
        }
    }

    /// Returns whether an import is running.
    pub fn is_busy(&self) -> bool {
        self.task.is_busy()
    }
}
