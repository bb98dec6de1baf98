//! What the measures mean, in words.

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

/// What to beware of, and what to do. `misfit` is the mean distance of the matches from their lines in the images, px.
pub(super) fn warnings(
    method: RectifyMethod,
    measures: &Measures,
    misfit: f64,
    scale: f64,
    orientation_assumed: bool,
) -> Vec<String> {
    let mut warnings = Vec::new();
    match &measures.rows {
        // Near the epipole a polar picture is stretched: rows may lie apart where the points hardly are.
        Some(rows) if rows.mean > BAD_ROWS && (method == RectifyMethod::Planar || misfit > BAD_ROWS) => {
            warnings.push(format!(
                "Rows of matches differ by {:.1} px on average: F does not fit these matches, so add point pairs \
                 or correct them.",
                rows.mean
            ));
        }
        Some(rows) if rows.mean > BAD_ROWS => warnings.push(format!(
            "Rows of matches differ by {:.1} px on average, because the picture is stretched near the epipole; in \
             the images the matches are {misfit:.1} px from their lines.",
            rows.mean
        )),
        _ => {}
    }
    if let Some(rows) = measures.rows.filter(|r| r.outside > 0) {
        warnings.push(format!(
            "{} of {} matches are outside the rectified pictures.",
            rows.outside,
            rows.matches + rows.outside
        ));
    }
    if method == RectifyMethod::Planar {
        for (k, distortion) in measures.distortion.iter().enumerate() {
            if let Some(what) = bent(distortion) {
                warnings.push(format!("Image {} is left {what}, which the polar method does less.", k + 1));
            }
        }
    }
    for (k, distortion) in measures.distortion.iter().enumerate() {
        if distortion.cut > MUCH {
            warnings.push(format!(
                "{:.0} % of image {} is left out, because the other image does not see these epipolar lines.",
                100.0 * distortion.cut,
                k + 1
            ));
        }
    }
    if scale < 1.0 {
        warnings.push(format!(
            "The pictures are drawn at {:.0} % of their size to stay within the limit of pixels: raise the limit for \
             full size.",
            100.0 * scale
        ));
    }
    if orientation_assumed {
        warnings.push(
            "Which halves of the epipolar lines correspond is assumed from both cameras being held alike: give a \
             match to be sure."
                .into(),
        );
    }
    warnings
}
