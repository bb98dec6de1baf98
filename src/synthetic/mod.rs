//! Image pairs whose geometry is known to rounding: the built-in samples, and made ones for tests and benchmarks.
//!
//! - `Sample` (feature `files`) holds the pairs that come with the program; `examples/render-samples` made them.
//! - [`BallScene`] draws two synchronised sequences in which things move.
//! - [`test_pair`] draws a yard of flat, textured walls and boxes at any picture size, for every [`Motion`].

mod balls;
mod motion;
#[cfg(feature = "files")]
mod sample;
mod yard;

pub use balls::{BallScene, ThrownBalls};
pub use motion::Motion;
#[cfg(feature = "files")]
pub use sample::{SAMPLE_FRAME, Sample, SampleFile, SamplePair};
pub use yard::{TestPair, test_pair};
