//! In which convention is a fundamental matrix from somewhere else? Matches know.
//!
//! A 3×3 matrix does not say whether `x2ᵀ F x1 = 0` or `x1ᵀ F x2 = 0`, whether x or y comes first, where pixel (0, 0)
//! is, or for which size of the images it holds. With 8 or more matches the possible [`Reading`]s are tried out: each
//! turns the matrix into an `F` in the convention of this program, and the matches measure how well that fits.
//!
//! Readings are ranked by the **median** symmetric epipolar distance of the matches, which fewer than half
//! of them being wrong do not spoil. Readings that are the same thing for this matrix (a matrix of a pure translation is, up to
//! sign, its own transpose) are listed once, under the simplest name. Two readings are *told apart* if the paired
//! differences of their distances, capped so that wrong matches count little, are clearly not zero, or if one fits and the
//! other neither fits nor comes near it; of those that are not, the one with the fewest changes is believed.
//!
//! # Pitfalls
//! - The origin often cannot be told: between cameras that look in about the same direction a shift of half a pixel
//!   in both images moves points nearly along with their lines. It then hardly matters either, and the verdict says so.
//! - Scale is not seen for epipoles at infinity and parallel lines, where every scale is the same matrix.
//! - Matches of one plane fit many matrices. Take matches at different depths.

mod check;
mod reading;
#[cfg(all(test, feature = "files"))]
mod tests;

pub use check::{CheckError, ConventionCheck, RankedReading, check_convention};
pub use reading::Reading;

/// Fewest matches for a check. With fewer, one of the many readings may fit by chance.
pub const FEWEST_MATCHES: usize = 8;
