//! A coarse disparity map of a rectified pair, by matching rows. It previews the result of a stereo
//! program and the disparity range to search.

use image::{DynamicImage, GrayAlphaImage, LumaA};

use crate::cancel::CancelFlag;
use crate::geometry::{Frame, PointPair};
use crate::image::Profile;
use crate::similarity::{DisparityRange, Ordering, StereoParameters, match_profiles};

/// Width of the matched pictures, px. At this size, matching takes a moment.
const WIDTH: u32 = 320;
/// Largest tested disparity without known matches, as a fraction of the width.
const REACH: f64 = 0.3;
/// Margin around the disparities of known matches: fractions of their range and of the width.
const ROOM: [f64; 2] = [0.25, 0.03];
/// Fraction of the samples outside the reported range at either end.
const BEYOND: f64 = 0.02;
/// Largest cost of a match, squared levels of [`normalised`]: 0.75 local standard deviations.
const WORST: u32 = 900;
/// Half width of the surroundings by whose brightness and contrast intensities are normalised, px. A half or
/// twice this width gives as good a map (`lab/notes.md`).
const SURROUNDINGS: u32 = 7;
/// Levels of a local standard deviation. Their number only avoids rounding.
const SPREAD: f64 = 40.0;
/// Noise that is not amplified, grey levels.
const NOISE: f64 = 4.0;
/// Largest difference from the disparity of a known match that agrees, px of the map.
const AGREES: f64 = 2.0;
/// Half of the samples around a sample that must differ, and their least range in grey levels. Anything
/// matches a surface without texture.
const AROUND: usize = 5;
const LEAST_TEXTURE: u8 = 8;

/// Disparities of the pixels of the left picture.
#[derive(Debug, Clone)]
pub struct DisparityMap {
    /// Width and height of the map.
    size: [usize; 2],
    /// Range of nearly all disparities, px of the written pictures, and not beyond that of known
    /// matches. A disparity is the column in the left picture minus the column in the right one.
    pub range: [f64; 2],
    /// Disparities row by row, px of the written pictures.
    values: Vec<Option<f32>>,
    /// Share of the known matches that agree, 0 to 1. `None` if the map has none of their places.
    pub agreeing: Option<f64>,
}

impl DisparityMap {
    /// Matches the rows of two pictures. `written` is the width of the written pictures. `known` is
    /// the disparity range of known matches, px of the written pictures; it sets the search range.
    /// Returns `None` when cancelled or without any match.
    pub fn new(
        pictures: [&DynamicImage; 2],
        written: usize,
        known: Option<[f64; 2]>,
        cancel: &CancelFlag,
    ) -> Option<Self> {
        let factor = (f64::from(WIDTH) / f64::from(pictures[0].width().max(1))).min(1.0);
        let small = pictures.map(|picture| {
            let size = |v: u32| ((f64::from(v) * factor).round() as u32).max(1);
            picture.thumbnail_exact(size(picture.width()), size(picture.height())).to_luma_alpha8()
        });
        let normal = small.each_ref().map(normalised);
        let (width, height) = small[0].dimensions();
        let scale = written as f64 / f64::from(width);
        let range = tried(known.map(|known| known.map(|disparity| disparity / scale)), f64::from(width));
        let stereo = StereoParameters { ordering: Ordering::Positions, ..StereoParameters::PAPER };
        let mut values = vec![None; (width * height) as usize];
        for y in 0..height.min(small[1].height()) {
            if cancel.is_cancelled() {
                return None;
            }
            let [left, right] = normal.each_ref().map(|picture| profile(picture, y));
            if left.is_empty() || right.is_empty() {
                continue;
            }
            let found = match_profiles(&left, &right, range, &stereo);
            let grey = profile(&small[0], y).values;
            for (k, (disparity, cost)) in found.disparities.iter().zip(&found.sample_costs).enumerate() {
                let x = left.first + k as i32;
                if right.get(x + disparity).is_some() && *cost < WORST && has_texture(&grey, k) {
                    values[y as usize * width as usize + x as usize] =
                        Some((-f64::from(*disparity) * scale) as f32);
                }
            }
        }
        let values = smoothed(&values, width as usize);
        let mut sorted: Vec<f32> = values.iter().flatten().copied().collect();
        sorted.sort_unstable_by(f32::total_cmp);
        let at =
            |part: f64| sorted.get(((sorted.len().max(1) - 1) as f64 * part) as usize).map(|v| f64::from(*v));
        // Beyond the known disparities, most matches are wrong.
        let [low, high] = [at(BEYOND)?, at(1.0 - BEYOND)?];
        let range = known.map_or([low, high], |[least, most]| [low.max(least), high.min(most)]);
        let range = if range[0] < range[1] { range } else { [low, high] };
        Some(Self { size: [width, height].map(|v| v as usize), range, values, agreeing: None })
    }

