//! What small patches say about a geometry: look-alike corners vote for κ, their support chooses among combinations of
//! candidate lines, refitting and resampling improve the best, and matches along the epipolar lines refine all of F.
//!
//! Line similarity proposes (see [`super::lines`]), patches dispose.

mod aligned_features;
mod corner_patches;
mod feature_support;
mod guided_fit;
mod level_corners;
mod levels;
mod look_alikes;
mod near_lines;
mod plane;
mod polish;
mod rank;
mod refinement;
mod resampling;
mod search;
mod support;
mod uncertainty;
mod voting;

pub use refinement::{RefinedMatch, Refinement};
pub use support::PatchSupport;
pub use uncertainty::{EpipoleEllipse, Uncertainty};

pub(super) use feature_support::FeatureSupport;
pub(super) use guided_fit::Settling;
pub(super) use levels::{PatchLevels, resized};
pub(super) use plane::largest_plane;
pub(super) use polish::LEAST_CLICK_SIGMA;
pub(super) use rank::{different, hypotheses, rank, rank_fine};
pub(super) use refinement::Refined;
pub(super) use search::{Hypothesis, Proposal, propose};
pub(super) use support::{BAND, SupportLevel};
