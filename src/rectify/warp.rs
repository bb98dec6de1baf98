//! Drawing a rectified picture.

use image::{DynamicImage, ImageBuffer, Luma, LumaA, Pixel, Rgb, Rgba};
use rayon::prelude::*;

use super::map::ImageMap;
use crate::cancel::CancelFlag;
use crate::geometry::{Frame, Point};

/// The picture, with an alpha channel. `None` when cancelled.
pub(super) fn warp(
    original: &DynamicImage,
    map: &ImageMap,
    size: Frame,
    cancel: &CancelFlag,
) -> Option<DynamicImage> {
    let frame = Frame::new(original.width() as usize, original.height() as usize);
    let job = Job { map, frame, size, cancel };
    Some(match original {
        DynamicImage::ImageLuma8(b) => job.opaque::<Luma<u8>, LumaA<u8>, 1, 2>(b)?.into(),
        DynamicImage::ImageLumaA8(b) => job.transparent::<LumaA<u8>, 2>(b)?.into(),
        DynamicImage::ImageRgb8(b) => job.opaque::<Rgb<u8>, Rgba<u8>, 3, 4>(b)?.into(),
        DynamicImage::ImageRgba8(b) => job.transparent::<Rgba<u8>, 4>(b)?.into(),
        DynamicImage::ImageLuma16(b) => job.opaque::<Luma<u16>, LumaA<u16>, 1, 2>(b)?.into(),
        DynamicImage::ImageLumaA16(b) => job.transparent::<LumaA<u16>, 2>(b)?.into(),
        DynamicImage::ImageRgb16(b) => job.opaque::<Rgb<u16>, Rgba<u16>, 3, 4>(b)?.into(),
        DynamicImage::ImageRgba16(b) => job.transparent::<Rgba<u16>, 4>(b)?.into(),
        DynamicImage::ImageRgb32F(b) => job.opaque::<Rgb<f32>, Rgba<f32>, 3, 4>(b)?.into(),
        DynamicImage::ImageRgba32F(b) => job.transparent::<Rgba<f32>, 4>(b)?.into(),
        other => job.transparent::<Rgba<u16>, 4>(&other.to_rgba16())?.into(),
    })
}

/// One value of a pixel.
trait Sample: image::Primitive + Send + Sync {
    /// What full opacity is.
    const OPAQUE: Self;
    /// As a number.
    fn number(self) -> f64;
    /// The nearest value.
    fn nearest(number: f64) -> Self;
}

macro_rules! whole_numbers {
    ($($t:ty),*) => { $(impl Sample for $t {
        const OPAQUE: Self = <$t>::MAX;
        fn number(self) -> f64 {
            f64::from(self)
        }
        fn nearest(number: f64) -> Self {
            number.round() as $t
        }
    })* };
}
whole_numbers!(u8, u16);

impl Sample for f32 {
    const OPAQUE: Self = 1.0;
    fn number(self) -> f64 {
        f64::from(self)
    }
    fn nearest(number: f64) -> Self {
        number as f32
    }
}

type Buffer<P> = ImageBuffer<P, Vec<<P as Pixel>::Subpixel>>;

struct Job<'a> {
    map: &'a ImageMap,
    frame: Frame,
    size: Frame,
    cancel: &'a CancelFlag,
}

impl Job<'_> {
    /// From `N` opaque channels to `M = N + 1`.
    fn opaque<P, Q, const N: usize, const M: usize>(&self, original: &Buffer<P>) -> Option<Buffer<Q>>
    where
        P: Pixel,
        Q: Pixel<Subpixel = P::Subpixel>,
        P::Subpixel: Sample,
    {
        let samples: &[P::Subpixel] = original.as_raw();
        self.draw::<P::Subpixel, M>(|cell| {
            let mut out = [P::Subpixel::OPAQUE; M];
            for (c, value) in out.iter_mut().take(N).enumerate() {
                let mixed: f64 =
                    cell.corners.iter().map(|(i, weight)| samples[i * N + c].number() * weight).sum();
                *value = P::Subpixel::nearest(mixed);
            }
            out
        })
        .and_then(|raw| Buffer::from_raw(self.size.width as u32, self.size.height as u32, raw))
    }

    /// `N` channels of which the last is alpha. Colours count by their opacity, so that what is invisible does not
    /// show at the edges.
    fn transparent<P, const N: usize>(&self, original: &Buffer<P>) -> Option<Buffer<P>>
    where
        P: Pixel,
        P::Subpixel: Sample,
    {
        let samples: &[P::Subpixel] = original.as_raw();
        self.draw::<P::Subpixel, N>(|cell| {
            let mut out = [P::Subpixel::nearest(0.0); N];
            let alpha: f64 = cell.corners.iter().map(|(i, w)| samples[i * N + N - 1].number() * w).sum();
            if alpha > 0.0 {
                for (c, value) in out.iter_mut().take(N - 1).enumerate() {
                    let mixed: f64 = cell
                        .corners
                        .iter()
                        .map(|(i, w)| samples[i * N + c].number() * samples[i * N + N - 1].number() * w)
                        .sum();
                    *value = P::Subpixel::nearest(mixed / alpha);
                }
                out[N - 1] = P::Subpixel::nearest(alpha);
            }
            out
        })
        .and_then(|raw| Buffer::from_raw(self.size.width as u32, self.size.height as u32, raw))
    }

    /// All pixels of `M` channels; those without an original stay zero, which is transparent.
    fn draw<T: Sample, const M: usize>(&self, mix: impl Fn(&Cell) -> [T; M] + Sync) -> Option<Vec<T>> {
        let mut raw = vec![T::nearest(0.0); self.size.width * self.size.height * M];
        raw.par_chunks_exact_mut(self.size.width * M).enumerate().try_for_each(|(y, row)| {
            if self.cancel.is_cancelled() {
                return None;
            }
            let trace = self.map.row(y as f64);
            for (x, pixel) in row.as_chunks_mut::<M>().0.iter_mut().enumerate() {
                if let Some(cell) = trace.at(x as f64).and_then(|p| Cell::new(self.frame, p)) {
                    *pixel = mix(&cell);
                }
            }
            Some(())
        })?;
        Some(raw)
    }
}

/// Four neighbouring pixels and their bilinear weights.
struct Cell {
    corners: [(usize, f64); 4],
}

impl Cell {
    /// Around a position; `None` outside the pixels of the image. The outer half pixel takes the border's values.
    #[inline]
    fn new(frame: Frame, p: Point) -> Option<Self> {
        if !frame.contains(p) {
            return None;
        }
        let (x, y) = (p.x.clamp(0.0, frame.right()), p.y.clamp(0.0, frame.bottom()));
        let (i, j) = ((x as usize).min(frame.width - 2), (y as usize).min(frame.height - 2));
        let (fx, fy) = (x - i as f64, y - j as f64);
        let first = j * frame.width + i;
        Some(Self {
            corners: [
                (first, (1.0 - fx) * (1.0 - fy)),
                (first + 1, fx * (1.0 - fy)),
                (first + frame.width, (1.0 - fx) * fy),
                (first + frame.width + 1, fx * fy),
            ],
        })
    }
}
