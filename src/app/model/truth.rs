//! Ground truth of the pictures that are open, and where it comes from.

use super::document::TruthSource;
use super::shared::Shared;
use crate::evaluate::{Draws, KnownPair, Protocol};
use crate::geometry::{Frame, PointPair};
use crate::io::GroundTruth;

/// What is missing where nothing is known about the pictures.
pub const NO_TRUTH: &str = "Nothing is known about these images beforehand: open a VGG folder, or a folder of pairs \
                            with true matches, to compare with ground truth.";

/// Matches that a random trial draws from, at most: listing all pairs of them takes the square of their number.
const DRAWN_FROM: usize = 600;

/// What is known about the pictures, whether or not it is in use.
#[derive(Debug, Clone)]
pub struct KnownTruth {
    /// The true geometry and the true matches.
    pub truth: Shared<GroundTruth>,
    /// Where they come from, as the document names it.
    pub source: TruthSource,
}

impl KnownTruth {
    /// What the choice of clicks depends on.
    pub fn pair<'a>(&'a self, frames: [Frame; 2], matches: &'a [PointPair]) -> KnownPair<'a> {
        KnownPair { name: &self.truth.name, frames, truth: &self.truth.fundamental, matches }
    }

    /// The clicks of a random trial, `count` true matches drawn (up to 600 matches) as the first trial of
    /// `epiline evaluate --seed SEED` draws them; `None` when no matches are far enough apart.
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
