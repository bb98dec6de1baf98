//! How well two lines match: the paper's stereo similarity (section 3) and the interface that other
//! measures implement.
//!
//! What is compared is a [`SimilaritySource`], which makes a [`LineSimilarity`] at any size. The estimators ask that for
//! costs of lines against lines, many at a time, and never look at intensities themselves, so that a measure without
//! intensities can take the place of stereo matching: [`BarcodeSource`] compares the motion barcodes of two sequences.

mod barcode;
mod kernel;
mod measure;
mod parameters;
mod profile;
mod source;
mod stereo;

pub use barcode::{BarcodeSimilarity, BarcodeSource};
pub use kernel::{Kernel, LANES, LaneBlock};
pub use measure::{CostMatrix, LineSimilarity, StereoSimilarity};
pub use parameters::{DisparityRange, LineMeasure, Ordering, SimilarityParameters, StereoParameters};
pub use profile::{WarpedProfile, inspect_lines, inspection_scale};
pub use source::{PictureSource, ScaledSimilarity, SimilaritySource};
pub use stereo::{StereoMatch, match_cost, match_profiles};
