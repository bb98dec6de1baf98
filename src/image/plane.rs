//! Grey images of floating-point intensities.

use std::sync::Arc;

use multiversion::multiversion;
use rayon::prelude::*;

use super::validity::Validity;
use crate::geometry::{Frame, Point};
use crate::lanes::LANES;

/// A grey image, row-major, with intensities in grey levels `0 ..= 255` for any depth of the file.
/// Clones share the values.
#[derive(Debug, Clone, PartialEq)]
pub struct GrayPlane {
    frame: Frame,
    values: Arc<[f32]>,
    /// Distances from the pixels that are no picture; `None` if all are picture.
    validity: Option<Arc<Validity>>,
}

impl GrayPlane {
    /// Creates a plane from row-major values.
    ///
    /// # Panics
    /// Panics if the number of values is not `width × height`.
    pub fn new(frame: Frame, values: Vec<f32>) -> Self {
        Self::shared(frame, values.into())
    }

    /// Creates a plane like [`GrayPlane::new`], from values that are already shared.
    pub(super) fn shared(frame: Frame, values: Arc<[f32]>) -> Self {
        assert_eq!(values.len(), frame.width * frame.height, "one value a pixel");
        Self { frame, values, validity: None }
    }

    /// Marks the pixels that are no picture. Their values are filled from their surroundings.
    pub(super) fn with_validity(self, validity: Option<Validity>) -> Self {
        Self { validity: validity.map(Arc::new), ..self }
    }

    /// Returns the fraction of the pixels that are no picture.
    #[cfg_attr(not(feature = "pictures"), expect(dead_code, reason = "the decoders mark missing pixels"))]
    pub(super) fn masked(&self) -> f64 {
        let Some(validity) = &self.validity else { return 0.0 };
        let masked = (0..self.values.len()).filter(|k| !validity.is_picture(*k)).count();
        masked as f64 / self.values.len() as f64
    }

    pub(super) fn validity(&self) -> Option<&Validity> {
        self.validity.as_deref()
    }

    /// Returns whether all pixels are picture within a distance of a point, px.
    pub(crate) fn is_clear(&self, point: Point, reach: f64) -> bool {
        self.validity.as_ref().is_none_or(|validity| validity.is_clear(point, reach))
    }

    /// Returns the mean of a measure over the pixels that are picture in both planes; `None` without any.
    ///
    /// # Panics
    /// Panics if the planes differ in size.
    pub(crate) fn mean_with(&self, other: &Self, measure: impl Fn(f32, f32) -> f64) -> Option<f64> {
        assert_eq!(self.frame, other.frame, "planes of one size");
        let is_valid: Vec<_> = [self, other].into_iter().filter_map(Self::validity).collect();
        let measures = self.values.iter().zip(&*other.values).map(|(a, b)| measure(*a, *b));
        let [sum, count] = match is_valid[..] {
            [] => [measures.sum(), self.values.len() as f64],
            _ => measures
                .enumerate()
                .filter(|(k, _)| is_valid.iter().all(|validity| validity.is_picture(*k)))
                .fold([0.0; 2], |[sum, count], (_, value)| [sum + value, count + 1.0]),
        };
        (count > 0.0).then(|| sum / count)
    }

    /// Computes a plane in place, on all threads, in strips of `rows` rows (at least one). `fill`
    /// receives the first row of its strip and the strip's pixels.
    pub(crate) fn from_strips(frame: Frame, rows: usize, fill: impl Fn(usize, &mut [f32]) + Sync) -> Self {
        let mut values: Arc<[f32]> = std::iter::repeat_n(0.0, frame.width * frame.height).collect();
        let rows = rows.max(1);
        // The values have a single owner here, so nothing is copied.
        let strips = Arc::make_mut(&mut values).par_chunks_mut((rows * frame.width).max(1));
        strips.enumerate().for_each(|(strip, pixels)| fill(strip * rows, pixels));
        Self { frame, values, validity: None }
    }

    /// Computes a plane pixel by pixel from `(x, y)`.
    pub fn from_fn(frame: Frame, f: impl Fn(usize, usize) -> f32) -> Self {
        let values = (0..frame.height)
            .flat_map(|y| (0..frame.width).map(move |x| (x, y)))
            .map(|(x, y)| f(x, y))
            .collect();
        Self { frame, values, validity: None }
    }

    /// Returns width and height.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// Returns all values, row by row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Returns the values of a row.
    pub fn row(&self, y: usize) -> &[f32] {
        &self.values[y * self.frame.width..(y + 1) * self.frame.width]
    }

    /// Returns the value of a pixel.
    pub fn at(&self, x: usize, y: usize) -> f32 {
        self.values[y * self.frame.width + x]
    }

    /// Interpolates bilinearly. Positions outside the sampling rectangle take the nearest border
    /// value.
    pub fn sample(&self, p: Point) -> f32 {
        let (right, bottom) = (self.frame.right().max(0.0) as f32, self.frame.bottom().max(0.0) as f32);
        self.interpolate((p.x as f32).clamp(0.0, right), (p.y as f32).clamp(0.0, bottom))
    }

