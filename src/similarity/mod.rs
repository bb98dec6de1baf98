//! Similarity of lines: the paper's stereo similarity (section 3), and the interface of other
//! measures.
//!
//! A [`SimilaritySource`] makes a [`LineSimilarity`] at any image size. The estimators request the
//! costs of many line pairs at a time and never read intensities themselves. A measure without
//! intensities can therefore replace stereo matching: [`BarcodeSource`] compares the motion
//! barcodes of two sequences.

mod barcode;
mod kernel;
mod measure;
mod parameters;
mod profile;
mod source;
mod stereo;

pub use barcode::{BarcodeSimilarity, BarcodeSource};
#[doc(hidden)]
pub use kernel::{Kernel, LANES, LaneBlock};
pub use measure::{CostMatrix, LineSimilarity, StereoSimilarity};
pub use parameters::{DisparityRange, LineMeasure, Ordering, SimilarityParameters, StereoParameters};
#[doc(hidden)]
pub use profile::{WarpedProfile, inspect_lines, inspection_scale};
pub use source::{PictureSource, ScaledSimilarity, SimilaritySource};
pub use stereo::{StereoMatch, match_cost, match_profiles};
