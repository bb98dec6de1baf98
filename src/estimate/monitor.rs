//! Watching and stopping a computation.

use std::sync::Arc;

use serde::Serialize;

use super::{ComparedPencils, Estimate, EstimateError};
use crate::cancel::CancelFlag;

/// The steps of the algorithm in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Grey pyramids of both images.
    Pyramid,
    /// Lines through the clicks and their similarity matrices.
    Pencils,
    /// Epipole hypotheses from candidate pairs, with the forward and backward maps.
    Hypotheses,
    /// Full validation of the best ones.
    Validation,
    /// Local refinement, coarse to fine.
    Refinement,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Self; 5] =
        [Self::Pyramid, Self::Pencils, Self::Hypotheses, Self::Validation, Self::Refinement];

    /// What the user reads while it runs.
    pub fn label(self) -> &'static str {
        match self {
            Self::Pyramid => "Image pyramid",
            Self::Pencils => "Line pencils",
            Self::Hypotheses => "Epipole hypotheses",
            Self::Validation => "Validation",
            Self::Refinement => "Refinement",
        }
    }
}

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

    /// An error when a stop was asked for; long loops call it often.
    pub(crate) fn check(&self) -> Result<(), EstimateError> {
        if self.cancel.is_cancelled() { Err(EstimateError::Cancelled) } else { Ok(()) }
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.is_cancelled()
    }
}
