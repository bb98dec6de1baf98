//! Image pairs of exactly known geometry: the built-in samples, and synthetic pairs for tests and
//! benchmarks.
//!
//! - `Sample` (feature `files`) holds the built-in pairs, drawn by `lab/examples/render-samples`.
//! - [`BallScene`] draws two synchronised sequences of moving balls.
//! - [`test_pair`] draws a yard of flat, textured walls and boxes at any image size, for every
//!   [`Motion`].

mod balls;
mod motion;
#[cfg(feature = "files")]
mod sample;
mod yard;

pub use balls::{BallScene, ThrownBalls};
#[doc(hidden)]
pub use motion::Motion;
#[cfg(feature = "files")]
#[doc(hidden)]
pub use sample::{SAMPLE_FRAME, SampleFile};
#[cfg(feature = "files")]
pub use sample::{Sample, SamplePair};
#[doc(hidden)]
pub use yard::{TestPair, test_pair};
