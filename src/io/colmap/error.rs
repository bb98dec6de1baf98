//! Errors of databases of COLMAP.

use thiserror::Error;

use super::super::output::WriteError;
use super::super::read::ReadError;

/// Reason why a pair cannot go to COLMAP, one sentence.
#[derive(Debug, Error)]
pub enum ColmapError {
    /// The database or the result cannot be used.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The output cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
