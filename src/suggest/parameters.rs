//! Extent of the search, and limits for a clear suggestion.

use serde::Serialize;

use super::Clarity;

/// Parameters of [`suggest`](super::suggest()).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuggestParameters {
    /// Half width of the band searched around the epipolar line, full-size px.
    pub band: f64,
    /// Maximum number of candidates returned.
    pub candidates: usize,
    /// Minimum correlation of a clear suggestion, −1 to 1.
    pub least_correlation: f64,
    /// Maximum ambiguity of a clear suggestion, 0 to 1.
    pub most_ambiguity: f64,
    /// Maximum distance from the click at the end of the reverse search, px. The larger of this
    /// limit and `return_share` applies.
    pub return_pixels: f64,
    /// The same limit as a fraction of the longer side of the image.
    pub return_share: f64,
}

impl Default for SuggestParameters {
    fn default() -> Self {
        Self {
            band: 4.0,
            candidates: 5,
            least_correlation: 0.8,
            most_ambiguity: 0.6,
            return_pixels: 2.0,
            return_share: 0.0025,
        }
    }
}

impl SuggestParameters {
    pub(super) fn verdict(
        &self,
        correlation: f64,
        ambiguity: f64,
        return_distance: Option<f64>,
        longer_side: f64,
    ) -> Clarity {
        let near = self.return_pixels.max(self.return_share * longer_side);
        if correlation < self.least_correlation {
            Clarity::Weak
        } else if ambiguity >= self.most_ambiguity {
            Clarity::Ambiguous
        } else if return_distance.is_none_or(|d| d > near) {
            Clarity::NoReturn
        } else {
            Clarity::Clear
        }
    }
}
