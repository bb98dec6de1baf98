//! From clicked point pairs to a fundamental matrix, with everything that led to it.

mod bundle;
mod candidates;
mod construction;
mod degeneracy;
mod error;
mod examination;
mod follow;
mod hypotheses;
mod level;
mod line_refinement;
mod monitor;
mod parameters;
mod patches;
mod pencils;
mod plane;
mod polish;
mod prepared;
mod published;
mod refinement;
mod resampling;
mod result;
mod search;
mod steered;
mod support;
mod trust;
mod two_point;
mod uncertainty;
mod validation;
mod voting;

pub use crate::cancel::CancelFlag;
pub use candidates::{Candidate, PencilComparison};
pub use construction::{Construction, RoundTrip};
pub use degeneracy::SMALLEST_SIDE;
pub use error::{EstimateError, Warning};
pub use examination::examine;
pub use follow::follow;
pub use monitor::{Monitor, Progress, Stage};
pub use parameters::{LineScore, Method, Parameters, Preset};
pub use pencils::{ComparedPencils, lines_at};
pub use prepared::PreparedPair;
pub use refinement::RefinedMatch;
pub use result::{Counts, Estimate, Hypothesis, PatchSupport, StageTiming};
pub use trust::{Reason, Trust, Verdict};
pub use uncertainty::{EpipoleEllipse, Uncertainty};

use std::time::Instant;

use crate::geometry::PointPair;
use crate::image::GrayPlane;

/// Estimates the fundamental matrix of two images from two or three clicked point pairs, full-size pixels.
///
/// Further pairs are ignored. The same images, pairs, parameters and seed give the same result on any number of
/// threads. To estimate again on the same images, prepare them once and call [`estimate_prepared`].
pub fn estimate(
    image1: &GrayPlane,
    image2: &GrayPlane,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Estimate, EstimateError> {
    let begun = Instant::now();
    let prepared = PreparedPair::new(image1, image2);
    two_point::run(&prepared, pairs, parameters, monitor, begun)
}

/// [`estimate`] on images that were prepared before.
pub fn estimate_prepared(
    prepared: &PreparedPair,
    pairs: &[PointPair],
    parameters: &Parameters,
    monitor: &Monitor,
) -> Result<Estimate, EstimateError> {
    two_point::run(prepared, pairs, parameters, monitor, Instant::now())
}