    /// Interpolates bilinearly at a position known to be inside the sampling rectangle. `f32`
    /// resolves 1/1000 px in the largest images.
    #[inline]
    pub(crate) fn interpolate(&self, x: f32, y: f32) -> f32 {
        let Frame { width, height } = self.frame;
        if width < 2 || height < 2 {
            return self.at(x as usize, y as usize);
        }
        // The last column and row interpolate from the preceding cell.
        let xi = (x as usize).min(width - 2);
        let yi = (y as usize).min(height - 2);
        let (fx, fy) = (x - xi as f32, y - yi as f32);
        let i = yi * width + xi;
        let (top, below) = (&self.values[i..i + 2], &self.values[i + width..i + width + 2]);
        let a = top[0] + (top[1] - top[0]) * fx;
        let b = below[0] + (below[1] - below[0]) * fx;
        a + (b - a) * fy
    }

    /// Returns the standard deviation of the values of the picture, grey levels. A flat image has a
    /// value near zero.
    pub fn contrast(&self) -> f64 {
        let mean = self.mean_with(self, |v, _| f64::from(v)).unwrap_or(0.0);
        self.mean_with(self, |v, _| (f64::from(v) - mean).powi(2)).unwrap_or(0.0).sqrt()
    }
}

/// Adding an integer below this number leaves the integer in the lowest bits of the sum, a
/// conversion that vectorises.
const SHIFT: f32 = 8_388_608.0;

/// Positions that are interpolated together: the pixels of the first are stored when those of the last are looked up.
const AT_ONCE: usize = 4 * LANES;

/// Interpolates at many positions, like [`GrayPlane::interpolate`]. All but the
/// pixel look-up is vectorised.
///
/// # Panics
/// Panics if the three slices differ in length, or if the length is no multiple of sixteen.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
pub(crate) fn interpolate_all(plane: &GrayPlane, x: &[f32], y: &[f32], found: &mut [f32]) {
    assert!(x.len() == found.len() && y.len() == found.len() && found.len().is_multiple_of(LANES));
    let Frame { width, height } = plane.frame;
    let whole = |value: f32| (value + SHIFT).to_bits() & 0x007f_ffff;
    let countable = width.max(height) <= SHIFT as usize && u32::try_from(width * height).is_ok();
    if width.min(height) < 2 || !countable {
        for (k, value) in found.iter_mut().enumerate() {
            *value = plane.interpolate(x[k], y[k]);
        }
        return;
    }
    let (right, bottom) = ((width - 2) as f32, (height - 2) as f32);
    // The pixels of a row and those below them, in slices of one length: one check serves both.
    let count = plane.values.len() - width;
    let (upper, lower) = (&plane.values[..count], &plane.values[width..][..count]);
    let (mut fx, mut fy) = ([0f32; AT_ONCE], [0f32; AT_ONCE]);
    let mut pixels = [0u32; AT_ONCE];
    let (mut tops, mut belows) = ([[0f32; 2]; AT_ONCE], [[0f32; 2]; AT_ONCE]);
    for ((x, y), found) in x.chunks(AT_ONCE).zip(y.chunks(AT_ONCE)).zip(found.chunks_mut(AT_ONCE)) {
        let few = found.len();
        let (x, y) = (&x[..few], &y[..few]);
        for k in 0..few {
            let (left, up) = (x[k].floor().min(right), y[k].floor().min(bottom));
            (fx[k], fy[k]) = (x[k] - left, y[k] - up);
            pixels[k] = whole(up) * width as u32 + whole(left);
        }
        for k in 0..few {
            let first = pixels[k] as usize;
            let (top, below) = (&upper[first..first + 2], &lower[first..first + 2]);
            (tops[k], belows[k]) = ([top[0], top[1]], [below[0], below[1]]);
        }
        for k in 0..few {
            let a = tops[k][0] + (tops[k][1] - tops[k][0]) * fx[k];
            let b = belows[k][0] + (belows[k][1] - belows[k][0]) * fx[k];
            found[k] = a + (b - a) * fy[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_between_pixel_centres_and_clamps_outside() {
        let plane = GrayPlane::from_fn(Frame::new(3, 2), |x, y| (10 * x + 100 * y) as f32);
        assert!((plane.sample(Point::new(1.5, 0.5)) - 65.0).abs() < 1e-5);
        assert!((plane.sample(Point::new(-4.0, 9.0)) - 100.0).abs() < 1e-5);
        assert!((plane.sample(Point::new(2.0, 1.0)) - 120.0).abs() < 1e-5);
    }

    #[test]
    fn many_positions_are_interpolated_like_one() {
        for frame in [Frame::new(61, 47), Frame::new(2, 2), Frame::new(1, 40), Frame::new(9_000_000, 2)] {
            let plane = GrayPlane::from_fn(frame, |x, y| ((x * 7919 + y * 104_729) % 256) as f32);
            let share = |k: usize, step: f32| (k as f32 * step).fract();
            let place = |share: f32, end: f64| share * end as f32;
            let mut x: Vec<f32> = (0..64).map(|k| place(share(k, 0.618_034), frame.right())).collect();
            let mut y: Vec<f32> = (0..64).map(|k| place(share(k, 0.754_877), frame.bottom())).collect();
            (x[0], y[0], x[1], y[1]) = (frame.right() as f32, frame.bottom() as f32, 0.0, 0.0);
            let mut found = [0.0; 64];
            interpolate_all(&plane, &x, &y, &mut found);
            for k in 0..64 {
                let expected = plane.interpolate(x[k], y[k]);
                assert_eq!(found[k].to_bits(), expected.to_bits(), "{} {} of {frame:?}", x[k], y[k]);
            }
        }
    }
}
