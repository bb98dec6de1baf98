//! TIFF files of the kinds that the general decoder does not read: other numbers than unsigned ones of
//! 8 or 16 bits, palettes, several bands, luma with colour differences, Zstandard compression.

use std::io::{BufRead, Seek};

use image::{DynamicImage, ImageBuffer};
use tiff::TiffError;
use tiff::decoder::{Decoder, DecodingResult, Limits};

use super::brightness::Decoded;
use super::numbers::{Number, Numbers};
use super::tiff_header::{PHOTOMETRIC, TiffHeader};
use super::tiff_overlay::Overlay;
use super::tiff_tags::{Colours, TiffTags, ZSTD};
use crate::geometry::Frame;

/// A fault of a file.
pub(super) enum TiffFault {
    /// An error of the decoder, or of the file.
    Decoder(TiffError),
    Damaged(&'static str),
    /// The kind of pixels, which is not read.
    Pixels(String),
    /// No pixel has a finite number.
    NotFinite,
}

impl<E: Into<TiffError>> From<E> for TiffFault {
    fn from(error: E) -> Self {
        Self::Decoder(error.into())
    }
}

/// Reads a picture whose size was checked. `most_bytes` limits what its compressed parts hold.
pub(super) fn read(
    header: &TiffHeader,
    tags: &TiffTags,
    reader: impl BufRead + Seek,
    most_bytes: u64,
) -> Result<Decoded, TiffFault> {
    const BLACK_IS_ZERO: u16 = 1;
    if tags.colours == Colours::Cmyk {
        return Err(TiffFault::Pixels("CMYK with a rare depth or compression".to_owned()));
    }
    if tags.bits < 8 && tags.samples > 1 {
        return Err(TiffFault::Pixels(format!("{} samples of {} bits", tags.samples, tags.bits)));
    }
    let mut file = Overlay::new(reader, header.length);
    if tags.compression == ZSTD
        && let Some(fault) = file.decompress(header, tags.chunks().within(most_bytes))?
    {
        return Err(TiffFault::Damaged(fault));
    }
    // The decoder reads indices, and colours with a sample of unknown meaning, as bands.
    let is_open = tags.colours == Colours::Rgb && tags.samples > 3 && tags.extra == 0;
    if tags.colours == Colours::Palette || is_open {
        file.set_short(header, PHOTOMETRIC, BLACK_IS_ZERO);
    }
    let [width, height] = tags.size;
    let bytes = (u64::from(width) * u64::from(height)).saturating_mul(tags.bytes_a_pixel());
    let mut limits = Limits::default();
    limits.decoding_buffer_size = usize::try_from(bytes).unwrap_or(usize::MAX);
    limits.intermediate_buffer_size = limits.decoding_buffer_size.max(limits.intermediate_buffer_size);
    let mut decoder = Decoder::new(file)?.with_limits(limits);
    let mut pixels = DecodingResult::U8(Vec::new());
    let layout = decoder.read_image_to_buffer(&mut pixels)?;
    let picture = Layout::new(tags, layout.planes);
    let decoded = match pixels {
        DecodingResult::U8(values) if tags.bits < 8 => picture.with_palette(tags, &unpacked(tags, &values)),
        DecodingResult::U8(values) if tags.colours == Colours::Palette => picture.with_palette(tags, &values),
        DecodingResult::U16(values) if tags.colours == Colours::Palette => {
            picture.with_palette(tags, &values)
        }
        DecodingResult::U8(values) if tags.colours == Colours::YCbCr => {
            Ok(rgb_from_ycbcr(&picture.chosen(&values)))
        }
        DecodingResult::U8(values) => Ok(picture.chosen(&values)),
        DecodingResult::U16(values) => {
            return picture.decoded(tags, picture.dynamic16(picture.chosen(&values)));
        }
        DecodingResult::F16(values) => {
            return picture.stretched(tags, &values.iter().map(|v| v.to_f32()).collect::<Vec<_>>());
        }
        DecodingResult::F32(values) => return picture.stretched(tags, &values),
        DecodingResult::F64(values) => return picture.stretched(tags, &values),
        DecodingResult::I8(values) => return picture.stretched(tags, &values),
        DecodingResult::I16(values) => return picture.stretched(tags, &values),
        DecodingResult::I32(values) => return picture.stretched(tags, &values),
        DecodingResult::I64(values) => return picture.stretched(tags, &values),
        DecodingResult::U32(values) => return picture.stretched(tags, &values),
        DecodingResult::U64(values) => return picture.stretched(tags, &values),
    }?;
    picture.decoded(tags, picture.dynamic8(decoded))
}

/// Which samples of a pixel are used.
struct Layout {
    frame: Frame,
    /// Samples of a pixel as read.
    samples: usize,
    /// Number of planes, if each sample has a plane of its own; else 1.
    planes: usize,
    /// Colours used: 1 or 3.
    colours: usize,
    has_alpha: bool,
    /// Number of bands, if only the first is used.
    bands: Option<u16>,
}

impl Layout {
    fn new(tags: &TiffTags, planes: usize) -> Self {
        let [width, height] = tags.size.map(|v| v as usize);
        let all = tags.samples as usize;
        let colours = if matches!(tags.colours, Colours::Rgb | Colours::YCbCr) { 3 } else { 1 };
        let has_alpha =
            tags.has_alpha && all > colours && matches!(tags.colours, Colours::Gray | Colours::Rgb);
        // The decoder leaves out samples beside the colours, but not those of grey pictures.
        let is_reduced = colours == 3 && tags.extra > 0;
        let samples = if is_reduced { colours + usize::from(has_alpha) } else { all };
        let used = if has_alpha { 2 } else { 1 };
        let bands = (colours == 1 && all > used).then_some(all.min(usize::from(u16::MAX)) as u16);
        Self { frame: Frame::new(width, height), samples, planes, colours, has_alpha, bands }
    }

