//! Ground truth of the pictures that are open, and where it comes from.

use super::document::TruthSource;
use super::shared::Shared;
use crate::io::GroundTruth;

/// What is missing where nothing is known about the pictures.
pub const NO_TRUTH: &str = "Nothing is known about these images beforehand: open a VGG folder, or a folder of pairs \
                            with true matches, to compare with ground truth.";

/// What is known about the pictures, whether or not it is in use.
#[derive(Debug, Clone)]
pub struct KnownTruth {
    /// The true geometry and the true matches.
    pub truth: Shared<GroundTruth>,
    /// Where they come from, as the document names it.
    pub source: TruthSource,
}
