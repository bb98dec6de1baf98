//! Watching and stopping a computation.

use std::sync::Arc;

use super::{ComparedPencils, Estimate, Stage};
use crate::cancel::CancelFlag;

/// News from a running computation.
#[derive(Debug)]
pub enum Progress {
    /// A stage has begun.
    Started(Stage),
    /// The pencils through each anchor have been compared.
    Pencils(Vec<Arc<ComparedPencils>>),
    /// An estimate good enough to draw; better ones follow. The last one is the function's result.
    Preliminary(Box<Estimate>),
}

/// Where a computation reports to and who may stop it.
pub struct Monitor<'a> {
    cancel: CancelFlag,
    sink: Box<dyn Fn(Progress) + Sync + Send + 'a>,
}

impl<'a> Monitor<'a> {
    /// A monitor that calls `sink` with each piece of news, from whichever thread has it.
    pub fn new(cancel: CancelFlag, sink: impl Fn(Progress) + Sync + Send + 'a) -> Self {
        Self { cancel, sink: Box::new(sink) }
    }

    /// A monitor nobody watches.
    pub fn silent() -> Self {
        Self::new(CancelFlag::default(), |_| ())
    }

    pub(crate) fn report(&self, progress: Progress) {
        (self.sink)(progress);
    }

    /// What long loops ask whether to go on.
    pub(crate) fn cancel(&self) -> &CancelFlag {
        &self.cancel
    }
}
