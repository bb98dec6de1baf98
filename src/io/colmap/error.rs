//! Errors of databases of COLMAP.

use std::path::Path;

use thiserror::Error;

use super::super::output::WriteError;
use super::super::read::ReadError;

/// Reason why a pair cannot go to COLMAP, one sentence.
#[derive(Debug, Error)]
pub enum ColmapError {
    /// The database or the result cannot be used.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The names of the images do not tell two images of the database.
    #[error(transparent)]
    Names(ReadError),
    /// The output cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Problem with the images of a database, one clause.
pub(super) enum ImageProblem {
    Names(String),
    Other(String),
}

impl ImageProblem {
    /// Adds the name of the database.
    pub(super) fn of(self, database: &Path) -> ColmapError {
        match self {
            Self::Names(problem) => ColmapError::Names(ReadError::content(database, problem)),
            Self::Other(problem) => ReadError::content(database, problem).into(),
        }
    }
}

impl From<String> for ImageProblem {
    fn from(problem: String) -> Self {
        Self::Other(problem)
    }
}
