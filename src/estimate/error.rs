//! Errors of an estimate, and warnings about a result.

use super::fit::MatchFitError;
use serde::Serialize;
use thiserror::Error;

use crate::cancel::Cancelled;
use crate::motion::MotionError;

/// Reason why no fundamental matrix was estimated. `Display` states the fact;
/// [`crate::presentation::error_in_words`] also advises.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EstimateError {
    /// Fewer point pairs than the method needs.
    #[error("{needed} point pairs are needed, {found} given")]
    TooFewPairs {
        /// Pairs given.
        found: usize,
        /// Pairs needed.
        needed: usize,
    },
    /// A coordinate of the pair of this number, from 1, is NaN or infinite.
    #[error("point pair {0} has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// A point lies outside its image.
    #[error("point ({x}, {y}) of pair {pair} lies outside image {image}, which is {width}×{height} pixels")]
    Outside {
        /// Number of the pair, from 1.
        pair: usize,
        /// Number of the image, 1 or 2.
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
    /// Two clicks (nearly) coincide in one image.
    #[error("point pairs {first} and {second} are only {distance:.1} px apart in image {image}")]
    TooClose {
        /// Number of the first pair, from 1.
        first: usize,
        /// Number of the second pair, from 1.
        second: usize,
        /// Number of the image, 1 or 2.
        image: usize,
        /// Distance between the clicks, px.
        distance: f64,
    },
    /// The image is too small for lines to be compared.
    #[error("image {image} is {width}×{height} pixels, too small. At least {smallest}×{smallest} are needed")]
    TooSmall {
        /// Number of the image, 1 or 2.
        image: usize,
        /// Width, px.
        width: usize,
        /// Height, px.
        height: usize,
        /// Smallest side allowed, px.
        smallest: usize,
    },
    /// The image of this number, 1 or 2, is of (nearly) one intensity.
    #[error("image {0} is (nearly) uniform")]
    Flat(usize),
    /// A parameter is out of range.
    #[error("parameter {key} is {value}, outside {least} to {most}{unit}", least = range[0], most = range[1])]
    Parameter {
        /// Name in files and on the command line.
        key: &'static str,
        /// Value given.
        value: f64,
        /// Smallest and largest value allowed.
        range: [f64; 2],
        /// Unit, with a space before it.
        unit: &'static str,
    },
    /// All lines are compared, and too many changes of disparity have a cost of their own.
    #[error("stereo.alpha is {alpha}, more than {times} times stereo.lambda")]
    ManyChanges {
        /// Largest cost of a disparity change, squared grey levels.
        alpha: u16,
        /// Largest ratio of α to λ.
        times: u16,
    },
    /// The two images are (nearly) the same picture.
    #[error("the two images are nearly identical")]
    NoParallax,
    /// No pencil lines with enough texture pass through the pair of this number, from 1.
    #[error("no textured lines pass through point pair {0}")]
    NoCandidates(usize),
    /// No hypothesis survived.
    #[error("no epipolar geometry was found")]
    NoGeometry,
    /// No hypothesis survived, and there were no clicks.
    #[error("no epipolar geometry was found without clicks")]
    NothingWithoutClicks,
    /// The geometry is asked for from given matches alone, and these agree on none.
    #[error("the given matches alone give no geometry: {0}")]
    Given(#[from] MatchFitError),
    /// Motion barcodes are asked for, but there are only pictures.
    #[error("motion barcodes need two sequences of frames, not two pictures")]
    NoSequences,
    /// The sequences cannot be compared.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// No geometry agrees with enough barcodes.
    #[error("no epipolar geometry was found from motion barcodes")]
    NothingFromBarcodes,
    /// A newer request or the user stopped the computation.
    #[error("the computation was cancelled")]
    Cancelled,
}

impl From<Cancelled> for EstimateError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl EstimateError {
    /// Returns whether the input was at fault (exit status 2) rather than the computation (exit
    /// status 1).
    pub fn is_bad_input(&self) -> bool {
        !matches!(
            self,
            Self::NoCandidates(_)
                | Self::NoGeometry
                | Self::NothingWithoutClicks
                | Self::NothingFromBarcodes
                | Self::NoParallax
                | Self::Cancelled
        )
    }
}

/// Warning about a result. `presentation::reasons` has the sentences.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Warning {
    /// Both clicks lie (nearly) on one epipolar line, so the epipoles are undetermined.
    SameEpipolarLine {
        /// Smallest distance of a click from the other's epipolar line, px.
        distance: f64,
    },
    /// The clicks are close together, so small errors turn the lines a lot.
    CloseClicks {
        /// Distance between the clicks, px.
        distance: f64,
    },
    /// Few lines have texture.
    LittleTexture {
        /// Number of the pair, from 1.
        pair: usize,
        /// Lines kept.
        textured: usize,
        /// Lines examined.
        lines: usize,
    },
}
