//! Why a pair cannot be rectified.

use thiserror::Error;

/// Why there is no rectified pair. Each message is one sentence for the user.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum RectifyError {
    /// An epipole lies in an image.
    #[error(
        "planar rectification is impossible, because the epipole lies inside image {image}: use the polar method"
    )]
    EpipoleInside {
        /// 1 or 2.
        image: usize,
    },
    /// No plane serves both images.
    #[error(
        "planar rectification is impossible, because every pair of corresponding epipolar lines crosses one of the \
         images: use the polar method"
    )]
    NoCommonPlane,
    /// No epipolar line is seen by both images.
    #[error("no epipolar line crosses both images, so F does not belong to these images or is wrong")]
    NoCommonLines,
    /// An image has fewer than two pixels across or down.
    #[error("image {image} is too small to be rectified, it needs at least 2 x 2 pixels")]
    TooSmall {
        /// 1 or 2.
        image: usize,
    },
    /// The limit leaves nothing.
    #[error("the limit of {limit} pixels for a rectified image is too small")]
    Limit {
        /// The limit.
        limit: usize,
    },
}

impl RectifyError {
    /// Whether the request cannot be met by any F.
    pub fn is_bad_input(&self) -> bool {
        matches!(self, Self::TooSmall { .. } | Self::Limit { .. })
    }
}
