//! Grey TIFF files with floating-point or wide integer samples, as written by measuring instruments
//! and simulations.
//!
//! The brightness of such numbers has no convention: ranges of 0 to 1 and 0 to 255 are both common.
//! The range of the numbers decides between the two; all other numbers are stretched from their
//! minimum to their maximum.

use std::io::{BufRead, Seek};

use image::DynamicImage;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

/// A grey TIFF file that the general decoder does not support.
pub(super) struct DeepTiff<R: BufRead + Seek> {
    decoder: Decoder<R>,
    /// Width and height, px.
    pub size: [u32; 2],
    /// Bytes per pixel, both in the file and while reading.
    pub bytes_a_pixel: u64,
}

impl<R: BufRead + Seek> DeepTiff<R> {
    /// Reads the header of such a grey TIFF file. Returns `None` for every other file.
    pub fn open(reader: R) -> Option<Self> {
        const UNSIGNED: u16 = 1;
        let mut decoder = Decoder::new(reader).ok()?;
        let ColorType::Gray(bits) = decoder.colortype().ok()? else { return None };
        let kind = decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat).ok()?;
        let kind = kind.and_then(|kinds| kinds.first().copied()).unwrap_or(UNSIGNED);
        let is_ordinary = kind == UNSIGNED && bits <= 16;
        if is_ordinary || ![8, 16, 32, 64].contains(&bits) {
            return None;
        }
        let (width, height) = decoder.dimensions().ok()?;
        Some(Self { decoder, size: [width, height], bytes_a_pixel: u64::from(bits / 8) })
    }

    /// Reads all pixels, converted to 16 bits. `None` when some are not finite.
    pub fn read(self) -> Result<Option<DynamicImage>, TiffError> {
        let [width, height] = self.size;
        let bytes = u64::from(width) * u64::from(height) * self.bytes_a_pixel;
        let mut limits = Limits::default();
        limits.decoding_buffer_size = usize::try_from(bytes).unwrap_or(usize::MAX);
        limits.intermediate_buffer_size = limits.decoding_buffer_size;
        let pixels = self.decoder.with_limits(limits).read_image()?;
        let pixels = match pixels {
            DecodingResult::F16(values) => bright(&values, |v| f64::from(v.to_f32())),
            DecodingResult::F32(values) => bright(&values, |v| f64::from(*v)),
            DecodingResult::F64(values) => bright(&values, |v| *v),
            DecodingResult::I8(values) => bright(&values, |v| f64::from(*v)),
            DecodingResult::I16(values) => bright(&values, |v| f64::from(*v)),
            DecodingResult::I32(values) => bright(&values, |v| f64::from(*v)),
            DecodingResult::I64(values) => bright(&values, |v| *v as f64),
            DecodingResult::U8(values) => bright(&values, |v| f64::from(*v)),
            DecodingResult::U16(values) => bright(&values, |v| f64::from(*v)),
            DecodingResult::U32(values) => bright(&values, |v| f64::from(*v)),
            DecodingResult::U64(values) => bright(&values, |v| *v as f64),
        };
        let image =
            |pixels| image::ImageBuffer::from_raw(width, height, pixels).ok_or(TiffError::IntSizeError);
        Ok(pixels.map(image).transpose()?.map(DynamicImage::ImageLuma16))
    }
}

/// Converts floating-point colours beyond 0 to 1 to 16 bits. Returns `None` when some are not
/// finite.
pub(super) fn within_unit(pixels: DynamicImage) -> Option<DynamicImage> {
    fn is_within(values: &[f32]) -> bool {
        values.iter().all(|v| (0.0..=1.0).contains(v))
    }
    let (width, height) = (pixels.width(), pixels.height());
    let number = |v: &f32| f64::from(*v);
    match &pixels {
        DynamicImage::ImageRgb32F(rgb) if !is_within(rgb.as_raw()) => {
            let raw = bright(rgb.as_raw(), number)?;
            image::ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageRgb16)
        }
        DynamicImage::ImageRgba32F(rgb) if !is_within(rgb.as_raw()) => {
            let raw = bright(rgb.as_raw(), number)?;
            image::ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageRgba16)
        }
        _ => Some(pixels),
    }
}

/// Converts numbers to 16 bits. Returns `None` when some are not finite.
fn bright<T>(values: &[T], number: impl Fn(&T) -> f64) -> Option<Vec<u16>> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.iter().map(&number) {
        if !value.is_finite() {
            return None;
        }
        (low, high) = (low.min(value), high.max(value));
    }
    let [offset, factor] = scale(low, high);
    Some(values.iter().map(|v| (offset + factor * number(v)).round().clamp(0.0, 65535.0) as u16).collect())
}

/// Returns the linear scale from numbers between `low` and `high` to brightness, 0 ..= 65535: offset and
/// factor.
fn scale(low: f64, high: f64) -> [f64; 2] {
    // Numbers meant as 0 to 255 exceed even the highlights of numbers meant as 0 to 1.
    let (low, span) = match high {
        _ if low < 0.0 => (low, high - low),
        ..=1.0 => (0.0, 1.0),
        16.0..=255.0 => (0.0, 255.0),
        _ => (low, high - low),
    };
    let factor = 65535.0 / span;
    // All numbers are equal, or the span overflows: every pixel becomes black.
    if factor.is_finite() && factor > 0.0 { [-low * factor, factor] } else { [0.0; 2] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_of_the_numbers_tells_what_they_mean() {
        let levels = |values: &[f64]| bright(values, |v| *v);
        // A number half way between two levels may round either way.
        let middle = |values: &[f64]| levels(values).map(|l| [l[0], l[1] / 2 * 2, l[2]]);
        assert_eq!(levels(&[0.0, 0.5, 1.0]), Some(vec![0, 32768, 65535]));
        assert_eq!(levels(&[0.0, 100.0, 255.0]), Some(vec![0, 25700, 65535]));
        assert_eq!(levels(&[2.0, 1000.0]), Some(vec![0, 65535]));
        assert_eq!(levels(&[0.0, 1.02]), Some(vec![0, 65535]));
        assert!(matches!(middle(&[-1.0, 0.0, 1.0]), Some([0, 32766..=32768, 65535])));
        assert!(matches!(middle(&[1e6, 2e6, 3e6]), Some([0, 32766..=32768, 65535])));
        assert_eq!(levels(&[-3.0, -3.0]), Some(vec![0, 0]));
        assert_eq!(levels(&[f64::MIN, f64::MAX]), Some(vec![0, 0]));
        assert_eq!(levels(&[0.5, f64::NAN]), None);
        assert_eq!(levels(&[0.5, f64::INFINITY]), None);
    }
}
