//! Errors of the command line, and their exit statuses.

use epiline::internals::cli::CliError;
use thiserror::Error;

use crate::EvaluateError;

/// Exit status after Ctrl-C: 128 plus the signal number, the convention of shells.
pub(crate) const INTERRUPTED: u8 = 130;

/// Reason why a command failed. The message is shown to the user.
#[derive(Debug, Error)]
pub(crate) enum LabError {
    /// The arguments are invalid, or the output cannot be written.
    #[error(transparent)]
    Command(#[from] CliError),
    /// The evaluation failed.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// The user stopped the work. The finished trials have been written.
    #[error("stopped after {made} of {planned} trials. The report covers the finished trials")]
    Stopped {
        /// Number of finished trials.
        made: usize,
        /// Number of planned trials.
        planned: usize,
    },
}

impl LabError {
    /// Returns the exit status of the program.
    pub(crate) fn exit_status(&self) -> u8 {
        match self {
            Self::Command(error) => error.exit_status(),
            Self::Evaluate(_) => 2,
            Self::Stopped { .. } => INTERRUPTED,
        }
    }
}
