//! Progress reports and cancellation of a computation.

use std::sync::Arc;

use super::{ComparedPencils, Estimate, Event};
use crate::cancel::CancelFlag;

/// Progress of a running computation.
#[derive(Debug)]
pub enum Progress {
    /// Something that the record of the search has now, too: a stage began, geometries were proposed, and so on.
    Happened(Event),
    /// The pencils through each anchor have been compared.
    Pencils(Vec<Arc<ComparedPencils>>),
    /// An estimate good enough to draw; better ones follow. The last one is the function's result.
    Preliminary(Box<Estimate>),
}

/// Receiver of progress reports, with the flag that stops the computation.
pub struct Monitor<'a> {
    cancel: CancelFlag,
    sink: Box<dyn Fn(Progress) + Sync + Send + 'a>,
}

impl<'a> Monitor<'a> {
    /// Creates a monitor that calls `sink` with each report, from any thread.
    pub fn new(cancel: CancelFlag, sink: impl Fn(Progress) + Sync + Send + 'a) -> Self {
        Self { cancel, sink: Box::new(sink) }
    }

    /// Creates a monitor that ignores all reports.
    pub fn silent() -> Self {
        Self::new(CancelFlag::default(), |_| ())
    }

    pub(crate) fn report(&self, progress: Progress) {
        (self.sink)(progress);
    }

    /// Returns the flag that long loops check.
    pub fn cancel(&self) -> &CancelFlag {
        &self.cancel
    }
}
