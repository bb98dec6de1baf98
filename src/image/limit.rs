//! The pixel count used by the size limit, and the environment variable that sets the limit.

/// Environment variable with the largest picture that is read, in millions of pixels.
pub const MEGAPIXELS_VARIABLE: &str = "EPILINE_MAX_MEGAPIXELS";

/// Bytes of a pixel of four 16-bit channels, the widest pixel that counts as one.
pub(super) const WIDE_PIXEL: u64 = 8;

/// Returns the pixel count to compare with the limit. Pixels wider than [`WIDE_PIXEL`] bytes count
/// for more.
pub(super) fn weight(pixels: u64, bytes_a_pixel: u64) -> u128 {
    (u128::from(pixels) * u128::from(bytes_a_pixel.max(WIDE_PIXEL))).div_ceil(u128::from(WIDE_PIXEL))
}