    /// Compares the map with known matches, in px of the written pictures of this size.
    #[must_use]
    pub fn checked_by(self, known: &[PointPair], written: Frame) -> Self {
        let tolerance = AGREES * written.width as f64 / self.size[0] as f64;
        let off = known.iter().filter_map(|pair| {
            let (across, down) =
                (pair.point1.x / written.width as f64, pair.point1.y / written.height as f64);
            Some((self.at(across, down)? - (pair.point1.x - pair.point2.x)).abs())
        });
        let (all, agreed) =
            off.fold((0, 0), |(all, agreed), off| (all + 1, agreed + usize::from(off <= tolerance)));
        Self { agreeing: (all > 0).then(|| f64::from(agreed as u32) / f64::from(all)), ..self }
    }

    /// Returns whether fewer than half of the known matches agree.
    pub fn is_mostly_wrong(&self) -> bool {
        self.agreeing.is_some_and(|share| share < 0.5)
    }

    /// Returns the disparity at a place, given as fractions of width and height.
    pub fn at(&self, across: f64, down: f64) -> Option<f64> {
        let [width, height] = self.size;
        let place =
            |part: f64, size: usize| (part * size as f64).floor().clamp(0.0, size as f64 - 1.0) as usize;
        self.values.get(place(down, height) * width + place(across, width))?.map(f64::from)
    }

    /// Returns width and height of the map.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Returns the disparities row by row as shares of the range, 0 to 1; `None` without a match.
    pub fn shares(&self) -> impl Iterator<Item = Option<f32>> + '_ {
        let spread = (self.range[1] - self.range[0]).max(1.0);
        let share = move |value: f32| (((f64::from(value) - self.range[0]) / spread) as f32).clamp(0.0, 1.0);
        self.values.iter().map(move |value| value.map(share))
    }

    /// Returns the fraction of pixels with a match.
    pub fn matched(&self) -> f64 {
        self.values.iter().flatten().count() as f64 / self.values.len().max(1) as f64
    }
}

/// Returns the intensities of a row, as far as the picture covers it.
fn profile(picture: &GrayAlphaImage, y: u32) -> Profile {
    let row: Vec<LumaA<u8>> = (0..picture.width()).map(|x| *picture.get_pixel(x, y)).collect();
    let first = row.iter().position(|p| p[1] > 127).unwrap_or(row.len());
    let end = row.iter().rposition(|p| p[1] > 127).map_or(first, |last| last + 1);
    Profile { first: first as i32, values: row[first..end].iter().map(|p| p[0]).collect() }
}

/// Returns intensities relative to the brightness and contrast around them: the pictures may be exposed differently,
/// and a lens darkens their corners.
fn normalised(picture: &GrayAlphaImage) -> GrayAlphaImage {
    let (width, height) = picture.dimensions();
    let stride = width as usize + 1;
    // Number, sum and sum of squares of the covered pixels above and to the left.
    let mut sums = vec![[0.0f64; 3]; stride * (height as usize + 1)];
    for (x, y, pixel) in picture.enumerate_pixels() {
        let (value, covered) = (f64::from(pixel[0]), f64::from(u8::from(pixel[1] > 127)));
        let at = (y as usize + 1) * stride + x as usize + 1;
        for (k, own) in [covered, covered * value, covered * value * value].into_iter().enumerate() {
            sums[at][k] = own + sums[at - 1][k] + sums[at - stride][k] - sums[at - stride - 1][k];
        }
    }
    GrayAlphaImage::from_fn(width, height, |x, y| {
        let ends = |v: u32, size: u32| [v.saturating_sub(SURROUNDINGS), (v + SURROUNDINGS + 1).min(size)];
        let [[left, right], [top, bottom]] = [ends(x, width), ends(y, height)];
        let of = |x: u32, y: u32| &sums[y as usize * stride + x as usize];
        let [count, sum, squares] = [0, 1, 2]
            .map(|k| of(right, bottom)[k] - of(left, bottom)[k] - of(right, top)[k] + of(left, top)[k]);
        let (count, pixel) = (count.max(1.0), picture.get_pixel(x, y));
        let mean = sum / count;
        let deviation = (squares / count - mean * mean).max(0.0).sqrt();
        let level = 128.0 + SPREAD * (f64::from(pixel[0]) - mean) / (deviation + NOISE);
        LumaA([level.round().clamp(0.0, 255.0) as u8, pixel[1]])
    })
}

/// Returns whether the intensities around a sample differ.
fn has_texture(values: &[u8], at: usize) -> bool {
    let around = &values[at.saturating_sub(AROUND)..(at + AROUND + 1).min(values.len())];
    around.iter().max().zip(around.iter().min()).is_some_and(|(most, least)| most - least >= LEAST_TEXTURE)
}