    fn channels(&self) -> usize {
        self.colours + usize::from(self.has_alpha)
    }

    /// Returns the samples that are used, pixel by pixel.
    fn chosen<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let pixels = self.frame.width * self.frame.height;
        let channels = self.channels();
        let place = |k: usize| {
            let (pixel, channel) = (k / channels, k % channels);
            if self.planes > 1 { channel * pixels + pixel } else { pixel * self.samples + channel }
        };
        (0..pixels * channels).filter_map(|k| values.get(place(k)).copied()).collect()
    }

    fn stretched<T: Number>(&self, tags: &TiffTags, values: &[T]) -> Result<Decoded, TiffFault> {
        let values = self.chosen(values);
        let numbers = Numbers {
            values: &values,
            frame: self.frame,
            channels: self.channels(),
            has_alpha: self.has_alpha,
        };
        let meaning = numbers.meaning(tags.no_data);
        if meaning.is_empty() {
            return Err(TiffFault::NotFinite);
        }
        let levels = numbers.stretched(&meaning);
        let has_alpha = self.has_alpha || meaning.valid.is_some();
        let picture = Self { has_alpha, ..*self };
        let mut decoded = picture.decoded(tags, picture.dynamic16(levels))?;
        decoded.range = Some(meaning.range);
        Ok(decoded)
    }

    /// Returns the colours of a palette, or grey levels without one.
    fn with_palette<T: Copy + Into<usize>>(
        &self,
        tags: &TiffTags,
        values: &[T],
    ) -> Result<Vec<u8>, TiffFault> {
        let indices = self.chosen(values);
        if tags.colours != Colours::Palette {
            let most = (1usize << tags.bits) - 1;
            return Ok(indices.iter().map(|v| ((*v).into() * 255 / most).min(255) as u8).collect());
        }
        let count = tags.palette.len() / 3;
        // Some programs write palettes of 8 bits.
        let is_deep = tags.palette.iter().any(|v| *v > 255);
        let level = |v: u64| if is_deep { v / 257 } else { v }.min(255) as u8;
        let mut colours = Vec::with_capacity(3 * indices.len());
        for index in indices {
            let index = index.into();
            if index >= count {
                return Err(TiffFault::Damaged("a pixel has no colour in its palette"));
            }
            colours.extend([0, 1, 2].map(|channel| level(tags.palette[channel * count + index])));
        }
        Ok(colours)
    }

    fn dynamic8(&self, raw: Vec<u8>) -> Option<DynamicImage> {
        let (width, height) = (self.frame.width as u32, self.frame.height as u32);
        let pixels = self.frame.width * self.frame.height;
        match raw.len() / pixels.max(1) {
            1 => ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageLuma8),
            2 => ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageLumaA8),
            3 => ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageRgb8),
            _ => ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageRgba8),
        }
    }

    fn dynamic16(&self, raw: Vec<u16>) -> Option<DynamicImage> {
        let (width, height) = (self.frame.width as u32, self.frame.height as u32);
        match self.channels() {
            1 => ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageLuma16),
            2 => ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageLumaA16),
            3 => ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageRgb16),
            _ => ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageRgba16),
        }
    }

    fn decoded(&self, tags: &TiffTags, pixels: Option<DynamicImage>) -> Result<Decoded, TiffFault> {
        let pixels = pixels.ok_or(TiffFault::Damaged("its pixels are not all there"))?;
        Ok(Decoded { pixels, range: None, no_data: tags.no_data, bands: self.bands })
    }
}

/// Returns the samples of rows that are packed into bytes.
fn unpacked(tags: &TiffTags, values: &[u8]) -> Vec<u8> {
    let [width, height] = tags.size.map(|v| v as usize);
    let bits = tags.bits as usize;
    let row = (width * bits).div_ceil(8);
    let mask = (1u16 << bits) - 1;
    let sample = |row: &[u8], x: usize| {
        // A sample of 3, 5, 6 or 7 bits may cross the border of a byte.
        let two = u16::from_be_bytes([row[x * bits / 8], row.get(x * bits / 8 + 1).copied().unwrap_or(0)]);
        (two >> (16 - bits - x * bits % 8) & mask) as u8
    };
    let rows = values.chunks_exact(row.max(1)).take(height);
    rows.flat_map(|row| (0..width).map(move |x| sample(row, x))).collect()
}

/// Converts luma and colour differences as JFIF does (ITU-R BT.601, full range).
fn rgb_from_ycbcr(values: &[u8]) -> Vec<u8> {
    let level = |v: f32| v.round().clamp(0.0, 255.0) as u8;
    let pixels = values.as_chunks::<3>().0.iter();
    let colour = |[y, cb, cr]: &[u8; 3]| {
        let [y, cb, cr] = [f32::from(*y), f32::from(*cb) - 128.0, f32::from(*cr) - 128.0];
        [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb].map(level)
    };
    pixels.flat_map(colour).collect()
}
