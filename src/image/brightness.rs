//! The numbers of decoded pixels, read as brightness.

use image::{DynamicImage, ImageBuffer};

use super::Interpretation;
use super::numbers::{Meaning, Number, Numbers};
use crate::geometry::Frame;

/// The pixels of a file, and what the file says of them.
pub(super) struct Decoded {
    pub pixels: DynamicImage,
    /// Numbers of the file that became black and white, if the pixels were converted to 16 bits.
    pub range: Option<[f64; 2]>,
    /// The value that the file declares as missing data.
    pub no_data: Option<f64>,
    /// Number of bands, if only the first is used.
    pub bands: Option<u16>,
}

/// Pixels with the meaning of their numbers.
pub(super) struct Understood {
    /// 8 or 16 bits. Pixels that are no picture are transparent.
    pub pixels: DynamicImage,
    /// Values of 16-bit pixels that are black and white.
    pub levels: [f32; 2],
    pub interpretation: Interpretation,
}

/// Values of black and white of pixels that use all of 16 bits.
const ALL: [f32; 2] = [0.0, 65535.0];

/// Finds the range of the numbers, and the pixels that are no picture. `None` if no pixel is.
pub(super) fn understood(decoded: Decoded) -> Option<Understood> {
    let Decoded { pixels, range, no_data, bands } = decoded;
    let of = |range| Interpretation { range, bands, ..Interpretation::default() };
    if range.is_some() {
        return Some(Understood { pixels, levels: ALL, interpretation: of(range) });
    }
    let frame = Frame::new(pixels.width() as usize, pixels.height() as usize);
    let color = pixels.color();
    let (channels, has_alpha) = (color.channel_count().into(), color.has_alpha());
    let depth = usize::from(color.bytes_per_pixel()) / channels;
    let meaning = match &pixels {
        // 8 bits are used as they are, but for missing data.
        _ if depth == 1 => {
            let bytes = pixels.as_bytes();
            let valid = no_data
                .and_then(|value| Numbers { values: bytes, frame, channels, has_alpha }.flags(Some(value)));
            Meaning { range: [0.0, 255.0], valid }
        }
        DynamicImage::ImageLuma16(p) => meaning(p, frame, [1, 0], no_data),
        DynamicImage::ImageLumaA16(p) => meaning(p, frame, [2, 1], no_data),
        DynamicImage::ImageRgb16(p) => meaning(p, frame, [3, 0], no_data),
        DynamicImage::ImageRgba16(p) => meaning(p, frame, [4, 1], no_data),
        DynamicImage::ImageRgb32F(p) => return stretched(p, frame, no_data),
        DynamicImage::ImageRgba32F(p) => return stretched(p, frame, no_data),
        // Future versions of the decoders may add pixel formats.
        _ => Meaning { range: ALL.map(f64::from), valid: None },
    };
    if meaning.is_empty() {
        return None;
    }
    let levels = if depth == 1 { ALL } else { meaning.range.map(|v| v as f32) };
    let range = (depth > 1).then_some(meaning.range);
    let pixels = match meaning.valid {
        Some(valid) => transparent(pixels, &valid),
        None => pixels,
    };
    Some(Understood { pixels, levels, interpretation: of(range) })
}

fn meaning<T: Number>(
    values: &[T],
    frame: Frame,
    [channels, alphas]: [usize; 2],
    no_data: Option<f64>,
) -> Meaning {
    Numbers { values, frame, channels, has_alpha: alphas > 0 }.meaning(no_data)
}

/// Converts floating-point colours to 16 bits.
fn stretched(values: &[f32], frame: Frame, no_data: Option<f64>) -> Option<Understood> {
    let channels = values.len() / (frame.width * frame.height).max(1);
    let numbers = Numbers { values, frame, channels, has_alpha: channels == 4 };
    let meaning = numbers.meaning(no_data);
    if meaning.is_empty() {
        return None;
    }
    let raw = numbers.stretched(&meaning);
    let (width, height) = (frame.width as u32, frame.height as u32);
    let pixels = if channels == 4 || meaning.valid.is_some() {
        ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageRgba16)
    } else {
        ImageBuffer::from_raw(width, height, raw).map(DynamicImage::ImageRgb16)
    };
    let interpretation = Interpretation { range: Some(meaning.range), ..Interpretation::default() };
    Some(Understood { pixels: pixels?, levels: ALL, interpretation })
}

/// Makes the pixels that are no picture transparent, with their colours kept.
fn transparent(pixels: DynamicImage, valid: &[bool]) -> DynamicImage {
    fn clear<T: Default>(raw: &mut [T], channels: usize, valid: &[bool]) {
        let pixels = raw.chunks_exact_mut(channels).zip(valid);
        for alpha in pixels.filter(|(_, valid)| !**valid).filter_map(|(pixel, _)| pixel.last_mut()) {
            *alpha = T::default();
        }
    }
    let mut pixels = match pixels {
        DynamicImage::ImageLuma8(_) => DynamicImage::ImageLumaA8(pixels.to_luma_alpha8()),
        DynamicImage::ImageRgb8(_) => DynamicImage::ImageRgba8(pixels.to_rgba8()),
        DynamicImage::ImageLuma16(_) => DynamicImage::ImageLumaA16(pixels.to_luma_alpha16()),
        DynamicImage::ImageRgb16(_) => DynamicImage::ImageRgba16(pixels.to_rgba16()),
        with_alpha => with_alpha,
    };
    match &mut pixels {
        DynamicImage::ImageLumaA8(p) => clear(p, 2, valid),
        DynamicImage::ImageRgba8(p) => clear(p, 4, valid),
        DynamicImage::ImageLumaA16(p) => clear(p, 2, valid),
        DynamicImage::ImageRgba16(p) => clear(p, 4, valid),
        _ => {}
    }
    pixels
}

/// Returns 16-bit pixels with black at 0 and white at 65535. Alpha stays.
pub(super) fn displayed(pixels: &DynamicImage, [black, white]: [f32; 2]) -> DynamicImage {
    let step = (white - black) / 65535.0;
    let level = |v: &mut u16| *v = ((f32::from(*v) - black) / step).round().clamp(0.0, 65535.0) as u16;
    let mut shown = pixels.clone();
    match &mut shown {
        DynamicImage::ImageLuma16(p) => p.iter_mut().for_each(level),
        DynamicImage::ImageRgb16(p) => p.iter_mut().for_each(level),
        DynamicImage::ImageLumaA16(p) => p.as_chunks_mut::<2>().0.iter_mut().for_each(|[v, _]| level(v)),
        DynamicImage::ImageRgba16(p) => {
            p.as_chunks_mut::<4>()
                .0
                .iter_mut()
                .for_each(|[colours @ .., _]| colours.iter_mut().for_each(level));
        }
        _ => {}
    }
    shown
}