/// Applies a 3×3 median filter, which removes single rows with wrong matches.
fn smoothed(values: &[Option<f32>], width: usize) -> Vec<Option<f32>> {
    let height = values.len() / width.max(1);
    (0..values.len())
        .map(|k| {
            values[k]?;
            let (x, y) = (k % width, k / width);
            let rows = y.saturating_sub(1)..(y + 2).min(height);
            let around =
                rows.flat_map(|y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| y * width + x));
            let mut known: Vec<f32> = around.filter_map(|k| values[k]).collect();
            known.sort_unstable_by(f32::total_cmp);
            known.get(known.len() / 2).copied()
        })
        .collect()
}

/// Returns the tested disparities: column in the right picture minus column in the left one.
/// `known` has the opposite sign.
fn tried(known: Option<[f64; 2]>, width: f64) -> DisparityRange {
    let Some([least, most]) = known else { return DisparityRange::symmetric((width * REACH).round() as i32) };
    let room = ROOM[0] * (most - least) + ROOM[1] * width;
    let inside = |disparity: f64| disparity.clamp(-width, width) as i32;
    DisparityRange { min: inside((-most - room).floor()), max: inside((room - least).ceil()) }
}

/// Returns a textured grey picture.
#[cfg(test)]
fn textured(shift: impl Fn(u32) -> u32) -> DynamicImage {
    use image::{GrayImage, Luma};
    let value = |x: u32, y: u32| {
        (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)).wrapping_mul(2_246_822_519) >> 24
    };
    GrayImage::from_fn(200, 60, |x, y| Luma([value((x + shift(y)) >> 1, y) as u8])).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_has_the_disparities() {
        // The upper half is shifted by 12 px, the lower half by 4 px.
        let left = textured(|_| 40);
        let right = textured(|y| 40 + if y < 30 { 12 } else { 4 });
        let map = DisparityMap::new([&left, &right], 400, None, &CancelFlag::default()).unwrap();
        let (upper, lower) = (map.at(0.5, 0.2).unwrap(), map.at(0.5, 0.8).unwrap());
        assert!(
            (upper - 24.0).abs() < 2.5 && (lower - 8.0).abs() < 2.5,
            "{upper} and {lower} px of the written pictures"
        );
        assert!(map.range[0] <= 9.0 && map.range[1] >= 23.0, "{:?}", map.range);
        assert!(map.matched() > 0.7);
        let cancelled = CancelFlag::default();
        cancelled.cancel();
        assert!(DisparityMap::new([&left, &right], 400, None, &cancelled).is_none());
    }

    #[test]
    fn another_exposure_changes_no_disparity_and_wrong_matches_are_told() {
        let left = textured(|_| 40);
        let mut right = textured(|_| 46).to_luma8();
        right.pixels_mut().for_each(|p| p.0 = [p.0[0] / 2 + 110]);
        let map = DisparityMap::new([&left, &right.into()], 200, None, &CancelFlag::default()).unwrap();
        let found = map.at(0.5, 0.5).unwrap();
        assert!((found - 6.0).abs() < 1.5, "{found} px");
        let frame = Frame { width: 200, height: 60 };
        let known = |shift: f64| {
            let places = (40..160).step_by(5).map(f64::from);
            places.map(|x| PointPair::new(x, 30.0, x - shift, 30.0)).collect::<Vec<_>>()
        };
        let agreeing = |shift: f64| map.clone().checked_by(&known(shift), frame).agreeing.unwrap();
        assert!(agreeing(6.0) > 0.8 && agreeing(16.0) < 0.2, "{} {}", agreeing(6.0), agreeing(16.0));
        assert_eq!(map.clone().checked_by(&[], frame).agreeing, None);
    }

    #[test]
    fn a_surface_without_texture_has_no_disparity() {
        let flat_below = |shift: u32| {
            let mut picture = textured(|_| shift).to_luma8();
            picture.enumerate_pixels_mut().filter(|(_, y, _)| *y >= 30).for_each(|(_, _, p)| p.0 = [120]);
            DynamicImage::from(picture)
        };
        let (left, right) = (flat_below(40), flat_below(52));
        let map = DisparityMap::new([&left, &right], 400, None, &CancelFlag::default()).unwrap();
        assert!(map.at(0.5, 0.2).is_some() && map.at(0.5, 0.8).is_none());
    }

    #[test]
    fn known_matches_set_the_search_range() {
        // The shift is larger than the search range without known matches.
        let (left, right) = (textured(|_| 40), textured(|_| 120));
        let found = |known| {
            let map = DisparityMap::new([&left, &right], 400, known, &CancelFlag::default())?;
            Some((map.at(0.9, 0.5)?, map.matched()))
        };
        let (disparity, matched) = found(Some([150.0, 170.0])).unwrap();
        assert!((disparity - 160.0).abs() < 3.0 && matched > 0.4, "{disparity} px, {matched}");
        assert!(found(None).is_none_or(|(disparity, _)| (disparity - 160.0).abs() > 20.0));
        let range = tried(Some([150.0, 170.0]), 400.0);
        assert!(range.min <= -182 && range.max >= -138 && range.max < 0, "{range:?}");
    }
}
