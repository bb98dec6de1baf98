//! Why there is no suggestion.

use thiserror::Error;

/// Why no match was suggested. Each message is one sentence: what happened, what to do.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SuggestError {
    /// A coordinate is NaN or infinite.
    #[error("the point has a coordinate that is not a finite number")]
    NotFinite,
    /// The point lies outside its image.
    #[error("point ({x}, {y}) lies outside image {image}, which is {width}×{height} pixels")]
    Outside {
        /// 1 or 2.
        image: usize,
        /// x of the point, px.
        x: f64,
        /// y of the point, px.
        y: f64,
        /// Width of the image, px.
        width: usize,
        /// Height of the image, px.
        height: usize,
    },
    /// The image is smaller than the patches that are compared.
    #[error("image {image} is {width}×{height} pixels, too small: at least {smallest}×{smallest} are needed")]
    TooSmall {
        /// 1 or 2.
        image: usize,
        /// Width, px.
        width: usize,
        /// Height, px.
        height: usize,
        /// What is needed, px.
        smallest: usize,
    },
    /// Nothing around the point can be recognised.
    #[error("the surroundings of the point are (nearly) uniform: choose a point with texture around it")]
    Flat,
    /// The point is the epipole, where every line through the other epipole may hold the match.
    #[error("the point is the epipole of its image, so its match may lie on any epipolar line")]
    AtEpipole,
    /// The epipolar line does not cross the other image.
    #[error("the epipolar line of the point misses image {image}, so its match is not in the picture")]
    LineOutside {
        /// 1 or 2, the image the match would be in.
        image: usize,
    },
    /// No place near the point resembles its surroundings in the other image.
    #[error("nothing near the point in image {image} looks like its surroundings in the other image")]
    NotAligned {
        /// 1 or 2, the image that was searched.
        image: usize,
    },
    /// No place resembles the surroundings of the point.
    #[error("nothing in image {image} looks like the surroundings of the point")]
    NothingAlike {
        /// 1 or 2, the image that was searched.
        image: usize,
    },
}

impl SuggestError {
    /// Whether the input was refused, rather than a search that came back with nothing.
    pub fn is_bad_input(&self) -> bool {
        matches!(self, Self::NotFinite | Self::Outside { .. } | Self::TooSmall { .. })
    }
}
