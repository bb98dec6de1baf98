//! What small patches say about a geometry: look-alike corners vote for κ, their support chooses among combinations of
//! candidate lines, refitting and resampling improve the best, and matches along the epipolar lines refine all of F.
//!
//! Line similarity proposes (see [`super::lines`]), patches dispose.

mod levels;
mod polish;
mod rank;
mod refinement;
mod resampling;
mod search;
mod support;
mod voting;

pub use refinement::RefinedMatch;

pub(super) use levels::{FeatureSupport, PatchLevels};
pub(super) use polish::LEAST_CLICK_SIGMA;
pub(super) use rank::{different, hypotheses, rank, rank_fine};
pub(super) use refinement::Refined;
pub(super) use search::{Proposal, propose, unvalidated};
pub(super) use support::{BAND, Support, SupportLevel};
