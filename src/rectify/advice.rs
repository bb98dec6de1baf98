//! Reasons and warnings of a rectification, in words.

use std::fmt;

use serde::{Serialize, Serializer};

use super::measures::{Distortion, Measures};
use crate::geometry::image_in_words;

use super::{Rectification, RectifyError, RectifyMethod};

/// Mean row error from which a warning is given, px.
const BAD_ROWS: f64 = 1.0;
/// Deviation of the middle lines from a right angle from which a picture counts as skewed, degrees.
const SKEWED: f64 = 15.0;
/// Ratio of the diagonals from which a picture counts as skewed.
const UNEVEN: f64 = 1.35;
/// Fraction of an image that may be shrunk, stretched or cut without a warning.
const MUCH: f64 = 0.25;

/// Returns why polar is used where planar is impossible.
pub(super) fn instead_of_planar(error: &RectifyError) -> String {
    match error {
        RectifyError::EpipoleInside(image) => {
            format!(
                "the epipole lies inside {}, where planar rectification is impossible",
                image_in_words(*image)
            )
        }
        _ => "every pair of corresponding epipolar lines crosses one of the images, so planar rectification is impossible"
            .into(),
    }
}

/// Returns why a planar result is too distorted for [`RectifyMethod::Auto`], `None` if it is fine.
pub(super) fn against_planar(planar: &Rectification) -> Option<String> {
    planar.measures.distortion.iter().enumerate().find_map(|(k, distortion)| {
        let what = bent(distortion)?;
        Some(format!("with the planar method {} would be {what}", image_in_words(k + 1)))
    })
}

/// Describes the distortion of a picture, `None` if it is small.
fn bent(d: &Distortion) -> Option<String> {
    if d.shrunk + d.stretched > MUCH {
        let percent = 100.0 * (d.shrunk + d.stretched);
        return Some(format!("shrunk or stretched over {percent:.0} % of its area"));
    }
    let skewed = d.orthogonality.is_some_and(|o| (o - 90.0).abs() > SKEWED)
        || d.aspect_ratio.is_some_and(|a| !(1.0 / UNEVEN..=UNEVEN).contains(&a));
    skewed.then(|| "skewed".into())
}

/// Warning about a rectification, with the advice to act on. `Display` gives a sentence.
#[derive(Debug, Clone, PartialEq)]
pub enum RectifyWarning {
    /// F does not fit the matches: their mean vertical distance, px.
    Misfit { rows: f64 },
    /// Matches lie in different rows because the picture is stretched there, although F fits them: their mean
    /// vertical distance, and their mean epipolar distance in the images, px.
    StretchedRows { rows: f64, misfit: f64 },
    /// Some of all matches lie outside the rectified pictures.
    Outside { matches: usize, all: usize },
    /// The planar method distorts an image, numbered from 1; `how` describes it.
    Bent { image: usize, how: String },
    /// Much of an image, numbered from 1, is missing from its picture: this fraction.
    Cut { image: usize, share: f64 },
    /// The pixel limit made the pictures smaller by this factor.
    Reduced { scale: f64 },
    /// No match determines which halves of the epipolar lines correspond.
    OrientationAssumed,
}

impl fmt::Display for RectifyWarning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Misfit { rows } => write!(
                f,
                "Matches lie {rows:.1} px apart vertically on average. F does not fit them: add or correct point pairs."
            ),
            Self::StretchedRows { rows, misfit } => write!(
                f,
                "Matches lie {rows:.1} px apart vertically on average, because the pictures are stretched there. \
                 F fits them: in the images they are {misfit:.1} px from their epipolar lines."
            ),
            Self::Outside { matches, all } => {
                write!(f, "{matches} of {all} matches are outside the rectified pictures.")
            }
            Self::Bent { image, how } => {
                write!(f, "The picture of {} is {how}. The polar method distorts less.", image_in_words(*image))
            }
            Self::Cut { image, share } => write!(
                f,
                "{:.0} % of {} is cut off. The other image does not see these epipolar lines.",
                100.0 * share,
                image_in_words(*image)
            ),
            Self::Reduced { scale } => write!(
                f,
                "The pictures are drawn at {:.0} % of their size because of the pixel limit. Raise the limit for full size.",
                100.0 * scale
            ),
            Self::OrientationAssumed => f.write_str(
                "The program assumes that both cameras were held the same way up. If a picture is turned by 180°, \
                 add a point pair.",
            ),
        }
    }
}

impl Serialize for RectifyWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Returns the warnings of a rectification. `misfit` is the mean epipolar distance of the matches
/// in the images, px.
pub(super) fn warnings(
    method: RectifyMethod,
    measures: &Measures,
    misfit: f64,
    scale: f64,
    orientation_assumed: bool,
) -> Vec<RectifyWarning> {
    let mut warnings = Vec::new();
    if let Some(rows) = measures.rows.map(|rows| rows.mean).filter(|mean| *mean > BAD_ROWS) {
        // Near the epipole a picture is stretched: rows may differ by more than the matches do.
        warnings.push(if misfit <= BAD_ROWS {
            RectifyWarning::StretchedRows { rows, misfit }
        } else {
            RectifyWarning::Misfit { rows }
        });
    }
    if let Some(rows) = measures.rows.filter(|r| r.outside > 0) {
        warnings.push(RectifyWarning::Outside { matches: rows.outside, all: rows.matches + rows.outside });
    }
    let images = || (1..).zip(&measures.distortion);
    if method == RectifyMethod::Planar {
        let bent = images().filter_map(|(image, d)| Some(RectifyWarning::Bent { image, how: bent(d)? }));
        warnings.extend(bent);
    }
    let cut = images().filter(|(_, distortion)| distortion.cut > MUCH);
    warnings.extend(cut.map(|(image, distortion)| RectifyWarning::Cut { image, share: distortion.cut }));
    if scale < 1.0 {
        warnings.push(RectifyWarning::Reduced { scale });
    }
    if orientation_assumed {
        warnings.push(RectifyWarning::OrientationAssumed);
    }
    warnings
}
