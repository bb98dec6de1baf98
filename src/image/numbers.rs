//! The meaning of pixels with more than 8 bits: which numbers are black and white, and which pixels
//! are no picture.
//!
//! Such numbers have no common scale. A camera may use 12 of 16 bits, a thermal image the numbers
//! 29000 to 30020, a measurement degrees Celsius. The numbers of each image decide its range:
//!
//! ```text
//!     s = p99 − p1,   black = max(smallest, p1 − s/2),   white = min(largest, p99 + s/2)
//! ```
//!
//! with the percentiles `p1` and `p99` of all colours. Few hot pixels and highlights thus do not
//! darken the rest. A picture without outliers keeps its smallest and its largest number, so a
//! picture that uses all of 16 bits stays as it is.
//!
//! No picture are pixels of an alpha of zero, without a finite number, with the declared value of
//! missing data, or with a *fill value*: the smallest or the largest number of the image, the same
//! in all colours, apart from all other numbers, and
//! - more than `s` apart, and by convention a fill value ([`CONVENTIONAL`]), or
//! - at least `s/20` apart, with most of its pixels in regions that reach the border of the image,
//!   such as the corners around a rotated image.

use rayon::prelude::*;

use crate::geometry::Frame;

/// Part of the colours beyond each percentile.
const TAIL: f64 = 0.01;
/// Length of the range beyond each percentile, in units of their distance. The tail of a normal
/// distribution of a million pixels ends there: (4.9 − 2.3) / (2 · 2.3) of the standard deviation.
const BEYOND: f64 = 0.5;
/// Numbers sampled for the percentiles, which the sample tells to ± 0.0002.
const SAMPLED: usize = 1 << 18;
/// Smallest gap beside a fill value around a picture, in units of the distance between the
/// percentiles. A blurred edge between a dark or saturated area and the rest has pixels in it.
const LEAST_GAP: f64 = 0.05;
/// Most fill values at either end. Files have one or two.
const MOST_FILLS: usize = 3;
/// Fill values by convention: of GDAL and ESRI, of signed 16 bits, of 32-bit floats, and of netCDF.
const CONVENTIONAL: [f64; 9] = [
    -9999.0,
    -99999.0,
    -32768.0,
    -32767.0,
    -2_147_483_648.0,
    f32::MIN as f64,
    f32::MAX as f64,
    1e20,
    9.969_209_968_386_869e36,
];

/// A channel value of any type.
pub(super) trait Number: Copy + Sync {
    fn number(self) -> f64;
}

macro_rules! numbers {
    ($($t:ty),*) => { $(impl Number for $t {
        #[inline]
        fn number(self) -> f64 {
            f64::from(self)
        }
    })* };
}
numbers!(u8, i8, u16, i16, u32, i32, f32, f64);

impl Number for u64 {
    fn number(self) -> f64 {
        self as f64
    }
}

impl Number for i64 {
    fn number(self) -> f64 {
        self as f64
    }
}

/// Channel values of an image, pixel by pixel.
#[derive(Clone, Copy)]
pub(super) struct Numbers<'a, T> {
    pub values: &'a [T],
    pub frame: Frame,
    /// Channels per pixel, with alpha.
    pub channels: usize,
    /// Whether the last channel is alpha.
    pub has_alpha: bool,
}

/// What the numbers of an image are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Meaning {
    /// Black and white.
    pub range: [f64; 2],
    /// Whether each pixel is picture; `None` if all are.
    pub valid: Option<Vec<bool>>,
}

impl Meaning {
    /// Returns whether no pixel is picture.
    pub fn is_empty(&self) -> bool {
        self.valid.as_ref().is_some_and(|valid| !valid.contains(&true))
    }
}

/// Returns which pixels have an alpha above zero, the last of their channels. `None` if all have, or
/// none: such an alpha tells nothing.
pub(super) fn opaque<T: Number>(values: &[T], channels: usize) -> Option<Vec<bool>> {
    let is_opaque = |pixel: &[T]| pixel.last().is_some_and(|alpha| alpha.number() > 0.0);
    let mut pixels = values.chunks_exact(channels);
    if pixels.clone().all(is_opaque) || !pixels.any(is_opaque) {
        return None;
    }
    Some(values.chunks_exact(channels).map(is_opaque).collect())
}

