//! Moving pixels of a sequence, frame by frame.

use std::fmt;

use rayon::prelude::*;

use super::background::Background;
use super::barcode::WORD;
use super::frame_motion::{FrameMotion, by_majority};
use super::{BackgroundParameters, Barcode, FEWEST_FRAMES, FrameSequence, MotionError};
use crate::cancel::CancelFlag;
use crate::geometry::{AnchoredLine, Frame, median};

/// Fraction of moving pixels, over time or in the median frame, above which there is no background.
const EVERYTHING: f64 = 0.5;
/// Minimum fraction of moving pixels, over all frames. Fewer are noise.
const NOTHING: f64 = 2e-5;
/// Median shift of the background above which the camera is moving, px.
const SHAKING: f64 = 0.35;

/// The moving pixels of every frame.
///
/// The frames of a pixel are stored together, one bit each, so that the barcode of a line is a
/// union of few words.
#[derive(Clone, PartialEq, Eq)]
pub struct Silhouettes {
    name: String,
    size: Frame,
    full_size: Frame,
    frames: usize,
    words: usize,
    bits: Vec<u64>,
}

/// Omits the bits, of which there are millions.
impl fmt::Debug for Silhouettes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, size, full_size, frames, .. } = self;
        let mut shown = f.debug_struct("Silhouettes");
        shown.field("name", name).field("size", size).field("full_size", full_size);
        shown.field("frames", frames).finish_non_exhaustive()
    }
}

impl Silhouettes {
    /// Separates the moving pixels of a sequence from its background.
    pub fn new(
        sequence: &FrameSequence,
        parameters: &BackgroundParameters,
        cancel: &CancelFlag,
    ) -> Result<Self, MotionError> {
        let name = || sequence.name().to_owned();
        let found = sequence.len();
        if found < FEWEST_FRAMES {
            return Err(MotionError::TooFewFrames { name: name(), found, least: FEWEST_FRAMES });
        }
        let background = Background::new(sequence, parameters);
        cancel.check()?;
        let restless = background.restless();
        if restless > EVERYTHING {
            return Err(MotionError::EverythingMoves { name: name(), percent: (100.0 * restless) as u32 });
        }
        let of_frame = |number: usize| {
            if cancel.is_cancelled() {
                FrameMotion::default()
            } else {
                FrameMotion::new(sequence, &background, number, parameters)
            }
        };
        let moving: Vec<FrameMotion> = (0..found).into_par_iter().map(of_frame).collect();
        cancel.check()?;
        let shift = median(moving.iter().map(|m| m.shift));
        if shift > SHAKING {
            return Err(MotionError::CameraMoves { name: name(), shift });
        }
        let masks: Vec<Vec<bool>> = moving.into_iter().map(|m| m.mask).collect();
        Self::from_masks(sequence.name(), sequence.size(), sequence.full_size(), masks)
    }

    /// Creates silhouettes from one mask per frame, each row by row at `size`. Specks and holes of
    /// single pixels are removed.
    pub fn from_masks(
        name: &str,
        size: Frame,
        full_size: Frame,
        masks: Vec<Vec<bool>>,
    ) -> Result<Self, MotionError> {
        let frames = masks.len();
        let clean: Vec<Vec<bool>> = masks.into_par_iter().map(|mask| by_majority(&mask, size)).collect();
        let covered =
            |mask: &Vec<bool>| mask.iter().filter(|m| **m).count() as f64 / mask.len().max(1) as f64;
        let shares: Vec<f64> = clean.iter().map(covered).collect();
        let name = name.to_owned();
        if shares.iter().sum::<f64>() < NOTHING * frames as f64 {
            return Err(MotionError::NothingMoves(name));
        }
        let middle = median(shares);
        if middle > EVERYTHING {
            return Err(MotionError::EverythingMoves { name, percent: (100.0 * middle) as u32 });
        }
        let words = frames.div_ceil(WORD);
        let mut bits = vec![0u64; size.width * size.height * words];
        bits.par_chunks_mut(words.max(1)).enumerate().for_each(|(pixel, own)| {
            for (time, _) in clean.iter().enumerate().filter(|(_, mask)| mask[pixel]) {
                own[time / WORD] |= 1 << (time % WORD);
            }
        });
        Ok(Self { name, size, full_size, frames, words, bits })
    }

