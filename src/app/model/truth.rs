//! Ground truth of the open pictures, and its source.

use super::document::TruthSource;
use super::shared::Shared;
use crate::evaluate::{Draws, KnownPair, Protocol};
use crate::geometry::{Frame, PointPair};
use crate::io::GroundTruth;

/// Explanation when the pictures have no ground truth.
pub const NO_TRUTH: &str = "These images have no ground truth. To compare with ground truth, open \
                            a VGG folder, or a folder of pairs with true matches.";

/// Maximum number of matches that a random trial draws from. Listing all pairs takes the square of
/// their number.
const DRAWN_FROM: usize = 600;

/// Ground truth of the pictures, whether or not it is in use.
#[derive(Debug, Clone)]
pub struct KnownTruth {
    /// The true geometry and the true matches.
    pub truth: Shared<GroundTruth>,
    /// Source of the truth, as the document names it.
    pub source: TruthSource,
}

impl KnownTruth {
    /// Returns the inputs for drawing clicks.
    pub fn pair<'a>(&'a self, frames: [Frame; 2], matches: &'a [PointPair]) -> KnownPair<'a> {
        KnownPair { name: &self.truth.name, frames, truth: &self.truth.fundamental, matches }
    }

    /// Draws the clicks of a random trial: `count` true matches, `None` when no matches are far
    /// enough apart. For up to 600 matches, these are the first clicks of `epiline evaluate --seed
    /// SEED`.
    pub fn draw(
        &self,
        frames: [Frame; 2],
        protocol: Protocol,
        seed: u64,
        count: usize,
    ) -> Option<Vec<PointPair>> {
        let all = &self.truth.matches;
        let some: Vec<PointPair> =
            all.iter().step_by(all.len().div_ceil(DRAWN_FROM).max(1)).copied().collect();
        let draws = Draws::new(self.pair(frames, &some), protocol, 1, 0.0, seed);
        Some(draws.clicks(0, &draws.matches(0, count)?))
    }
}
