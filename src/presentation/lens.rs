//! Words for the distortion of a lens.

use crate::estimate::DivisionFit;
use crate::geometry::Frame;

/// Returns the coefficients with their standard deviations, and how far they move the corners of images of
/// these sizes.
pub fn lens_in_words(lens: &DivisionFit, frames: [Frame; 2]) -> String {
    let coefficient = |k: usize| format!("{:.4} ± {:.4}", lens.lambdas[k], lens.deviations[k]);
    let coefficients = if lens.is_same {
        format!("λ {} for both images", coefficient(0))
    } else {
        format!("λ {} and {}", coefficient(0), coefficient(1))
    };
    let shift = lens.corner_shift(frames);
    format!(
        "lens distortion fits the matches clearly better: {coefficients}; it moves the corners by {shift:.0} px"
    )
}
