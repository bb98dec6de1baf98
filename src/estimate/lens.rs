//! Lens distortion of two images without a calibration.

use super::evidence::prepared::PreparedPair;
use super::fit::{DivisionFit, fit_division};
use super::verdict::result::Estimate;

/// Finds radial distortion that explains the matches of the images clearly better than the result without
/// distortion. A plain solver tries several coefficients (as in arXiv 2410.05984), within some tenths of a
/// second.
///
/// Returns `None` if no lens is clear, if the matches of the result do not confirm it, and if the verdict
/// says that one plane explains the matches. On one plane, distortion looks like parallax.
pub fn find_lens(prepared: &PreparedPair, found: &Estimate) -> Option<DivisionFit> {
    if found.says_one_plane() {
        return None;
    }
    let matches = prepared.putative_matches();
    fit_division(&matches, found.fundamental(), &found.matched_pairs(), prepared.frames())
}
