//! Convention of a foreign fundamental matrix, determined from matches.
//!
//! A 3×3 matrix does not reveal its convention: `x2ᵀ F x1 = 0` or `x1ᵀ F x2 = 0`, the order of x
//! and y, the position of pixel (0, 0), the size of the images. With 8 or more matches the possible
//! [`Reading`]s are tested. Each reading converts the matrix to the convention of this program, and
//! the matches measure the fit.
//!
//! Readings are ranked by the **median** symmetric epipolar distance, which is robust to fewer than
//! half outliers. Readings that give the same matrix are listed once, under the simplest name. (For
//! a pure translation, the matrix equals its own transpose up to sign.) Two readings are *told
//! apart* if the mean of the paired differences of their distances is clearly not zero, with
//! outliers capped. They are also told apart if one fits and the other is far from fitting. Of the
//! readings that are not told apart, the one with the fewest changes is preferred.
//!
//! # Pitfalls
//! - The origin often cannot be determined. Between cameras that look in similar directions, a
//!   shift of half a pixel in both images moves points nearly along their lines. The origin then
//!   hardly matters, and the verdict says so.
//! - Scale cannot be determined for epipoles at infinity and parallel lines: every scale gives the
//!   same matrix.
//! - Matches on one plane fit many matrices. Use matches at different depths.

mod check;
mod reading;
#[cfg(all(test, feature = "files"))]
mod tests;

pub use check::{CheckError, ConventionCheck, RankedReading, check_convention};
pub use reading::Reading;

/// Minimum number of matches for a check. With fewer, one of the many readings may fit by chance.
pub const FEWEST_MATCHES: usize = 8;
