//! Errors of an estimate, and warnings about a result.

use super::fit::MatchFitError;
use serde::Serialize;
use thiserror::Error;

use crate::cancel::Cancelled;
use crate::motion::MotionError;

/// Reason why no fundamental matrix was estimated. `Display` states the fact;
/// [`crate::presentation::error_in_words`] also advises. Pairs and images are numbered from 1, lengths are in px.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EstimateError {
    /// Fewer point pairs than the method needs.
    #[error("{needed} point pairs are needed, {found} given")]
    TooFewPairs { found: usize, needed: usize },
    /// A coordinate of the pair of this number, from 1, is NaN or infinite.
    #[error("point pair {0} has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// A point lies outside its image.
    #[error("point ({x}, {y}) of pair {pair} lies outside image {image}, which is {width}×{height} pixels")]
    Outside { pair: usize, image: usize, x: f64, y: f64, width: usize, height: usize },
    /// Two clicks (nearly) coincide in one image.
    #[error("point pairs {first} and {second} are only {distance:.1} px apart in image {image}")]
    TooClose { first: usize, second: usize, image: usize, distance: f64 },
    /// The image is too small for lines to be compared.
    #[error("image {image} is {width}×{height} pixels, too small. At least {smallest}×{smallest} are needed")]
    TooSmall { image: usize, width: usize, height: usize, smallest: usize },
    /// The image of this number, 1 or 2, is of (nearly) one intensity.
    #[error("image {0} is (nearly) uniform")]
    Flat(usize),
    /// A parameter is out of range: its name in files, value, smallest and largest value, and unit after a space.
    #[error("parameter {key} is {value}, outside {least} to {most}{unit}", least = range[0], most = range[1])]
    Parameter { key: &'static str, value: f64, range: [f64; 2], unit: &'static str },
    /// All lines are compared, and too many changes of disparity have a cost of their own: α is more than
    /// `times` times λ.
    #[error("stereo.alpha is {alpha}, more than {times} times stereo.lambda")]
    ManyChanges { alpha: u16, times: u16 },
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

/// Warning about a result. `presentation::reasons` has the sentences. Lengths are in px.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Warning {
    /// Both clicks lie (nearly) on one epipolar line, so the epipoles are undetermined: the smaller
    /// distance of a click from the line of the other.
    SameEpipolarLine { distance: f64 },
    /// The clicks are close together, so small errors turn the lines a lot.
    CloseClicks { distance: f64 },
    /// Of the lines examined, few have texture.
    LittleTexture { pair: usize, textured: usize, lines: usize },
    /// The matches contradict the calibration of known cameras, so the geometry was fitted without it.
    CalibrationContradicted,
}
