//! Errors of an estimate, and warnings about a result.

use std::fmt;

use serde::Serialize;

use super::fit::MatchFitError;
use crate::cancel::Cancelled;
use crate::geometry::image_in_words;
use crate::motion::MotionError;

/// Reason why no fundamental matrix was estimated. [`fact`](Self::fact) and `Display` state the fact;
/// [`crate::presentation::error_in_words`] also advises. Pairs and images are numbered from 1, lengths are in px.
#[derive(Debug, Clone, PartialEq)]
pub enum EstimateError {
    /// Fewer point pairs than the method needs.
    TooFewPairs { found: usize, needed: usize },
    /// A coordinate of the pair of this number, from 1, is NaN or infinite.
    NotFinite(usize),
    /// A point lies outside its image.
    Outside { pair: usize, image: usize, x: f64, y: f64, width: usize, height: usize },
    /// Two clicks (nearly) coincide in one image.
    TooClose { first: usize, second: usize, image: usize, distance: f64 },
    /// The image is too small for lines to be compared.
    TooSmall { image: usize, width: usize, height: usize, smallest: usize },
    /// The image of this number, 1 or 2, is of (nearly) one intensity.
    Flat(usize),
    /// A parameter is out of range: its name in files, value, smallest and largest value, and unit after a space.
    Parameter { key: &'static str, value: f64, range: [f64; 2], unit: &'static str },
    /// All lines are compared, and too many changes of disparity have a cost of their own: α is more than
    /// `times` times λ.
    ManyChanges { alpha: u16, times: u16 },
    /// The two images are (nearly) the same picture.
    NoParallax,
    /// No pencil lines with enough texture pass through the pair of this number, from 1.
    NoCandidates(usize),
    /// No hypothesis survived.
    NoGeometry,
    /// No hypothesis survived, and there were no clicks.
    NothingWithoutClicks,
    /// The geometry is asked for from given matches alone, and these agree on none.
    Given(MatchFitError),
    /// Motion barcodes are asked for, but there are only pictures.
    NoSequences,
    /// The sequences cannot be compared.
    Motion(MotionError),
    /// No geometry agrees with enough barcodes.
    NothingFromBarcodes,
    /// A newer request or the user stopped the computation.
    Cancelled,
}

/// Names of clicked pairs in sentences. The estimator numbers the pairs of a question from 1; a caller that shows them by
/// other names tells these.
pub trait PairNames {
    /// Returns the name of a pair.
    fn name(&self, pair: usize) -> String;

    /// Returns how far a pair is off its epipolar line, with the unit, from its Sampson distance.
    fn off_line(&self, pair: usize, distance: f64) -> String {
        let _ = pair;
        format!("{distance:.1} px")
    }
}

/// The numbers of the pairs as their names.
#[derive(Debug, Clone, Copy)]
pub struct PairNumbers;

impl PairNames for PairNumbers {
    fn name(&self, pair: usize) -> String {
        pair.to_string()
    }
}

impl EstimateError {
    /// States the fact, with names of pairs.
    pub fn fact(&self, names: &dyn PairNames) -> String {
        let image = |number: &usize| image_in_words(*number);
        match self {
            Self::TooFewPairs { found, needed } => format!("{needed} point pairs are needed, {found} given"),
            Self::NotFinite(pair) => {
                format!("point pair {} has a coordinate that is not a finite number", names.name(*pair))
            }
            Self::Outside { pair, image: number, x, y, width, height } => format!(
                "point ({x}, {y}) of pair {} lies outside {}, which is {width}×{height} pixels",
                names.name(*pair),
                image(number)
            ),
            Self::TooClose { first, second, image: number, distance } => format!(
                "point pairs {} and {} are only {distance:.1} px apart in {}",
                names.name(*first),
                names.name(*second),
                image(number)
            ),
            Self::TooSmall { image: number, width, height, smallest } => format!(
                "{} is {width}×{height} pixels, too small. At least {smallest}×{smallest} are needed",
                image(number)
            ),
            Self::Flat(number) => format!("{} is (nearly) uniform", image(number)),
            Self::Parameter { key, value, range: [least, most], unit } => {
                format!("parameter {key} is {value}, outside {least} to {most}{unit}")
            }
            Self::ManyChanges { alpha, times } => {
                format!("stereo.alpha is {alpha}, more than {times} times stereo.lambda")
            }
            Self::NoParallax => "the two images are nearly identical".into(),
            Self::NoCandidates(pair) => {
                format!("no textured lines pass through point pair {}", names.name(*pair))
            }
            Self::NoGeometry => "no epipolar geometry was found".into(),
            Self::NothingWithoutClicks => "no epipolar geometry was found without clicks".into(),
            Self::Given(error) => format!("the given matches alone give no geometry: {error}"),
            Self::NoSequences => "motion barcodes need two sequences of frames, not two pictures".into(),
            Self::Motion(error) => error.to_string(),
            Self::NothingFromBarcodes => "no epipolar geometry was found from motion barcodes".into(),
            Self::Cancelled => "the computation was cancelled".into(),
        }
    }
}

impl fmt::Display for EstimateError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.fact(&PairNumbers))
    }
}

impl std::error::Error for EstimateError {}

impl From<MatchFitError> for EstimateError {
    fn from(error: MatchFitError) -> Self {
        Self::Given(error)
    }
}

impl From<MotionError> for EstimateError {
    fn from(error: MotionError) -> Self {
        Self::Motion(error)
    }
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
