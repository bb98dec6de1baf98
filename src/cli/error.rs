//! Everything that can end a command, and its exit status.

use thiserror::Error;

use crate::convention::CheckError;
use crate::estimate::EstimateError;
use crate::evaluate::EvaluateError;
use crate::image::LoadError;
use crate::io::{ReadError, RectifiedError, SequenceError, WriteError};
use crate::motion::MotionError;
use crate::rectify::RectifyError;
use crate::suggest::SuggestError;

/// Exit status of an error in the program itself (`EX_SOFTWARE` of `sysexits.h`).
pub const INTERNAL_ERROR: u8 = 70;

/// Exit status after Ctrl-C: 128 and the number of the signal, as shells have it.
pub(super) const INTERRUPTED: u8 = 130;

/// Why a command did not succeed. Each message is one sentence for the user.
#[derive(Debug, Error)]
pub enum CliError {
    /// An image could not be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The estimator refused the input or found nothing.
    #[error(transparent)]
    Estimate(#[from] EstimateError),
    /// A sequence of frames could not be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// A sequence has nothing that can be compared.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Nothing could be evaluated.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// No place could be suggested.
    #[error(transparent)]
    Suggest(#[from] SuggestError),
    /// The convention of a matrix could not be checked.
    #[error(transparent)]
    Check(#[from] CheckError),
    /// The matrix fits the matches in no convention.
    #[error("{0}")]
    NothingFits(String),
    /// The pair cannot be rectified.
    #[error(transparent)]
    Rectify(#[from] RectifyError),
    /// A rectified pair could not be written.
    #[error(transparent)]
    Export(#[from] RectifiedError),
    /// A file other than an image could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A result could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A folder for results could not be made.
    #[error("cannot make the folder {path}: {reason}")]
    Folder {
        /// The folder.
        path: String,
        /// Why.
        reason: String,
    },
    /// Standard output is full or broken (a closed one is no error).
    #[error("cannot write to standard output: {0}")]
    StandardOutput(String),
    /// Arguments that do not go together.
    #[error("{0}")]
    Arguments(String),
    /// The user stopped the work; what was finished by then has been written.
    #[error("stopped after {made} of {planned} trials, which are in the report")]
    Stopped {
        /// Trials finished.
        made: usize,
        /// Trials asked for.
        planned: usize,
    },
    /// The window could not be opened.
    #[error("{0}")]
    Window(String),
}

impl CliError {
    /// What the program returns to the shell.
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::Estimate(error) if !error.is_bad_input() => 1,
            Self::Suggest(error) if !error.is_bad_input() => 1,
            Self::NothingFits(_) => 1,
            Self::Rectify(error) if !error.is_bad_input() => 1,
            Self::Stopped { .. } => INTERRUPTED,
            _ => 2,
        }
    }
}
