//! Fundamental matrix from matches alone: noise, consensus, covariance.
//!
//! [`estimate_fundamental`] is the stage by itself. The final fit at full size (`patches/guided_fit`)
//! uses the same parts, and matches again along the lines of each geometry. `few` fits to as few as eight matches,
//! or six of known cameras.

mod consensus;
mod contradiction;
mod division;
pub(super) mod false_alarms;
mod few;
mod line_likelihood;
mod matches;
mod model;
mod neighbours;
mod noise;
mod pattern;
mod plane;
mod plane_poses;
mod scoring;
mod turn;
mod uncertainty;
mod warp;

use crate::geometry::PointPair;

pub use division::DivisionFit;
pub use matches::{MatchFit, MatchFitError, estimate_essential, estimate_fundamental};
pub use noise::Noise;
pub use uncertainty::{EpipoleBearing, EpipoleCertainty, EpipoleEllipse, LineBands, Uncertainty};

pub(super) use consensus::{Evidence, Fitted};
pub(super) use contradiction::{Contradiction, Explanation};
pub(super) use division::{fit_division, strong_lens_is_likelier};
pub(super) use few::{fit_given, fit_matches};
pub(super) use line_likelihood::LineLikelihood;
pub(super) use model::Model;
pub(super) use neighbours::foreshortening;
pub(super) use noise::{LEAST_SCALE, MEDIAN};
pub(super) use pattern::{ResidualPattern, residual_pattern};
pub(super) use plane::largest_plane;
pub(super) use plane_poses::other_pose;
pub(super) use scoring::{BAND, Consensus, Units, Witness, residual};
pub(super) use turn::Turn;
pub(super) use warp::{Follows, Warp};

/// Largest number of rounds of estimating the noise and fitting to it. They end earlier when the
/// likelihood no longer grows.
const ROUNDS: usize = 6;

/// Fits in rounds from a start, until the log-likelihood grows by less than `least_gain`. Returns the
/// likeliest fit, and `None` if a fit fails.
fn climbed<T>(
    start: T,
    least_gain: f64,
    log_likelihood: impl Fn(&T) -> f64,
    refitted: impl Fn(&T) -> Option<T>,
) -> Option<T> {
    let mut best = start;
    for _ in 0..ROUNDS {
        let next = refitted(&best)?;
        let gain = log_likelihood(&next) - log_likelihood(&best);
        if gain > 0.0 {
            best = next;
        }
        if gain < least_gain {
            break;
        }
    }
    Some(best)
}

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
