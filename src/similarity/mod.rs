//! Similarity of lines: the paper's stereo similarity (section 3), and the interface of other
//! measures.
//!
//! A [`SimilaritySource`] makes a [`LineSimilarity`] at any image size. The estimators request the
//! costs of many line pairs at a time and never read intensities themselves. A measure without
//! intensities can therefore replace stereo matching: [`BarcodeSource`] compares the motion
//! barcodes of two sequences.

mod barcode;
mod kernel;
mod matched_lines;
mod measure;
mod parameters;
mod profile;
mod source;
mod stereo;

pub use barcode::{BarcodeSimilarity, BarcodeSource};
#[doc(hidden)]
pub use kernel::{Kernel, LANES, LaneBlock};
#[doc(hidden)]
pub use matched_lines::MatchedLines;
pub use measure::{CostMatrix, LineSimilarity, StereoSimilarity};
pub use parameters::{DisparityRange, LineMeasure, Ordering, SimilarityParameters, StereoParameters};
pub use source::{PictureSource, ScaledSimilarity, SimilaritySource};
pub use stereo::{StereoMatch, match_cost, match_profiles};
