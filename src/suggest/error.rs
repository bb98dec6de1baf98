//! Errors of a suggestion.

use thiserror::Error;

use crate::geometry::image_in_words;

/// Reason why no match was suggested. The message is shown to the user.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SuggestError {
    /// A coordinate is NaN or infinite.
    #[error("the point has a coordinate that is not a finite number")]
    NotFinite,
    /// The point lies outside its image.
    #[error("point ({x}, {y}) lies outside {side}, which is {width}×{height} pixels", side = image_in_words(*image))]
    Outside { image: usize, x: f64, y: f64, width: usize, height: usize },
    /// The image is smaller than the compared patches.
    #[error(
        "{side} is too small: {width}×{height} pixels, at least {smallest}×{smallest} are needed",
        side = image_in_words(*image)
    )]
    TooSmall { image: usize, width: usize, height: usize, smallest: usize },
    /// The surroundings of the point have too little contrast.
    #[error("the surroundings of the point are nearly uniform. Choose a point with texture around it")]
    Flat,
    /// The point is the epipole, so every epipolar line may hold the match.
    #[error(
        "the point is the epipole of its image, so its match may lie on any epipolar line. Choose a point away from the epipole"
    )]
    AtEpipole,
    /// The epipolar line does not cross the other image, of this number.
    #[error("the epipolar line of the point misses {}, so the match is not visible there", image_in_words(*.0))]
    LineOutside(usize),
    /// No place near the given point, in the image of this number, resembles the surroundings of its match.
    #[error(
        "no place near the point in {} looks like the surroundings of its match in the other image",
        image_in_words(*.0)
    )]
    NotAligned(usize),
    /// No place in the image of this number resembles the surroundings of the point.
    #[error("no place in {} looks like the surroundings of the point", image_in_words(*.0))]
    NothingAlike(usize),
}

impl SuggestError {
    /// Returns whether the input was invalid; otherwise the search found nothing.
    pub fn is_bad_input(&self) -> bool {
        matches!(self, Self::NotFinite | Self::Outside { .. } | Self::TooSmall { .. })
    }
}
