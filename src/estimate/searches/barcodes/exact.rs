//! Exact silhouettes for tests: bands of rows that move in given frames.

use crate::geometry::Frame;
use crate::motion::Silhouettes;

/// Size of the images.
pub(super) const FRAME: Frame = Frame { width: 64, height: 48 };
/// Height of a band, in rows. Thinner bands are removed as specks.
pub(super) const BAND: usize = 4;

/// Returns a recording in which band `b` moves in frame `t` if `is_moving(b, t)`.
pub(super) fn bands(frames: usize, is_moving: impl Fn(usize, usize) -> bool) -> Silhouettes {
    let mask = |time: usize| -> Vec<bool> {
        (0..FRAME.width * FRAME.height).map(|k| is_moving(k / FRAME.width / BAND, time)).collect()
    };
    Silhouettes::from_masks("bands", FRAME, FRAME, (0..frames).map(mask).collect()).unwrap()
}

/// Returns whether a band moves in a frame: three times in ten, independently of other bands.
pub(super) fn by_itself(band: usize, time: usize) -> bool {
    let mixed = (band as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (time as u64 + 1).wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed ^ (mixed >> 32)) % 10 < 3
}