impl<T: Number> Numbers<'_, T> {
    fn pixel(&self, k: usize) -> &[T] {
        &self.values[k * self.channels..][..self.channels - usize::from(self.has_alpha)]
    }

    fn count(&self) -> usize {
        self.values.len() / self.channels
    }

    /// Finds range and picture. `declared` is the value that the file declares as missing data.
    pub fn meaning(&self, declared: Option<f64>) -> Meaning {
        let mut valid = self.flags(declared);
        let mut sorted = self.sample(valid.as_deref());
        for _ in 0..MOST_FILLS {
            let fills: Vec<f64> = [1.0, -1.0]
                .into_iter()
                .filter_map(|sign| self.fill(sign, valid.as_deref(), &sorted))
                .collect();
            if fills.is_empty() {
                break;
            }
            let flags = valid.get_or_insert_with(|| vec![true; self.count()]);
            flags.par_iter_mut().enumerate().for_each(|(k, flag)| {
                *flag &= !fills.iter().any(|fill| self.is_fill(k, *fill));
            });
            sorted = self.sample(valid.as_deref());
        }
        Meaning { range: self.range(valid.as_deref(), &sorted), valid }
    }

    /// Returns which pixels are picture, without a search for fill values. `None` if all are.
    pub fn flags(&self, declared: Option<f64>) -> Option<Vec<bool>> {
        // A value is declared in decimal digits, and the numbers may have fewer.
        let is_declared = |value: f64| {
            declared.is_some_and(|fill| {
                value.to_bits() == fill.to_bits() || (value as f32).to_bits() == (fill as f32).to_bits()
            })
        };
        let opaque = if self.has_alpha { opaque(self.values, self.channels) } else { None };
        let is_valid = |k: usize| {
            let pixel = self.pixel(k);
            opaque.as_ref().is_none_or(|opaque| opaque[k])
                && pixel.iter().all(|value| value.number().is_finite())
                && !pixel.iter().all(|value| is_declared(value.number()))
        };
        if (0..self.count()).into_par_iter().all(is_valid) {
            return None;
        }
        Some((0..self.count()).into_par_iter().map(is_valid).collect())
    }

    fn is_fill(&self, k: usize, fill: f64) -> bool {
        self.pixel(k).iter().all(|value| value.number().to_bits() == fill.to_bits())
    }

    /// Returns a sample of the colours of the picture, in ascending order.
    fn sample(&self, valid: Option<&[bool]>) -> Vec<f64> {
        // An odd step meets all columns of the usual widths.
        let step = self.count().div_ceil(SAMPLED) | 1;
        let of_picture = (0..self.count()).step_by(step).filter(|k| valid.is_none_or(|valid| valid[*k]));
        let mut sorted: Vec<f64> =
            of_picture.flat_map(|k| self.pixel(k).iter().map(|value| value.number())).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted
    }

    /// Returns the smallest and the next larger number over the pixels of the picture, where `of_pixel`
    /// takes one number of each pixel.
    fn ends(&self, valid: Option<&[bool]>, of_pixel: impl Fn(&[T]) -> f64 + Sync) -> [f64; 2] {
        let merge = |[low, next]: [f64; 2], value: f64| match value {
            _ if value < low => [value, low],
            _ if value > low && value < next => [low, value],
            _ => [low, next],
        };
        (0..self.count())
            .into_par_iter()
            .with_min_len(1 << 14)
            .filter(|k| valid.is_none_or(|valid| valid[*k]))
            .fold(|| [f64::INFINITY; 2], |ends, k| merge(ends, of_pixel(self.pixel(k))))
            .reduce(|| [f64::INFINITY; 2], |a, b| merge(merge(a, b[0]), b[1]))
    }

    /// Returns the fill value at the lower end of the numbers, or, for the sign −1, at the upper end.
    fn fill(&self, sign: f64, valid: Option<&[bool]>, sorted: &[f64]) -> Option<f64> {
        // The colour nearest to the other end: all colours of a pixel have the value of the end only if
        // it has.
        let inner =
            |pixel: &[T]| pixel.iter().map(|value| sign * value.number()).fold(f64::NEG_INFINITY, f64::max);
        let [end, next] = self.ends(valid, inner);
        let fill = sign * end;
        let rest: Vec<f64> = sorted.iter().copied().filter(|v| v.to_bits() != fill.to_bits()).collect();
        let (p1, p99) = percentiles(&rest)?;
        let span = p99 - p1;
        let gap = next - end;
        // Colours beyond the end would be the rest of a picture.
        let is_end = sorted.iter().all(|value| sign * value >= end);
        if !(is_end && span > 0.0 && gap.is_finite() && gap >= LEAST_GAP * span) {
            return None;
        }
        let is_conventional = gap > span && CONVENTIONAL.contains(&fill);
        (is_conventional || self.is_around(valid, fill)).then_some(fill)
    }

    /// Returns whether most pixels of a fill value are connected with the border of the image.
    fn is_around(&self, valid: Option<&[bool]>, fill: f64) -> bool {
        let Frame { width, height } = self.frame;
        let is_open = |k: usize| valid.is_some_and(|valid| !valid[k]) || self.is_fill(k, fill);
        let mut reached = vec![false; self.count()];
        let columns = (0..width).flat_map(|x| [x, (height - 1) * width + x]);
        let rows = (0..height).flat_map(|y| [y * width, (y + 1) * width - 1]);
        let mut ahead: Vec<usize> = columns.chain(rows).filter(|k| is_open(*k)).collect();
        for k in &ahead {
            reached[*k] = true;
        }
        while let Some(k) = ahead.pop() {
            let (x, y) = (k % width, k / width);
            let beside = [(x > 0, k.wrapping_sub(1)), (x + 1 < width, k + 1)];
            let above = [(y > 0, k.wrapping_sub(width)), (y + 1 < height, k + width)];
            for (_, next) in beside.into_iter().chain(above).filter(|(is_inside, _)| *is_inside) {
                if !reached[next] && is_open(next) {
                    reached[next] = true;
                    ahead.push(next);
                }
            }
        }
        let [mut all, mut around] = [0usize; 2];
        for k in (0..self.count()).filter(|k| self.is_fill(*k, fill)) {
            all += 1;
            around += usize::from(reached[k]);
        }
        2 * around > all
    }

    fn range(&self, valid: Option<&[bool]>, sorted: &[f64]) -> [f64; 2] {
        let extreme = |sign: f64| {
            let outer = |pixel: &[T]| pixel.iter().map(|v| sign * v.number()).fold(f64::INFINITY, f64::min);
            sign * self.ends(valid, outer)[0]
        };
        let [smallest, largest] = [extreme(1.0), extreme(-1.0)];
        let Some((p1, p99)) = percentiles(sorted) else { return [0.0, 1.0] };
        // Numbers that are nearly all equal tell no outliers.
        let beyond = if p99 > p1 { BEYOND * (p99 - p1) } else { f64::INFINITY };
        [smallest.max(p1 - beyond), largest.min(p99 + beyond)]
    }

    /// Converts the numbers between black and white to 0 to 65535, and alpha to transparent or opaque.
    /// Numbers beyond are black or white. Pixels that are no picture become transparent, with an alpha
    /// channel added where there is none.
    pub fn stretched(&self, meaning: &Meaning) -> Vec<u16> {
        let [low, high] = meaning.range;
        let factor = 65535.0 / (high - low);
        // All numbers are equal, or the difference overflows: every pixel becomes black.
        let factor = if factor.is_finite() { factor } else { 0.0 };
        let level = move |v: &T| ((v.number() - low) * factor).round().clamp(0.0, 65535.0) as u16;
        let with_alpha = self.has_alpha || meaning.valid.is_some();
        let mut levels = Vec::with_capacity(self.count() * (self.channels + usize::from(!self.has_alpha)));
        for k in 0..self.count() {
            let is_valid = meaning.valid.as_ref().is_none_or(|valid| valid[k]);
            levels.extend(self.pixel(k).iter().map(|v| if is_valid { level(v) } else { 0 }));
            levels.extend(with_alpha.then_some(if is_valid { u16::MAX } else { 0 }));
        }
        levels
    }
}

