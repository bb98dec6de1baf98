//! Evidence of small patches for a geometry. Look-alike corners vote for κ, and their support ranks
//! combinations of candidate lines. Refitting and resampling improve the best, and matches along
//! the epipolar lines refine `F`.
//!
//! Lines propose (see [`super::lines`]); patches decide.

mod aligned_features;
mod corner_patches;
mod dense;
mod feature_support;
mod guided_fit;
mod level_corners;
mod levels;
mod look_alikes;
mod matches;
mod near_lines;
mod polish;
mod proposals;
mod rank;
mod refinement;
mod resampling;
mod support;
mod unguided;
mod voting;

pub use matches::RefinedMatch;
pub use refinement::{Refinement, RefinementStep};
pub use support::{CHECKPOINTS, PatchSupport};

pub(in crate::estimate) use feature_support::FeatureSupport;
pub(in crate::estimate) use guided_fit::Settling;
pub(in crate::estimate) use levels::{MirrorMatches, PatchLevels, resized};
pub(in crate::estimate) use matches::LEAST_MATCHES;
pub(in crate::estimate) use polish::LEAST_CLICK_SIGMA;
pub(in crate::estimate) use proposals::{Hypothesis, Proposal, propose};
pub(in crate::estimate) use rank::{different, hypotheses, rank, rank_fine};
pub(in crate::estimate) use refinement::Refined;
pub(in crate::estimate) use support::{BAND, SupportLevel};
pub(in crate::estimate) use unguided::{LIKELY, UnguidedMatch, one_a_place};
