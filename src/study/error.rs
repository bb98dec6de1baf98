//! Reasons why pictures and points do not go with their cameras.

use thiserror::Error;

/// Reason why pictures and points do not go with their cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum StudyError {
    /// A lens has no inverse at its principal point.
    #[error("the distortion of the lens cannot be undone: it folds back at the principal point")]
    FoldsBack,
    /// A clicked pair, counted from 1, lies beyond the range of a lens.
    #[error("pair {0} lies where the distortion of the lens has no inverse. Use points nearer to the middle")]
    ClickBeyondLens(usize),
    /// All matches lie beyond the range of a lens.
    #[error("all matches lie where the distortion of the lens has no inverse")]
    MatchesBeyondLens,
    /// Neither a geometry nor the cameras tell the pose.
    #[error("the calibration does not tell where the second camera is")]
    NoPose,
    /// A focal length is unknown.
    #[error("a pose needs the focal lengths")]
    NoFocalLengths,
    /// Four poses fit a matrix, and only matches tell which one is right.
    #[error("without matches, F does not tell which camera is the left one")]
    NoMatches,
}
