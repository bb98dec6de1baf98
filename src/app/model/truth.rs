//! Ground truth of the open pictures, and its source.

use super::document::TruthSource;
use super::shared::Shared;
use crate::io::{GroundTruth, TruthError, TruthFolder};

/// Explanation when the pictures have no ground truth.
pub const NO_TRUTH: &str = "These images have no ground truth. To compare with ground truth, open a VGG folder, or a \
                            folder of pairs NAMEA.* and NAMEB.* with the true matches NAME.txt: a row x1 y1 x2 y2 \
                            for each match, in px.";

/// Ground truth of the pictures, whether or not it is in use.
#[derive(Debug, Clone)]
pub struct KnownTruth {
    /// The true geometry and the true matches.
    pub truth: Shared<GroundTruth>,
    /// Source of the truth, as the document names it.
    pub source: TruthSource,
}

impl KnownTruth {
    pub fn of_sample(truth: GroundTruth) -> Self {
        Self { source: TruthSource::Sample(truth.name.clone()), truth: Shared::new(truth) }
    }

    /// Reads the ground truth of two views of a folder.
    pub fn of_views(folder: &TruthFolder, views: [usize; 2]) -> Result<Self, TruthError> {
        let truth = Shared::new(folder.truth(views)?);
        let views = views.map(|view| folder.names()[view].clone());
        Ok(Self { truth, source: TruthSource::Folder { folder: folder.path().to_owned(), views } })
    }
}
