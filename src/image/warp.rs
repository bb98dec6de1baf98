//! Drawing of a picture through a map of its pixels.

use image::{DynamicImage, ImageBuffer, Luma, LumaA, Pixel, Rgb, Rgba};
use rayon::prelude::*;

use crate::cancel::CancelFlag;
use crate::geometry::{Frame, Point};

/// Position in the original of each pixel of a new picture, row by row.
pub(crate) trait PixelMap: Sync {
    /// Returns the positions of a row. A position is `None` without an original.
    fn row(&self, y: usize) -> impl Fn(usize) -> Option<Point>;
}

/// Draws a picture of `size` with an alpha channel, on all cores. Pixels without an original are
/// transparent. Returns `None` when cancelled.
pub(crate) fn warp(
    original: &DynamicImage,
    map: &impl PixelMap,
    size: Frame,
    cancel: &CancelFlag,
) -> Option<DynamicImage> {
    let frame = Frame::new(original.width() as usize, original.height() as usize);
    let job = WarpJob { map, frame, size, cancel };
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

/// Channel value of a pixel. Positions are `f64`; values are mixed in `f32`, which represents 16
/// bits exactly.
trait WarpSample: image::Primitive + Send + Sync {
    /// Value of full opacity.
    const OPAQUE: Self;
    fn number(self) -> f32;
    fn nearest(number: f32) -> Self;
}

macro_rules! whole_numbers {
    ($($t:ty),*) => { $(impl WarpSample for $t {
        const OPAQUE: Self = <$t>::MAX;
        #[inline]
        fn number(self) -> f32 {
            f32::from(self)
        }
        #[inline]
        fn nearest(number: f32) -> Self {
            // Values are never negative here, so adding a half and truncating rounds, and is much
            // faster.
            (number + 0.5) as $t
        }
    })* };
}
whole_numbers!(u8, u16);

impl WarpSample for f32 {
    const OPAQUE: Self = 1.0;
    #[inline]
    fn number(self) -> f32 {
        self
    }
    #[inline]
    fn nearest(number: f32) -> Self {
        number
    }
}

type Buffer<P> = ImageBuffer<P, Vec<<P as Pixel>::Subpixel>>;

struct WarpJob<'a, M> {
    map: &'a M,
    frame: Frame,
    size: Frame,
    cancel: &'a CancelFlag,
}

impl<Map: PixelMap> WarpJob<'_, Map> {
    /// Draws from `N` opaque channels to `M = N + 1`.
    fn opaque<P, Q, const N: usize, const M: usize>(&self, original: &Buffer<P>) -> Option<Buffer<Q>>
    where
        P: Pixel,
        Q: Pixel<Subpixel = P::Subpixel>,
        P::Subpixel: WarpSample,
    {
        let samples: &[P::Subpixel] = original.as_raw();
        self.draw::<P::Subpixel, M>(|cell| {
            let corners = cell.corners::<P::Subpixel, N>(samples);
            let weights = cell.weights();
            let mut out = [P::Subpixel::OPAQUE; M];
            for (c, value) in out.iter_mut().take(N).enumerate() {
                let mixed: f32 = (0..4).map(|k| corners[k][c].number() * weights[k]).sum();
                *value = P::Subpixel::nearest(mixed);
            }
            out
        })
        .and_then(|raw| Buffer::from_raw(self.size.width as u32, self.size.height as u32, raw))
    }

    /// Draws `N` channels, the last being alpha. Colours are weighted by opacity: invisible colours
    /// must not bleed into the edges.
    fn transparent<P, const N: usize>(&self, original: &Buffer<P>) -> Option<Buffer<P>>
    where
        P: Pixel,
        P::Subpixel: WarpSample,
    {
        let samples: &[P::Subpixel] = original.as_raw();
        self.draw::<P::Subpixel, N>(|cell| {
            let corners = cell.corners::<P::Subpixel, N>(samples);
            let mut weights = cell.weights();
            for (weight, corner) in weights.iter_mut().zip(corners) {
                *weight *= corner[N - 1].number();
            }
            let alpha: f32 = weights.iter().sum();
            let mut out = [P::Subpixel::nearest(0.0); N];
            if alpha > 0.0 {
                for (c, value) in out.iter_mut().take(N - 1).enumerate() {
                    let mixed: f32 = (0..4).map(|k| corners[k][c].number() * weights[k]).sum();
                    *value = P::Subpixel::nearest(mixed / alpha);
                }
                out[N - 1] = P::Subpixel::nearest(alpha);
            }
            out
        })
        .and_then(|raw| Buffer::from_raw(self.size.width as u32, self.size.height as u32, raw))
    }

    /// Draws all pixels of `M` channels. Pixels without an original stay zero, which is
    /// transparent.
    fn draw<T: WarpSample, const M: usize>(&self, mix: impl Fn(&Cell) -> [T; M] + Sync) -> Option<Vec<T>> {
        let mut raw = vec![T::nearest(0.0); self.size.width * self.size.height * M];
        raw.par_chunks_exact_mut(self.size.width * M).enumerate().try_for_each(|(y, row)| {
            if self.cancel.is_cancelled() {
                return None;
            }
            let position = self.map.row(y);
            for (x, pixel) in row.as_chunks_mut::<M>().0.iter_mut().enumerate() {
                if let Some(cell) = position(x).and_then(|p| Cell::new(self.frame, p)) {
                    *pixel = mix(&cell);
                }
            }
            Some(())
        })?;
        Some(raw)
    }
}

/// Four neighbouring pixels and a position between them.
struct Cell {
    /// Index of the upper left pixel.
    first: usize,
    width: usize,
    /// Offset from the upper left pixel, 0 to 1.
    fraction: [f32; 2],
}

impl Cell {
    /// Returns the cell around a position; `None` outside the image. The outer half pixel takes the
    /// border's values.
    #[inline]
    fn new(frame: Frame, p: Point) -> Option<Self> {
        if !frame.contains(p) {
            return None;
        }
        let (x, y) = (p.x.clamp(0.0, frame.right()), p.y.clamp(0.0, frame.bottom()));
        let (i, j) = ((x as usize).min(frame.width - 2), (y as usize).min(frame.height - 2));
        let fraction = [(x - i as f64) as f32, (y - j as f64) as f32];
        Some(Self { first: j * frame.width + i, width: frame.width, fraction })
    }

    /// Returns the values of the four pixels: upper left, upper right, lower left, lower right.
    #[inline]
    fn corners<'a, T, const N: usize>(&self, samples: &'a [T]) -> [&'a [T]; 4] {
        let upper = &samples[self.first * N..][..2 * N];
        let lower = &samples[(self.first + self.width) * N..][..2 * N];
        [&upper[..N], &upper[N..], &lower[..N], &lower[N..]]
    }

    /// Returns the bilinear weights of the four pixels.
    #[inline]
    fn weights(&self) -> [f32; 4] {
        let [x, y] = self.fraction;
        [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
    }
}
