//! Fundamental matrix from matches alone: noise, consensus, covariance.
//!
//! [`estimate_fundamental`] is the stage by itself. The final fit at full size (`patches/guided_fit`)
//! uses the same parts, and matches again along the lines of each geometry.

mod consensus;
mod division;
mod matches;
mod noise;
mod scoring;
mod uncertainty;

use crate::geometry::PointPair;

pub use division::DivisionFit;
pub use matches::{MatchFit, MatchFitError, estimate_fundamental};
pub use noise::Noise;
pub use uncertainty::{EpipoleBearing, EpipoleCertainty, EpipoleEllipse, Uncertainty};

pub(super) use consensus::{Evidence, Fitted};
pub(super) use division::fit_division;
pub(super) use scoring::{BAND, Consensus, Units, Witness, residual};

/// A putative match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// Positions in both images, px.
    pub pair: PointPair,
    /// Scale of the noise of this match relative to the others: 1 for an ordinary match.
    pub sigma: f64,
    /// Prior probability that the match is right, from its appearance alone: 1 for a unique match, ½ for
    /// one of two places that look alike.
    pub prior: f64,
}

impl From<PointPair> for Match {
    /// Returns an ordinary, unique match.
    fn from(pair: PointPair) -> Self {
        Self { pair, sigma: 1.0, prior: 1.0 }
    }
}
