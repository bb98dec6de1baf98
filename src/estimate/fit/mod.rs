//! From matches alone to a fundamental matrix: noise, consensus, covariance.

mod consensus;
mod noise;
mod scoring;

use crate::geometry::PointPair;
pub use noise::Noise;

pub(super) use consensus::{Evidence, Fitted};
pub(super) use scoring::{BAND, Consensus, Units, Witness, residual};

/// A putative match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// The match, px.
    pub pair: PointPair,
    /// Scale of the noise of this match relative to the others; 1 for an ordinary match.
    pub sigma: f64,
    /// Probability that the match is right as far as its likeness tells, whatever the geometry: 1 for a unique match, ½
    /// for one of two that look alike.
    pub prior: f64,
}