fn percentiles(sorted: &[f64]) -> Option<(f64, f64)> {
    let last = sorted.len().checked_sub(1)?;
    let at = |share: f64| sorted[(share * last as f64).round() as usize];
    Some((at(TAIL), at(1.0 - TAIL)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { width: 80, height: 60 };

    /// Returns numbers 0 to 1023 of a texture.
    fn texture() -> Vec<f64> {
        let at = |x: usize, y: usize| (x * x * 31 + y * y * 17 + x * y * 7) % 1024;
        (0..FRAME.height).flat_map(|y| (0..FRAME.width).map(move |x| at(x, y) as f64)).collect()
    }

    fn gray<T: Number>(values: &[T]) -> Numbers<'_, T> {
        Numbers { values, frame: FRAME, channels: 1, has_alpha: false }
    }

    fn masked(meaning: &Meaning) -> usize {
        meaning.valid.iter().flatten().filter(|valid| !**valid).count()
    }

    #[test]
    fn numbers_multiplied_and_shifted_are_the_same_picture() {
        let base = texture();
        let expected = gray(&base).stretched(&gray(&base).meaning(None));
        assert!(expected.contains(&0) && expected.contains(&65535));
        for [factor, offset] in
            [[1.0, 0.0], [64.0, 0.0], [1.0, 29000.0], [0.01, 15.0], [3e5, -1e8], [1e-9, 0.0]]
        {
            let other: Vec<f64> = base.iter().map(|v| factor * v + offset).collect();
            let meaning = gray(&other).meaning(None);
            assert_eq!(masked(&meaning), 0);
            let found = gray(&other).stretched(&meaning);
            assert!(found.iter().zip(&expected).all(|(a, b)| a.abs_diff(*b) <= 1), "{factor} {offset}");
        }
        let whole: Vec<i16> = base.iter().map(|v| (*v * 16.0 - 9000.0) as i16).collect();
        assert_eq!(gray(&whole).stretched(&gray(&whole).meaning(None)), expected);
    }

    #[test]
    fn hot_pixels_and_highlights_do_not_darken_the_rest() {
        let mut values = texture();
        let [low, high] = gray(&values).meaning(None).range;
        assert_eq!([low, high].map(f64::to_bits), [0.0, 1023.0].map(f64::to_bits));
        for k in 0..20 {
            values[200 * k + 7] = if k % 2 == 0 { 1e6 } else { -1e6 };
        }
        let meaning = gray(&values).meaning(None);
        let span = meaning.range[1] - meaning.range[0];
        assert!(span > 1023.0 && span < 2.1 * 1023.0, "{:?}", meaning.range);
        assert_eq!(masked(&meaning), 0, "one hot pixel differs from the other in a camera");
    }

    #[test]
    fn pixels_that_are_no_picture_do_not_count() {
        let base: Vec<f64> = texture().iter().map(|v| 15.0 + v / 100.0).collect();
        let range = gray(&base).meaning(None).range;
        for fill in [f64::NAN, f64::INFINITY, -9999.0, -32768.0, f64::from(f32::MIN), 7.0] {
            let mut values = base.clone();
            // Scattered, and in the corner of a rotated image.
            for k in (0..400).map(|k| 11 * k + 3).filter(|_| fill.to_bits() != 7f64.to_bits()) {
                values[k] = fill;
            }
            for y in 0..20 {
                values[y * FRAME.width..][..20 - y].fill(fill);
            }
            let meaning = gray(&values).meaning((fill.to_bits() == 7f64.to_bits()).then_some(7.0));
            let expected = values.iter().filter(|v| v.to_bits() == fill.to_bits()).count();
            assert_eq!(masked(&meaning), expected, "{fill}");
            assert!((meaning.range[0] - range[0]).abs() < 0.2 && (meaning.range[1] - range[1]).abs() < 0.2);
            let levels = gray(&values).stretched(&meaning);
            assert_eq!(levels.len(), 2 * values.len());
            let transparent = levels.as_chunks::<2>().0.iter().filter(|pixel| pixel[1] == 0).count();
            assert_eq!(transparent, expected);
        }
    }

    #[test]
    fn dark_and_saturated_areas_are_picture() {
        // Black around a rotated image, and an area of the same size that fades to black.
        for (step, expected) in [(150.0, 210), (0.0, 0)] {
            let mut values: Vec<f64> = texture().iter().map(|v| step + v).collect();
            for y in 0..20 {
                values[y * FRAME.width..][..20 - y].fill(0.0);
            }
            assert_eq!(masked(&gray(&values).meaning(None)), expected, "{step}");
        }
        // Saturated lights on a dark background.
        let mut values: Vec<u16> = texture().iter().map(|v| 1000 + (v / 8.0) as u16).collect();
        for k in 20..50 {
            values[k * FRAME.width + 30..][..8].fill(u16::MAX);
        }
        assert_eq!(masked(&gray(&values).meaning(None)), 0);
        // Two values only.
        let values: Vec<u16> = texture().iter().map(|v| if *v > 400.0 { u16::MAX } else { 0 }).collect();
        assert_eq!(gray(&values).meaning(None), Meaning { range: [0.0, 65535.0], valid: None });
    }

    #[test]
    fn colours_have_one_range_and_alpha_of_zero_is_no_picture() {
        let colours: Vec<u16> = texture().iter().flat_map(|v| [*v as u16, 500, 2000, 65535]).collect();
        let mut numbers = Numbers { values: &colours, frame: FRAME, channels: 4, has_alpha: true };
        assert_eq!(numbers.meaning(None), Meaning { range: [0.0, 2000.0], valid: None });
        let mut with_hole = colours.clone();
        with_hole[4 * 100 + 3] = 0;
        numbers.values = &with_hole;
        let meaning = numbers.meaning(None);
        assert_eq!(masked(&meaning), 1);
        assert_eq!(numbers.stretched(&meaning)[4 * 100..][..4], [0; 4]);
    }

    #[test]
    fn numbers_without_a_range_are_black() {
        for values in [vec![-3.0; 4800], vec![f64::NAN; 4800]] {
            let meaning = gray(&values).meaning(None);
            assert!(gray(&values).stretched(&meaning).iter().all(|v| *v == 0 || *v == u16::MAX));
        }
        let mut values = vec![f64::MAX; 4800];
        values[..2400].fill(f64::MIN);
        assert!(gray(&values).stretched(&gray(&values).meaning(None)).iter().all(|v| *v == 0));
    }
}
