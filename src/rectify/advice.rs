//! What the measures mean, in words.

use std::fmt;

use serde::{Serialize, Serializer};

use super::measures::{Distortion, Measures};
use super::{Rectification, RectifyError, RectifyMethod};

/// Rows that disagree by more than this on average are worth a word, px.
const BAD_ROWS: f64 = 1.0;
/// Angle of the middle lines from which on the picture looks skewed, degrees off 90.
const SKEWED: f64 = 15.0;
/// Ratio of the diagonals from which on the picture looks skewed.
const UNEVEN: f64 = 1.35;
/// Part of an image that may be shrunk, stretched or cut before it is worth a word.
const MUCH: f64 = 0.25;

/// Why polar is used where planar is impossible.
pub(super) fn instead_of_planar(error: &RectifyError) -> String {
    match error {
        RectifyError::EpipoleInside { image } => {
            format!("the epipole lies inside image {image}, where no plane can serve")
        }
        _ => "every pair of corresponding epipolar lines crosses one of the images, so no plane can serve"
            .into(),
    }
}

/// Why a planar result is too bent to be used by choice.
pub(super) fn against_planar(planar: &Rectification) -> Option<String> {
    planar.measures.distortion.iter().enumerate().find_map(|(k, distortion)| {
        let what = bent(distortion)?;
        Some(format!("the planar method would leave image {} {what}", k + 1))
    })
}

/// What is wrong with a picture's shape.
fn bent(d: &Distortion) -> Option<String> {
    let percent = |share: f64| 100.0 * share;
    if d.shrunk + d.stretched > MUCH {
        return Some(format!(
            "with {:.0} % of its area shrunk or stretched",
            percent(d.shrunk + d.stretched)
        ));
    }
    let skewed = d.orthogonality.is_some_and(|o| (o - 90.0).abs() > SKEWED)
        || d.aspect_ratio.is_some_and(|a| !(1.0 / UNEVEN..=UNEVEN).contains(&a));
    skewed.then(|| "skewed".into())
}

/// What to beware of in a rectification, and what to do about it, a sentence each.
#[derive(Debug, Clone, PartialEq)]
pub enum RectifyWarning {
    /// The geometry does not fit the matches.
    Misfit {
        /// Mean distance between the rows of matches, px.
        rows: f64,
    },
    /// Rows lie apart where the picture is stretched, although the geometry fits.
    StretchedRows {
        /// Mean distance between the rows of matches, px.
        rows: f64,
        /// Mean distance of the matches from their lines in the images, px.
        misfit: f64,
    },
    /// Matches are not in the pictures.
    Outside {
        /// How many.
        matches: usize,
        /// How many there are in all.
        all: usize,
    },
    /// The planar method bends an image.
    Bent {
        /// Which image, 1 or 2.
        image: usize,
        /// What is wrong with its shape.
        how: String,
    },
    /// Much of an image is not in its picture.
    Cut {
        /// Which image, 1 or 2.
        image: usize,
        /// Which part of it.
        share: f64,
    },
    /// The limit of pixels was met.
    Reduced {
        /// By what factor the pictures are smaller.
        scale: f64,
    },
    /// Nothing tells which halves of epipolar lines correspond.
    OrientationAssumed,
}

impl fmt::Display for RectifyWarning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Misfit { rows } => write!(
                f,
                "Rows of matches differ by {rows:.1} px on average: F does not fit these matches, so add point pairs or \
                 correct them."
            ),
            Self::StretchedRows { rows, misfit } => write!(
                f,
                "Rows of matches differ by {rows:.1} px on average, because the pictures are stretched there; in \
                 the images the matches are {misfit:.1} px from their lines."
            ),
            Self::Outside { matches, all } => {
                write!(f, "{matches} of {all} matches are outside the rectified pictures.")
            }
            Self::Bent { image, how } => {
                write!(f, "Image {image} is left {how}, which the polar method does less.")
            }
            Self::Cut { image, share } => write!(
                f,
                "{:.0} % of image {image} is left out, because the other image does not see these epipolar lines.",
                100.0 * share
            ),
            Self::Reduced { scale } => write!(
                f,
                "The pictures are drawn at {:.0} % of their size to stay within the limit of pixels: raise the limit for \
                 full size.",
                100.0 * scale
            ),
            Self::OrientationAssumed => f.write_str(
                "Which halves of the epipolar lines correspond is assumed from both cameras being held alike: give a \
                 match to be sure.",
            ),
        }
    }
}

impl Serialize for RectifyWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// What to beware of. `misfit` is the mean distance of the matches from their lines in the images, px.
pub(super) fn warnings(
    method: RectifyMethod,
    measures: &Measures,
    misfit: f64,
    scale: f64,
    orientation_assumed: bool,
) -> Vec<RectifyWarning> {
    let mut warnings = Vec::new();
    if let Some(rows) = measures.rows.map(|rows| rows.mean).filter(|mean| *mean > BAD_ROWS) {
        // Where a picture is stretched, near the epipole above all, rows may lie apart where the points hardly are.
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
