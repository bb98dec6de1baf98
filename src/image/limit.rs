//! How the pixels of a picture are counted, and the environment variable that says what is read: what those who set the
//! limit and those who tell of it have in common.

/// The environment variable that raises (or lowers) the size of pictures that are read, millions of pixels.
pub const MEGAPIXELS_VARIABLE: &str = "EPILINE_MAX_MEGAPIXELS";

/// Bytes of a pixel as wide as four channels of 16 bits: what the limit counts a pixel as.
pub(super) const WIDE_PIXEL: u64 = 8;

/// Pixels as the limit counts them.
pub(super) fn weight(pixels: u64, bytes_a_pixel: u64) -> u128 {
    (u128::from(pixels) * u128::from(bytes_a_pixel.max(WIDE_PIXEL))).div_ceil(u128::from(WIDE_PIXEL))
}
