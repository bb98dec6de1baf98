//! Errors of the command line, and their exit statuses.

use thiserror::Error;

use crate::convention::CheckError;
use crate::estimate::{EstimateError, PointsError};
use crate::image::LoadError;
use crate::io::{ColmapError, ReadError, RectifiedError, SequenceError, WriteError};
use crate::motion::MotionError;
use crate::presentation::error_in_words;
use crate::rectify::RectifyError;
use crate::study::StudyError;
use crate::suggest::SuggestError;

/// Exit status of an error in the program itself (`EX_SOFTWARE` of `sysexits.h`).
pub(super) const INTERNAL_ERROR: u8 = 70;

/// Reason why a command failed. The message is shown to the user.
#[derive(Debug, Error)]
pub enum CliError {
    /// An image cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The estimator refused the input or found nothing.
    #[error("{}", error_in_words(.0))]
    Estimate(#[from] EstimateError),
    /// Points without pictures give no geometry.
    #[error(transparent)]
    Points(#[from] PointsError),
    /// Pictures or points do not go with their cameras.
    #[error("{}", study_in_words(*.0))]
    Study(#[from] StudyError),
    /// A sequence of frames cannot be read.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// A sequence has no usable motion.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// No match was suggested.
    #[error(transparent)]
    Suggest(#[from] SuggestError),
    /// The convention of a matrix cannot be checked.
    #[error(transparent)]
    Check(#[from] CheckError),
    /// No convention of the matrix fits the matches.
    #[error("{0}")]
    NothingFits(String),
    /// A judged geometry does not fit the images. The judgement has been printed.
    #[error("the geometry does not fit the images")]
    DoesNotFit,
    /// A judged pair is not rectified. The judgement has been printed.
    #[error("the images are not rectified")]
    NotRectified,
    /// The images do not show enough to judge a geometry. The judgement has been printed.
    #[error("the images do not show enough to judge the geometry")]
    Undecided,
    /// The images do not show enough to judge whether they are rectified. The judgement has been printed.
    #[error("the images do not show enough to judge whether they are rectified")]
    RowsUndecided,
    /// A result without depth has no scene points to export. The result has been printed.
    #[error("the epipole is not determined, so there are no scene points. Export F instead, to a .json file")]
    NoDepth,
    /// The pair cannot be rectified.
    #[error(transparent)]
    Rectify(#[from] RectifyError),
    /// A rectified pair cannot be written.
    #[error(transparent)]
    Export(#[from] RectifiedError),
    /// A file other than an image cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A pair cannot be added to a database of COLMAP.
    #[error("{}", colmap_in_words(.0))]
    Colmap(#[from] ColmapError),
    /// A result cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Standard output is full or broken. A closed pipe is not an error.
    #[error("cannot write to standard output: {0}")]
    StandardOutput(String),
    /// The arguments are invalid together.
    #[error("{0}")]
    Arguments(String),
    /// The window cannot be opened.
    #[error("{0}")]
    Window(String),
}

/// Returns the message of an error, with the option that helps.
fn colmap_in_words(error: &ColmapError) -> String {
    match error {
        ColmapError::Names(_) => format!("{error}. Name both images with their folders (--names)"),
        ColmapError::Read(_) | ColmapError::Write(_) => error.to_string(),
    }
}

/// Returns the message of an error, with the options that help.
fn study_in_words(error: StudyError) -> String {
    let advice = match error {
        StudyError::NoPose => ". Give a fundamental matrix (--fundamental)",
        StudyError::NoFocalLengths => ". Give both (--focal-length)",
        StudyError::NoMatches => ". Give matches (--matches)",
        StudyError::FoldsBack | StudyError::ClickBeyondLens(_) | StudyError::MatchesBeyondLens => "",
    };
    format!("{error}{advice}")
}

impl CliError {
    /// Returns the exit status of the program.
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::Estimate(error) if !error.is_bad_input() => 1,
            Self::Suggest(error) if !error.is_bad_input() => 1,
            Self::NothingFits(_) | Self::DoesNotFit | Self::NotRectified | Self::NoDepth => 1,
            Self::Rectify(error) if !error.is_bad_input() => 1,
            _ => 2,
        }
    }
}