    /// Returns the number of frames.
    pub fn len(&self) -> usize {
        self.frames
    }

    /// Returns whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames == 0
    }

    /// Returns the size of the masks, px.
    pub fn size(&self) -> Frame {
        self.size
    }

    /// Returns the size of the frames as recorded, px.
    pub fn full_size(&self) -> Frame {
        self.full_size
    }

    /// Returns the mask of a frame, row by row.
    pub fn mask(&self, time: usize) -> Vec<bool> {
        let of_pixel = |own: &[u64]| own[time / WORD] >> (time % WORD) & 1 == 1;
        self.bits.chunks_exact(self.words).map(of_pixel).collect()
    }

    /// Returns the number of frames before `end` in which each pixel moves, row by row.
    pub fn moved_before(&self, end: usize) -> Vec<u32> {
        let first = |word: usize| match end.saturating_sub(word * WORD) {
            0 => 0,
            few if few < WORD => (1u64 << few) - 1,
            _ => u64::MAX,
        };
        let masks: Vec<u64> = (0..self.words).map(first).collect();
        let of_pixel =
            |own: &[u64]| own.iter().zip(&masks).map(|(word, mask)| (word & mask).count_ones()).sum();
        self.bits.chunks_exact(self.words.max(1)).map(of_pixel).collect()
    }

    /// Returns the barcode of a line, in pixels of an image that is `scale` times as large as the
    /// masks.
    pub fn barcode(&self, line: &AnchoredLine, scale: f64) -> Barcode {
        let Frame { width, height } = self.size;
        // Like `geometry::rescaled`, but by division: multiplying by the reciprocal would round
        // differently.
        let to_mask = |v: f64| (v + 0.5) / scale - 0.5;
        let anchor = crate::geometry::Point::new(to_mask(line.anchor.x), to_mask(line.anchor.y));
        let own = AnchoredLine { anchor, direction: line.direction };
        let (first, last) = own.index_range(self.size, 1.0).unwrap_or((0, -1));
        let place = |step: i32| {
            let at = own.point_at(f64::from(step));
            let (x, y) = ((at.x + 0.5) as usize, (at.y + 0.5) as usize);
            (y.min(height - 1) * width + x.min(width - 1)) * self.words
        };
        let pixels: Vec<usize> = (first..=last).map(place).collect();
        Barcode::new(self.union(&pixels), self.frames)
    }

    /// Returns the union over some pixels, given by the indices of their first words.
    ///
    /// A search by barcodes spends nearly all its time here. A few words at a time stay in
    /// registers.
    fn union(&self, pixels: &[usize]) -> Vec<u64> {
        let mut words = Vec::with_capacity(self.words);
        while words.len() < self.words {
            let from = words.len();
            match self.words - from {
                1 => words.extend(self.union_of::<1>(pixels, from)),
                2 => words.extend(self.union_of::<2>(pixels, from)),
                3 => words.extend(self.union_of::<3>(pixels, from)),
                4 | 8 => words.extend(self.union_of::<4>(pixels, from)),
                5 => words.extend(self.union_of::<5>(pixels, from)),
                _ => words.extend(self.union_of::<6>(pixels, from)),
            }
        }
        words
    }

    fn union_of<const N: usize>(&self, pixels: &[usize], from: usize) -> [u64; N] {
        let mut union = [0; N];
        for pixel in pixels {
            if let Some(own) = self.bits.get(pixel + from..).and_then(<[u64]>::first_chunk::<N>) {
                for (word, own) in union.iter_mut().zip(own) {
                    *word |= own;
                }
            }
        }
        union
    }

    /// Returns the silhouettes of the given frames only, in the given order.
    #[must_use]
    pub fn at_times(&self, times: &[usize]) -> Self {
        let words = times.len().div_ceil(WORD);
        let mut bits = vec![0u64; self.size.width * self.size.height * words];
        let choose = |(own, all): (&mut [u64], &[u64])| {
            if all.iter().all(|word| *word == 0) {
                return;
            }
            for (k, time) in times.iter().enumerate() {
                own[k / WORD] |= (all[time / WORD] >> (time % WORD) & 1) << (k % WORD);
            }
        };
        bits.par_chunks_mut(words.max(1)).zip(self.bits.par_chunks(self.words.max(1))).for_each(choose);
        Self { name: self.name.clone(), frames: times.len(), words, bits, ..*self }
    }

    /// Returns the silhouettes at half the size. A pixel moves if any of its four pixels does.
    #[must_use]
    pub fn halved(&self) -> Self {
        let Frame { width, height } = self.size;
        let size = Frame::new(width.div_ceil(2), height.div_ceil(2));
        let mut bits = vec![0u64; size.width * size.height * self.words];
        bits.par_chunks_mut(size.width * self.words).enumerate().for_each(|(y, row)| {
            for (x, own) in row.chunks_exact_mut(self.words).enumerate() {
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let (x, y) = ((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1));
                    let pixel = (y * width + x) * self.words;
                    for (word, all) in own.iter_mut().zip(&self.bits[pixel..pixel + self.words]) {
                        *word |= all;
                    }
                }
            }
        });
        Self { name: self.name.clone(), size, bits, ..*self }
    }

    /// Returns the overlap of two sequences, in which frame `k` of the first matches frame
    /// `k + offset` of the second.
    pub fn overlapping(both: [&Self; 2], offset: i32) -> Result<[Self; 2], MotionError> {
        let ([from1, from2], common) = common_frames(both.map(Self::len), offset);
        if common < FEWEST_FRAMES {
            return Err(MotionError::NoOverlap { offset, common, least: FEWEST_FRAMES });
        }
        let part = |sequence: &Self, from: usize| {
            if from == 0 && common == sequence.frames {
                return sequence.clone();
            }
            sequence.at_times(&(from..from + common).collect::<Vec<_>>())
        };
        Ok([part(both[0], from1), part(both[1], from2)])
    }
}

