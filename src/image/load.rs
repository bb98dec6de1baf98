//! Reading picture files into memory.

use std::io::{BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use image::{DynamicImage, GenericImageView as _};

use super::decode::decode;
use super::luma::gray_plane;
use super::warp::{PixelMap, warp};
use super::{GrayPlane, LoadError, LoadOptions};
use crate::cancel::CancelFlag;
use crate::foreign::{escaped, open_input, reason, shown_path};
use crate::geometry::{Frame, Point};

/// A loaded picture: the pixels of the file, upright by its EXIF orientation, and their grey plane.
///
/// A picture takes the bytes of its pixels and four more bytes per pixel. Clones share the grey
/// plane.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Name for display: the file name, or the name of a built-in sample.
    pub name: String,
    /// Path of the source file, if any.
    pub path: Option<PathBuf>,
    /// Pixels with the depth and channels of the file. Grey floating-point pixels, and
    /// floating-point colours beyond 0 to 1, are converted to 16 bits.
    pub pixels: DynamicImage,
    /// Intensities used by all computations.
    pub gray: GrayPlane,
}

impl Picture {
    /// Reads a file with the limits of the environment ([`LoadOptions::from_environment`]).
    ///
    /// Grey, colour and alpha channels of 8 bits, 16 bits or floating point are supported. The
    /// content determines the format. Piped data is read like a file.
    pub fn open(path: &Path) -> Result<Self, LoadError> {
        Self::open_with(path, LoadOptions::from_environment()?)
    }

    /// Reads a file with the given options.
    pub fn open_with(path: &Path, options: LoadOptions) -> Result<Self, LoadError> {
        let shown = shown_path(path);
        let failed = |reason| LoadError::Open(shown.clone(), reason);
        let input = open_input(path).map_err(failed)?;
        // Any reasonable picture compresses to fewer bytes than its pixels.
        let most_bytes = options.most_pixels.saturating_mul(super::limit::WIDE_PIXEL).max(1 << 20);
        let mut piped = Vec::new();
        if input.size.is_none() {
            // Decoders seek back and forth, so piped data is buffered.
            let read = (&input.file).take(most_bytes + 1).read_to_end(&mut piped);
            read.map_err(|e| failed(reason(&e)))?;
        }
        let size = input.size.unwrap_or(piped.len() as u64);
        if size == 0 {
            return Err(failed("the file is empty".to_owned()));
        }
        if size > most_bytes {
            return Err(LoadError::LongFile { path: shown, megabytes: most_bytes / 1_000_000 });
        }
        let pixels = match input.size {
            Some(_) => decode(BufReader::new(input.file), &shown, options)?,
            None => decode(Cursor::new(piped), &shown, options)?,
        };
        let name = path.file_name().map_or_else(|| shown.clone(), |n| escaped(&n.to_string_lossy()));
        Self::from_pixels(name, Some(path.to_owned()), pixels)
    }

    /// Decodes a file's bytes in memory with the default limits, for built-in samples.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, LoadError> {
        Self::from_bytes_with(name, bytes, LoadOptions::default())
    }

    /// Decodes a file's bytes in memory with the given options.
    pub fn from_bytes_with(name: &str, bytes: &[u8], options: LoadOptions) -> Result<Self, LoadError> {
        let pixels = decode(Cursor::new(bytes), name, options)?;
        Self::from_pixels(name.to_owned(), None, pixels)
    }

    /// Creates a picture from decoded pixels.
    pub fn from_pixels(name: String, path: Option<PathBuf>, pixels: DynamicImage) -> Result<Self, LoadError> {
        if pixels.width() == 0 || pixels.height() == 0 {
            return Err(LoadError::Empty(name));
        }
        let gray = gray_plane(&pixels);
        Ok(Self { name, path, pixels, gray })
    }

    /// Draws a new picture of the same depth and colours. Each of its pixels takes the value at a
    /// `position` of this picture.
    #[must_use]
    pub fn redrawn(&self, size: Frame, position: impl Fn(Point) -> Option<Point> + Sync) -> Self {
        struct Map<F>(F);
        impl<F: Fn(Point) -> Option<Point> + Sync> PixelMap for Map<F> {
            fn row(&self, y: usize) -> impl Fn(usize) -> Option<Point> {
                move |x| (self.0)(Point::new(x as f64, y as f64))
            }
        }
        let drawn = warp(&self.pixels, &Map(position), size, &CancelFlag::default());
        // Nothing cancels the drawing.
        let pixels = drawn.unwrap_or_default();
        Self { name: self.name.clone(), path: self.path.clone(), gray: gray_plane(&pixels), pixels }
    }

    /// Returns red, green and blue of the pixel nearest to a point.
    pub fn color_at(&self, point: Point) -> [u8; 3] {
        let at = |v: f64, size: u32| v.round().clamp(0.0, f64::from(size.saturating_sub(1))) as u32;
        let (x, y) = (at(point.x, self.pixels.width()), at(point.y, self.pixels.height()));
        let [red, green, blue, _] = self.pixels.get_pixel(x, y).0;
        [red, green, blue]
    }

    /// Returns width and height.
    pub fn frame(&self) -> Frame {
        self.gray.frame()
    }
}
