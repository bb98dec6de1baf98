//! Errors of reading a picture.

use thiserror::Error;

use super::limit::{MEGAPIXELS_VARIABLE, weight};

/// The reason why a picture could not be read. Each message is one sentence for the user. The first text of a
/// variant is the path for display, the second one the reason.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file is missing, unreadable, or not a regular file.
    #[error("cannot open the image {0}: {1}")]
    Open(String, String),
    /// The content is not a picture in a known format.
    #[error("{0} is not an image in a known format (PNG, JPEG, TIFF, BMP, PNM or WebP)")]
    Format(String),
    /// The content is a picture in an unsupported format. The format has a name such as EXR; `way` is what
    /// to do, a sentence without a full stop.
    #[error("the image {path} has the format {format}, which is not supported. {way}")]
    OtherFormat { path: String, format: String, way: &'static str },
    /// A TIFF file with a compression that is not read.
    #[error(
        "the image {path} is a TIFF file with {name} compression, which is not read. Save it with another \
         one, for example: gdal_translate -co COMPRESS=DEFLATE IN.tif OUT.tif"
    )]
    Compression { path: String, name: String },
    /// The format is known, but this variant of it is not supported.
    #[error(
        "the image {0} has an unsupported kind of pixels ({1}). Save it with 8 or 16 bits, grey or colour"
    )]
    Unsupported(String, String),
    /// The file is damaged or truncated.
    #[error("the image {0} is damaged or incomplete ({1}). Get a new copy")]
    Damaged(String, String),
    /// The header claims a size that the decoder rejects without reporting it.
    #[error("the image {0} has a header with an impossible size. Get a new copy, or make the image smaller")]
    Enormous(String),
    /// The picture has more pixels than the limit. Its size is the size in the header.
    #[error("the image {}", too_large(path, *width, *height, *bytes_a_pixel, *most_pixels))]
    TooLarge { path: String, width: u64, height: u64, bytes_a_pixel: u64, most_pixels: u64 },
    /// The file is larger than the largest picture within the limit. The limit is in millions of bytes.
    #[error(
        "the image {path} is larger than {megabytes} MB, the limit. Set {MEGAPIXELS_VARIABLE} to raise it"
    )]
    LongFile { path: String, megabytes: u64 },
    /// The picture does not fit into memory.
    #[error("the image {0} needs more memory than there is. Make it smaller")]
    Memory(String),
    /// The image has no pixels.
    #[error("the image {0} has no pixels")]
    Empty(String),
    /// All pixels are missing data, infinite or NaN.
    #[error("the image {0} has no pixels with a finite number: all are missing data, NaN or infinite")]
    NotFinite(String),
    /// The environment variable of this name has an invalid value.
    #[error("{name} is \"{value}\", expected {expected}")]
    Setting { name: &'static str, value: String, expected: &'static str },
}

fn too_large(path: &str, width: u64, height: u64, bytes_a_pixel: u64, most_pixels: u64) -> String {
    let pixels = u128::from(width) * u128::from(height);
    let millions = |count: u128| count.div_ceil(1_000_000).max(1);
    let counted = weight(u64::try_from(pixels).unwrap_or(u64::MAX), bytes_a_pixel);
    // Memory for the pixels, the grey plane and its pyramid.
    let memory = (pixels * (u128::from(bytes_a_pixel) + 6)).div_ceil(1_000_000_000);
    let wide = if counted > pixels { format!(" of {bytes_a_pixel} bytes") } else { String::new() };
    format!(
        "{path} has {width} x {height} pixels{wide}, {} million. The limit is {} million. Make it smaller, or set \
         {MEGAPIXELS_VARIABLE}={} if {memory} GB of memory are free",
        millions(pixels),
        millions(u128::from(most_pixels)),
        millions(counted),
    )
}