/// Returns the overlap at an offset: its first frame in each sequence, and its number of frames,
/// possibly 0.
pub fn common_frames(counts: [usize; 2], offset: i32) -> ([usize; 2], usize) {
    let by = offset.unsigned_abs() as usize;
    let first = if offset < 0 { [by, 0] } else { [0, by] };
    let left = |k: usize| counts[k].saturating_sub(first[k]);
    (first, left(0).min(left(1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::image::GrayPlane;

    const SIZE: Frame = Frame { width: 96, height: 72 };

    /// Creates textured frames from a brightness as a function of position and time.
    fn sequence(frames: usize, level: impl Fn(usize, usize, usize) -> f32) -> FrameSequence {
        let mut sequence = FrameSequence::new("left");
        for time in 0..frames {
            sequence.push(&GrayPlane::from_fn(SIZE, |x, y| level(x, y, time))).unwrap();
        }
        sequence
    }

    fn texture(x: usize, y: usize) -> f32 {
        90.0 + 40.0 * ((x as f32) * 0.35).sin() * ((y as f32) * 0.27).cos()
    }

    /// Returns reproducible noise of some grey levels.
    fn noise(x: usize, y: usize, time: usize) -> f32 {
        let hash = (x * 73_856_093) ^ (y * 19_349_663) ^ (time * 83_492_791);
        ((hash >> 7) % 9) as f32 - 4.0
    }

    fn is_in_square(x: usize, y: usize, time: usize) -> bool {
        (time..time + 12).contains(&x) && (30..42).contains(&y)
    }

    fn silhouettes(sequence: &FrameSequence) -> Result<Silhouettes, MotionError> {
        Silhouettes::new(sequence, &BackgroundParameters::default(), &CancelFlag::default())
    }

    #[test]
    fn what_moves_is_found_under_noise_and_changing_light() {
        let light = |time: usize| 1.0 + 0.004 * time as f32;
        let level = |x: usize, y: usize, time: usize| {
            let still = if is_in_square(x, y, time) { 200.0 } else { texture(x, y) };
            still * light(time) + noise(x, y, time)
        };
        let found = silhouettes(&sequence(80, level)).unwrap();
        let (mut wrong, mut all) = (0, 0);
        for time in 0..80 {
            let mask = found.mask(time);
            wrong += (0..mask.len()).filter(|k| mask[*k] != is_in_square(k % 96, k / 96, time)).count();
            all += mask.iter().filter(|moving| **moving).count();
        }
        // The corners of the square vanish with the specks.
        assert!(wrong * 20 < all, "{wrong} of {all}");
        let line = AnchoredLine::at_angle(Point::new(40.0, 0.0), std::f64::consts::FRAC_PI_2);
        let barcode = found.barcode(&line, 1.0);
        assert!((0..80).all(|time| barcode.is_set(time) == (time..time + 12).contains(&40)), "{barcode:?}");
        let twice = AnchoredLine::at_angle(Point::new(80.5, 3.0), std::f64::consts::FRAC_PI_2);
        assert_eq!(found.barcode(&twice, 2.0), barcode);
        assert!(found.halved().barcode(&line, 2.0).ones() >= barcode.ones());
        assert_eq!(found.at_times(&[35, 36, 70]).mask(1), found.mask(36));
        for end in [0, 1, 63, 64, 70, 80] {
            let mut counts = vec![0; 96 * 72];
            for time in 0..end {
                counts
                    .iter_mut()
                    .zip(found.mask(time))
                    .for_each(|(count, moving)| *count += u32::from(moving));
            }
            assert_eq!(found.moved_before(end), counts, "{end}");
        }
    }

    #[test]
    fn recordings_without_barcodes_are_told() {
        let told = |sequence: &FrameSequence| silhouettes(sequence).unwrap_err().to_string();
        assert!(
            told(&sequence(80, |x, y, t| texture(x, y) + noise(x, y, t)))
                .starts_with("nothing moves in left")
        );
        assert!(
            told(&sequence(9, |x, y, _| texture(x, y))).starts_with("left has 9 frames, but at least 16")
        );
        // A different texture in every frame.
        let all = sequence(80, |x, y, t| {
            [20.0, 120.0, 220.0][((x / 9) * 73 + (y / 7) * 199 + t * t * 31 + t * 7) % 101 % 3]
        });
        assert!(told(&all).contains("nearly all the time"), "{}", told(&all));
        let shaking = sequence(80, |x, y, t| texture(x + [0, 2, 1, 3, 0, 3][t % 6], y + t % 3));
        assert!(told(&shaking).starts_with("the camera of left moves"), "{}", told(&shaking));
    }

    #[test]
    fn frames_in_common_follow_from_the_offset() {
        let moving = |from: usize| {
            let mask =
                |time: usize| (0..96 * 72).map(|k| is_in_square(k % 96, k / 96, time + from)).collect();
            let masks: Vec<Vec<bool>> = (0..40).map(mask).collect();
            Silhouettes::from_masks("made", SIZE, SIZE, masks).unwrap()
        };
        // The second camera started seven frames earlier, so the scene appears seven frames later
        // in it.
        let (first, second) = (moving(7), moving(0));
        let [a, b] = Silhouettes::overlapping([&first, &second], 7).unwrap();
        assert_eq!((a.len(), a.mask(20)), (33, b.mask(20)));
        let [a, b] = Silhouettes::overlapping([&second, &first], -7).unwrap();
        assert_eq!((a.len(), a.mask(0)), (33, b.mask(0)));
        assert!(matches!(
            Silhouettes::overlapping([&first, &second], -30),
            Err(MotionError::NoOverlap { common: 10, .. })
        ));
        for far in [i32::MIN, i32::MAX] {
            assert_eq!(common_frames([40, 40], far).1, 0, "{far}");
        }
    }
}
