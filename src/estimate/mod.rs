//! From clicked point pairs to a fundamental matrix, with everything that led to it.

mod error;
mod monitor;
mod parameters;
mod result;

pub use error::{EstimateError, Warning};
pub use monitor::{CancelFlag, Monitor, Progress, Stage};
pub use parameters::{Method, Parameters, Preset};
pub use result::{Counts, Estimate, Hypothesis, StageTiming};

use crate::geometry::PointPair;
use crate::image::GrayPlane;

/// Estimates the fundamental matrix of two images from two or three clicked point pairs.
pub fn estimate(
    image1: &GrayPlane,
    image2: &GrayPlane,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Estimate, EstimateError> {
    let _ = (image1, image2, pairs, parameters, monitor);
    Err(EstimateError::NoGeometry)
}
