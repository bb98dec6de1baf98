//! Reading picture files.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageDecoder, ImageReader, metadata::Orientation};
use thiserror::Error;

use super::GrayPlane;
use crate::geometry::Frame;

/// A picture as loaded: every pixel as in the file (upright by its EXIF orientation) and its grey plane.
#[derive(Debug, Clone)]
pub struct Picture {
    /// What to call it: the file name, or the name of a built-in sample.
    pub name: String,
    /// Path of the file that it came from, if any.
    pub path: Option<PathBuf>,
    /// Pixels with the depth and channels of the file.
    pub pixels: DynamicImage,
    /// Intensities for computation.
    pub gray: GrayPlane,
}

/// Why a picture could not be read. Each message is one sentence for the user.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file is missing or may not be read.
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
    /// The file is damaged or truncated.
    #[error("the image {path} is damaged or incomplete: {reason}")]
    Damaged {
        /// The file.
        path: String,
        /// The decoder's reason.
        reason: String,
    },
    /// The image has no pixels.
    #[error("the image {path} has no pixels")]
    Empty {
        /// The file.
        path: String,
    },
}

impl Picture {
    /// Reads a file: 8 or 16 bits, grey, colour or alpha; the format is told from the content.
    pub fn open(path: &Path) -> Result<Self, LoadError> {
        let shown = path.display().to_string();
        let open = |e: &std::io::Error| LoadError::Open { path: shown.clone(), reason: reason(e) };
        if path.is_dir() {
            return Err(LoadError::Open { path: shown, reason: "it is a folder".into() });
        }
        // By the content alone: a name that promises another format is no reason to call a file damaged.
        let file = File::open(path).map_err(|e| open(&e))?;
        let reader = ImageReader::new(BufReader::new(file)).with_guessed_format().map_err(|e| open(&e))?;
        if reader.format().is_none() {
            return Err(LoadError::Format { path: shown });
        }
        let failed = |e: image::ImageError| match e {
            image::ImageError::IoError(e) if e.kind() == std::io::ErrorKind::NotFound => open(&e),
            image::ImageError::Unsupported(_) => LoadError::Format { path: shown.clone() },
            other => LoadError::Damaged {
                path: shown.clone(),
                reason: other.to_string().trim_end_matches('.').to_owned(),
            },
        };
        let mut decoder = reader.into_decoder().map_err(failed)?;
        let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
        let mut pixels = DynamicImage::from_decoder(decoder).map_err(failed)?;
        pixels.apply_orientation(orientation);
        let name = path.file_name().map_or_else(|| shown.clone(), |n| n.to_string_lossy().into_owned());
        Self::from_pixels(name, Some(path.to_owned()), pixels)
    }

    /// A picture from a file's bytes in memory, for built-in samples and dropped files.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, LoadError> {
        let pixels = image::load_from_memory(bytes)
            .map_err(|e| LoadError::Damaged { path: name.to_owned(), reason: e.to_string() })?;
        Self::from_pixels(name.to_owned(), None, pixels)
    }

    /// A picture from decoded pixels.
    pub fn from_pixels(name: String, path: Option<PathBuf>, pixels: DynamicImage) -> Result<Self, LoadError> {
        if pixels.width() == 0 || pixels.height() == 0 {
            return Err(LoadError::Empty { path: name });
        }
        let gray = gray_plane(&pixels);
        Ok(Self { name, path, pixels, gray })
    }

    /// Width and height.
    pub fn frame(&self) -> Frame {
        self.gray.frame()
    }
}

/// Luma (ITU-R BT.709 weights) in grey levels 0 ..= 255, without rounding to 8 bits.
fn gray_plane(pixels: &DynamicImage) -> GrayPlane {
    let frame = Frame::new(pixels.width() as usize, pixels.height() as usize);
    let values = match pixels {
        DynamicImage::ImageLuma8(luma) => luma.as_raw().iter().map(|v| f32::from(*v)).collect(),
        DynamicImage::ImageRgb8(rgb) => rgb
            .pixels()
            .map(|p| {
                let [r, g, b] = p.0.map(f32::from);
                0.2126 * r + 0.7152 * g + 0.0722 * b
            })
            .collect(),
        other => other.to_luma16().into_raw().into_iter().map(|v| f32::from(v) / 257.0).collect(),
    };
    GrayPlane::new(frame, values)
}

/// The system's words without its error number.
fn reason(e: &std::io::Error) -> String {
    match e.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".into(),
        std::io::ErrorKind::PermissionDenied => "it may not be read (permission denied)".into(),
        _ => e.to_string(),
    }
}
