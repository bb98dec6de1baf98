//! Geometries of one image pair by different methods, on the same points.
//!
//! [`fit_seven`] and [`fit_eight`] fit the classical methods to point pairs, `robust` has RANSAC and `LMedS`.
//! [`Distances`] and [`Spread`] measure any geometry on points. [`KnownPair::further`] adds true matches to clicks
//! until a method has enough of them. The statistics count a missing geometry as an infinite error.

mod fits;
mod known_pair;
#[cfg(feature = "inspector")]
mod methods;
mod random;
#[cfg(feature = "inspector")]
mod robust;
mod statistics;

pub use fits::{Distances, FitError, PointFit, Spread, fit_eight, fit_seven};
pub use known_pair::{KnownPair, SPACING, apart};
#[cfg(feature = "inspector")]
pub use methods::{Contestant, Measure, MethodComparison, MethodQuestion, PointSet, Subject};
pub use random::{Purpose, generator};
pub use statistics::{mean, median, share_below};
