//! Why a picture is not read.

use thiserror::Error;

use super::limit::{MEGAPIXELS_VARIABLE, weight};

/// Why a picture could not be read. Each message is one sentence for the user.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file is missing, may not be read, or is nothing to read from.
    #[error("cannot open the image {path}: {reason}")]
    Open {
        /// The file.
        path: String,
        /// The system's reason.
        reason: String,
    },
    /// The content is not a picture in a known format.
    #[error("{path} is not an image in a known format (PNG, JPEG, TIFF, BMP, PNM or WebP)")]
    Format {
        /// The file.
        path: String,
    },
    /// The content is a picture in a format that is not read.
    #[error(
        "the image {path} has the format {format}, which is not read: convert it to TIFF or PNG{}",
        for_animations(format)
    )]
    OtherFormat {
        /// The file.
        path: String,
        /// Name of the format, such as EXR.
        format: String,
    },
    /// The format is known, but not this variety of it.
    #[error(
        "the image {path} is of a kind that is not read ({reason}): save it with 8 or 16 bits, grey or colour"
    )]
    Unsupported {
        /// The file.
        path: String,
        /// What of it is not read.
        reason: String,
    },
    /// The file is damaged or truncated.
    #[error("the image {path} is damaged or incomplete: {reason}; get it anew")]
    Damaged {
        /// The file.
        path: String,
        /// The decoder's reason.
        reason: String,
    },
    /// The header claims a size that the decoder does not even tell.
    #[error(
        "the image {path} claims a size beyond what its format allows or this program reads: its header is damaged, or \
         make it smaller"
    )]
    Enormous {
        /// The file.
        path: String,
    },
    /// The picture has more pixels than are read.
    #[error("the image {}", too_large(path, *width, *height, *bytes_a_pixel, *most_pixels))]
    TooLarge {
        /// The file.
        path: String,
        /// What it claims to have, px.
        width: u64,
        /// What it claims to have, px.
        height: u64,
        /// Depth and channels.
        bytes_a_pixel: u64,
        /// The limit.
        most_pixels: u64,
    },
    /// The file itself is larger than the largest picture that is read.
    #[error(
        "the image {path} has more than {megabytes} MB, larger than any that is read: set {MEGAPIXELS_VARIABLE} to raise the limit"
    )]
    LongFile {
        /// The file.
        path: String,
        /// The limit, millions of bytes.
        megabytes: u64,
    },
    /// There is no memory for the picture.
    #[error("the image {path} needs more memory than there is: make it smaller")]
    Memory {
        /// The file.
        path: String,
    },
    /// The image has no pixels.
    #[error("the image {path} has no pixels")]
    Empty {
        /// The file.
        path: String,
    },
    /// Values that are no brightness.
    #[error("the image {path} has pixels that are not finite numbers (NaN or infinite): replace them first")]
    NotFinite {
        /// The file.
        path: String,
    },
    /// An environment variable says nothing sensible.
    #[error("{name} is \"{value}\", expected {expected}")]
    Setting {
        /// The variable.
        name: &'static str,
        /// What it is.
        value: String,
        /// What it may be.
        expected: &'static str,
    },
}

fn for_animations(format: &str) -> &'static str {
    if format == "GIF" { ", an animation to a video or to numbered pictures in a folder" } else { "" }
}

fn too_large(path: &str, width: u64, height: u64, bytes_a_pixel: u64, most_pixels: u64) -> String {
    let pixels = u128::from(width) * u128::from(height);
    let millions = |count: u128| count.div_ceil(1_000_000).max(1);
    let counted = weight(u64::try_from(pixels).unwrap_or(u64::MAX), bytes_a_pixel);
    // The pixels, the grey plane and its smaller sizes.
    let memory = (pixels * (u128::from(bytes_a_pixel) + 6)).div_ceil(1_000_000_000);
    let wide = if counted > pixels { format!(" of {bytes_a_pixel} bytes") } else { String::new() };
    format!(
        "{path} is {width} x {height} pixels{wide}, {} million, and at most {} million are read: make it smaller, or set \
         {MEGAPIXELS_VARIABLE}={} if there are {memory} GB of memory for it",
        millions(pixels),
        millions(u128::from(most_pixels)),
        millions(counted),
    )
}
