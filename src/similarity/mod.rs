//! How well two lines match: the paper's stereo similarity (section 3) and the interface that other
//! measures implement.
//!
//! The estimators ask a [`LineSimilarity`] for costs of lines against lines and never look at
//! intensities themselves, so that a measure without intensities (motion barcodes, say) can take the place
//! of stereo matching.

mod kernel;
mod measure;
mod parameters;
mod profile;
mod stereo;

pub use kernel::{Kernel, LANES, LaneBlock};
pub use measure::{CostMatrix, LineSimilarity, StereoSimilarity};
pub use parameters::{DisparityRange, Ordering, StereoParameters};
pub use profile::{WarpedProfile, inspect_lines, inspection_scale};
pub use stereo::{StereoMatch, match_cost, match_profiles};
