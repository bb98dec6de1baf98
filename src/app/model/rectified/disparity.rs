//! A coarse map of the disparities of a rectified pair, from the matching of rows: enough to see what a stereo program
//! would find, and over which range it has to search.

use image::{DynamicImage, LumaA, RgbaImage};

use crate::app::model::heat;
use crate::cancel::CancelFlag;
use crate::image::Profile;
use crate::similarity::{DisparityRange, StereoParameters, match_profiles};

/// Width of the pictures that are matched, px: coarse, and done in a moment.
const WIDTH: u32 = 320;
/// Largest disparity tried either way where no match tells, as a part of the width.
const REACH: f64 = 0.3;
/// How much farther than those of the matches disparities are tried, as a part of their range and of the width.
const ROOM: [f64; 2] = [0.25, 0.03];
/// Part of the samples that the range leaves out at either end.
const BEYOND: f64 = 0.02;
/// Worse matches than this are none, squared grey levels.
const WORST: u32 = 900;

/// Disparities of the left picture's pixels.
#[derive(Debug, Clone)]
pub struct DisparityMap {
    /// Coarse pixels by colour: dark is far to the left on the right picture, transparent where nothing matches.
    pub picture: RgbaImage,
    /// Between which disparities nearly all of it is, px of the pictures as they are written: the column in the left
    /// picture less that in the right one.
    pub range: [f64; 2],
    /// Row by row, in px as the range has them.
    values: Vec<Option<f32>>,
}

impl DisparityMap {
    /// Matches the rows of two pictures; `written` is the width that they are written with, and `known` the smallest and
    /// largest disparity of matches, px of what is written, around which disparities are tried. `None` when cancelled, or when
    /// nothing matches.
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
        let (width, height) = small[0].dimensions();
        let scale = written as f64 / f64::from(width);
        let range = tried(known.map(|known| known.map(|disparity| disparity / scale)), f64::from(width));
        let stereo =
            StereoParameters { ordering: crate::similarity::Ordering::Positions, ..StereoParameters::PAPER };
        let mut values = vec![None; (width * height) as usize];
        for y in 0..height.min(small[1].height()) {
            if cancel.is_cancelled() {
                return None;
            }
            let [left, right] = small.each_ref().map(|picture| {
                let row: Vec<LumaA<u8>> = (0..picture.width()).map(|x| *picture.get_pixel(x, y)).collect();
                let first = row.iter().position(|p| p[1] > 127).unwrap_or(row.len());
                let end = row.iter().rposition(|p| p[1] > 127).map_or(first, |last| last + 1);
                Profile { first: first as i32, values: row[first..end].iter().map(|p| p[0]).collect() }
            });
            if left.is_empty() || right.is_empty() {
                continue;
            }
            let found = match_profiles(&left, &right, range, &stereo);
            for (k, (disparity, cost)) in found.disparities.iter().zip(&found.sample_costs).enumerate() {
                let x = left.first + k as i32;
                if right.get(x + disparity).is_some() && *cost < WORST {
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
        let range = [at(BEYOND)?, at(1.0 - BEYOND)?];
        let spread = (range[1] - range[0]).max(1.0);
        let picture = RgbaImage::from_fn(width, height, |x, y| match values[(y * width + x) as usize] {
            Some(value) => {
                let [red, green, blue] =
                    heat::rgb((((f64::from(value) - range[0]) / spread) as f32).clamp(0.0, 1.0));
                image::Rgba([red, green, blue, 255])
            }
            None => image::Rgba([0; 4]),
        });
        Some(Self { picture, range, values })
    }

    /// The disparity at a place, as parts of width and height.
    pub fn at(&self, across: f64, down: f64) -> Option<f64> {
        let (width, height) = self.picture.dimensions();
        let place = |part: f64, size: u32| {
            ((part * f64::from(size)).floor().clamp(0.0, f64::from(size) - 1.0)) as usize
        };
        self.values.get(place(down, height) * width as usize + place(across, width))?.map(f64::from)
    }

    /// Part of the pixels that have a match.
    pub fn matched(&self) -> f64 {
        self.values.iter().flatten().count() as f64 / self.values.len().max(1) as f64
    }
}

/// The middle one of each pixel and its neighbours, which takes away single rows that went astray.
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

/// Disparities that are tried, columns of the right picture less those of the left one; `known` are the other way round.
fn tried(known: Option<[f64; 2]>, width: f64) -> DisparityRange {
    let Some([least, most]) = known else { return DisparityRange::symmetric((width * REACH).round() as i32) };
    let room = ROOM[0] * (most - least) + ROOM[1] * width;
    let inside = |disparity: f64| disparity.clamp(-width, width) as i32;
    DisparityRange { min: inside((-most - room).floor()), max: inside((room - least).ceil()) }
}

/// A grey picture, for tests.
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
    fn the_map_finds_how_far_things_are_apart() {
        // The upper half is 12 px farther to the right in the left picture, the lower half 4 px.
        let left = textured(|_| 40);
        let right = textured(|y| 40 + if y < 30 { 12 } else { 4 });
        let map = DisparityMap::new([&left, &right], 400, None, &CancelFlag::default()).unwrap();
        let (upper, lower) = (map.at(0.5, 0.2).unwrap(), map.at(0.5, 0.8).unwrap());
        assert!(
            (upper - 24.0).abs() < 2.5 && (lower - 8.0).abs() < 2.5,
            "{upper} and {lower}, as they are written"
        );
        assert!(map.range[0] <= 9.0 && map.range[1] >= 23.0, "{:?}", map.range);
        assert!(map.matched() > 0.7);
        let cancelled = CancelFlag::default();
        cancelled.cancel();
        assert!(DisparityMap::new([&left, &right], 400, None, &cancelled).is_none());
    }

    #[test]
    fn pictures_far_apart_are_matched_where_their_matches_are() {
        // Farther apart than is tried where nothing is known.
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
