//! Reading picture files into memory.

use std::borrow::Cow;
use std::io::{BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use image::{DynamicImage, GenericImageView as _};

use super::brightness::{Decoded, displayed, understood};
use super::decode::decode;
use super::luma::gray_plane;
use super::warp::{PixelMap, warp};
use super::{GrayPlane, Interpretation, LoadError, LoadOptions};
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
    /// Pixels with the depth and channels of the file. Numbers other than unsigned ones of 8 or 16 bits
    /// are converted to 16 bits. Pixels that are no picture are transparent.
    pub pixels: DynamicImage,
    /// Intensities used by all computations.
    pub gray: GrayPlane,
    /// Meaning of the numbers of the file.
    pub interpretation: Interpretation,
    /// Values of 16-bit pixels that are black and white.
    pub(crate) levels: [f32; 2],
}

impl Picture {
    /// Reads a file with the limits of the environment ([`LoadOptions::from_environment`]).
    ///
    /// Grey, colour and alpha channels of 8 bits, 16 bits and, in TIFF, of any other numbers are
    /// supported. The content determines the format. Piped data is read like a file.
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
        let decoded = match input.size {
            Some(_) => decode(BufReader::new(input.file), &shown, options)?,
            None => decode(Cursor::new(piped), &shown, options)?,
        };
        let name = path.file_name().map_or_else(|| shown.clone(), |n| escaped(&n.to_string_lossy()));
        Self::from_decoded(name, Some(path.to_owned()), decoded)
    }

    /// Decodes a file's bytes in memory with the default limits, for built-in samples.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, LoadError> {
        Self::from_bytes_with(name, bytes, LoadOptions::default())
    }

    /// Decodes a file's bytes in memory with the given options.
    pub fn from_bytes_with(name: &str, bytes: &[u8], options: LoadOptions) -> Result<Self, LoadError> {
        let decoded = decode(Cursor::new(bytes), name, options)?;
        Self::from_decoded(name.to_owned(), None, decoded)
    }

    /// Creates a picture from decoded pixels. Pixels of more than 8 bits get the range of their numbers.
    pub fn from_pixels(name: String, path: Option<PathBuf>, pixels: DynamicImage) -> Result<Self, LoadError> {
        Self::from_decoded(name, path, Decoded { pixels, range: None, no_data: None, bands: None })
    }

    fn from_decoded(name: String, path: Option<PathBuf>, decoded: Decoded) -> Result<Self, LoadError> {
        if decoded.pixels.width() == 0 || decoded.pixels.height() == 0 {
            return Err(LoadError::Empty(name));
        }
        let understood = understood(decoded).ok_or_else(|| LoadError::NotFinite(name.clone()))?;
        let gray = gray_plane(&understood.pixels, understood.levels);
        let masked = gray.masked();
        let interpretation =
            Interpretation { masked: (masked > 0.0).then_some(masked), ..understood.interpretation };
        Ok(Self { name, path, pixels: understood.pixels, gray, interpretation, levels: understood.levels })
    }

    /// Returns a picture of pixels drawn from this one: with the same range of numbers.
    #[must_use]
    pub fn with_pixels(&self, name: String, pixels: DynamicImage) -> Self {
        let gray = gray_plane(&pixels, self.levels);
        Self { name, path: None, gray, pixels, interpretation: self.interpretation, levels: self.levels }
    }

    /// Returns the picture with the range of numbers of another one, so that equal numbers are equally
    /// bright in both. Pictures of 8 bits stay as they are.
    #[must_use]
    pub fn in_range_of(self, other: &Self) -> Self {
        let (Some([low, high]), Some(range)) = (self.interpretation.range, other.interpretation.range) else {
            return self;
        };
        // Values of the pixels follow the numbers of the file linearly.
        let [black, white] = self.levels.map(f64::from);
        let level = |number: f64| (black + (number - low) * (white - black) / (high - low)) as f32;
        let levels = range.map(level);
        if !levels.iter().all(|v| v.is_finite()) {
            return self;
        }
        let interpretation = Interpretation { range: Some(range), ..self.interpretation };
        Self { gray: gray_plane(&self.pixels, levels), levels, interpretation, ..self }
    }

    /// Returns a part of the pixels, or pixels drawn from them, as they are shown: with the range of
    /// this picture from black to white.
    pub fn displayed<'p>(&self, part: &'p DynamicImage) -> Cow<'p, DynamicImage> {
        let is_plain = self.levels.map(f32::to_bits) == [0.0, 65535.0].map(f32::to_bits)
            || self.levels[0] >= self.levels[1];
        if is_plain { Cow::Borrowed(part) } else { Cow::Owned(displayed(part, self.levels)) }
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
        Self { path: self.path.clone(), ..self.with_pixels(self.name.clone(), pixels) }
    }

    /// Returns red, green and blue of the pixel nearest to a point.
    pub fn color_at(&self, point: Point) -> [u8; 3] {
        let at = |v: f64, size: u32| v.round().clamp(0.0, f64::from(size.saturating_sub(1))) as u32;
        let (x, y) = (at(point.x, self.pixels.width()), at(point.y, self.pixels.height()));
        let pixel = self.pixels.crop_imm(x, y, 1, 1);
        let [red, green, blue, _] = self.displayed(&pixel).get_pixel(0, 0).0;
        [red, green, blue]
    }

    /// Returns width and height.
    pub fn frame(&self) -> Frame {
        self.gray.frame()
    }
}
