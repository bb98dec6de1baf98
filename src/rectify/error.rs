//! Errors of rectification.

use thiserror::Error;

use crate::geometry::image_in_words;

/// Reason why a pair cannot be rectified. The message is shown to the user.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RectifyError {
    /// An epipole lies inside the image of this number, 1 or 2.
    #[error(
        "the epipole lies inside {}. Planar rectification is impossible: use the polar method",
        image_in_words(*.0)
    )]
    EpipoleInside(usize),
    /// Every pair of corresponding epipolar lines crosses one of the images.
    #[error(
        "every pair of corresponding epipolar lines crosses one of the images. Planar rectification is impossible: \
         use the polar method"
    )]
    NoCommonPlane,
    /// One camera stands nearly in front of the other.
    #[error(
        "one camera stands nearly in front of the other, so parallel cameras would see nothing. Rectify without \
         --for: the polar method has no such limit"
    )]
    Forward,
    /// No epipolar line crosses both images.
    #[error("no epipolar line crosses both images. F is wrong or belongs to other images")]
    NoCommonLines,
    /// The image of this number, 1 or 2, has fewer than two pixels across or down.
    #[error("{} is too small: rectification needs at least 2 x 2 pixels", image_in_words(*.0))]
    TooSmall(usize),
    /// The limit, in pixels, leaves no room for a picture.
    #[error("the limit of {0} pixels for a rectified image is too small. Raise the limit")]
    Limit(usize),
}

impl RectifyError {
    /// Returns whether the request is invalid for every F.
    pub fn is_bad_input(&self) -> bool {
        matches!(self, Self::TooSmall(_) | Self::Limit(_))
    }
}
