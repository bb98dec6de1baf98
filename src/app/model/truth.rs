//! Ground truth of the open pictures, and its source.

use super::document::TruthSource;
use super::shared::Shared;
use crate::io::GroundTruth;

/// Explanation when the pictures have no ground truth.
pub const NO_TRUTH: &str = "These images have no ground truth. To compare with ground truth, open \
                            a VGG folder, or a folder of pairs with true matches.";

/// Ground truth of the pictures, whether or not it is in use.
#[derive(Debug, Clone)]
pub struct KnownTruth {
    /// The true geometry and the true matches.
    pub truth: Shared<GroundTruth>,
    /// Source of the truth, as the document names it.
    pub source: TruthSource,
}
