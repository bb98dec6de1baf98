//! The static background of a scene: medians over time, and the temporal noise of each pixel.

use rayon::prelude::*;

use super::FrameSequence;

/// Parameters of background subtraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackgroundParameters {
    /// Half length of the window whose median is the background, frames. The background follows
    /// slower changes of light.
    pub reach: usize,
    /// Minimum difference from the background of a moving object, grey levels.
    pub least_difference: f32,
    /// Minimum difference from the background of a moving object, in standard deviations of the
    /// pixel.
    pub deviations: f32,
}

impl Default for BackgroundParameters {
    fn default() -> Self {
        Self { reach: 150, least_difference: 12.0, deviations: 5.0 }
    }
}

/// Maximum number of frames in a median. More frames change little.
const SAMPLES: usize = 41;
/// Largest spacing of the medians in a sequence, frames.
const EVERY: usize = 30;
/// Mean of the smaller half of the absolute deviations from the median, in standard deviations of a
/// Gaussian. Moving objects affect only the larger half.
const QUIET_DEVIATIONS: f32 = 0.325;
/// Number of pixels on which the light of a frame is measured.
const LIGHT_PIXELS: usize = 4000;
/// Grey level up to which a pixel says little about the light.
const DARK: f32 = 16.0;
/// Deviation above which a pixel has no background, grey levels. No camera is that noisy.
const RESTLESS: f32 = 25.0;
/// Smallest deviation, grey levels. Rounding alone contributes a third of a grey level.
const LEAST_DEVIATION: f32 = 0.5;

/// The background at several times of a sequence, interpolated in between.
pub(super) struct Background {
    times: Vec<usize>,
    /// Index of the background of each time. Times near the ends of a sequence share a window.
    of_times: Vec<usize>,
    medians: Vec<Vec<f32>>,
    deviations: Vec<Vec<f32>>,
}

impl Background {
    pub(super) fn new(sequence: &FrameSequence, parameters: &BackgroundParameters) -> Self {
        let count = sequence.len();
        let last = count.saturating_sub(1);
        let steps = last.div_ceil(EVERY).max(1);
        // Sequences shorter than the window have one background.
        let times: Vec<usize> = if count <= parameters.reach {
            vec![last / 2]
        } else {
            (0..=steps).map(|k| k * last / steps).collect()
        };
        // A window at the end of the sequence is shifted inwards, not cut, so that moving objects
        // stay a minority.
        let length = (2 * parameters.reach + 1).min(count);
        let firsts: Vec<usize> =
            times.iter().map(|time| time.saturating_sub(parameters.reach).min(count - length)).collect();
        let mut windows = firsts.clone();
        windows.dedup();
        let of_times = firsts.iter().map(|first| windows.partition_point(|window| window < first)).collect();
        let both: Vec<(Vec<f32>, Vec<f32>)> =
            windows.iter().map(|first| medians(sequence, *first, length)).collect();
        let (medians, deviations) = both.into_iter().unzip();
        Self { times, of_times, medians, deviations }
    }

    /// Returns the fraction of the pixels that have no background, because their deviation exceeds
    /// [`RESTLESS`].
    pub(super) fn restless(&self) -> f64 {
        let count = |deviations: &Vec<f32>| deviations.iter().filter(|d| **d > RESTLESS).count();
        let all: usize = self.deviations.iter().map(Vec::len).sum();
        self.deviations.iter().map(count).sum::<usize>() as f64 / all.max(1) as f64
    }

    /// Returns a function from a pixel to its background and deviation at a time.
    pub(super) fn at(&self, time: usize) -> impl Fn(usize) -> (f32, f32) + '_ {
        let after = self.times.partition_point(|t| *t <= time).clamp(1, self.times.len().max(2) - 1);
        let (a, b) = (after - 1, after.min(self.times.len() - 1));
        let span = (self.times[b] - self.times[a]).max(1) as f32;
        let share = ((time as f32 - self.times[a] as f32) / span).clamp(0.0, 1.0);
        let (a, b) = (self.of_times[a], self.of_times[b]);
        let medians = [&*self.medians[a], &*self.medians[b]];
        let deviations = [&*self.deviations[a], &*self.deviations[b]];
        move |pixel| {
            let between = |[before, after]: [&[f32]; 2]| before[pixel] * (1.0 - share) + after[pixel] * share;
            (between(medians), between(deviations))
        }
    }
}

/// Returns the median and deviation of each pixel over `length` frames.
fn medians(sequence: &FrameSequence, first: usize, length: usize) -> (Vec<f32>, Vec<f32>) {
    let samples = SAMPLES.min(length);
    let numbers: Vec<usize> = (0..samples).map(|k| first + k * length / samples).collect();
    let pixels = sequence.size().width * sequence.size().height;
    let middle = samples / 2;
    let raw: Vec<u8> = (0..pixels)
        .into_par_iter()
        .map_init(Vec::new, |values: &mut Vec<u8>, pixel| {
            values.clear();
            values.extend(numbers.iter().map(|number| sequence.frame(*number)[pixel]));
            *values.select_nth_unstable(middle).1
        })
        .collect();
    // Changing light is no noise, so each frame is first scaled to the brightness of the median.
    let gains: Vec<f32> =
        numbers.par_iter().map(|number| gain(sequence.frame(*number), &|p| f32::from(raw[p]))).collect();
    let of_pixel = |values: &mut Vec<f32>, pixel: usize| {
        values.clear();
        let levels = numbers.iter().zip(&gains);
        values.extend(levels.map(|(number, gain)| f32::from(sequence.frame(*number)[pixel]) / gain));
        let median = *values.select_nth_unstable_by(middle, f32::total_cmp).1;
        for value in values.iter_mut() {
            *value = (*value - median).abs();
        }
        values.select_nth_unstable_by(middle, f32::total_cmp);
        let quiet = values[..=middle].iter().sum::<f32>() / (middle + 1) as f32;
        (median, (quiet / QUIET_DEVIATIONS).max(LEAST_DEVIATION))
    };
    (0..pixels).into_par_iter().map_init(Vec::new, of_pixel).unzip()
}

/// Returns the brightness of a frame relative to its background. The sun, or a camera that adapts
/// to the light, scales the whole frame.
pub(super) fn gain(frame: &[u8], still: &dyn Fn(usize) -> f32) -> f32 {
    let step = frame.len().div_ceil(LIGHT_PIXELS).max(1);
    let bright = (0..frame.len()).step_by(step).filter(|pixel| still(*pixel) > DARK);
    let mut gains: Vec<f32> = bright.map(|pixel| f32::from(frame[pixel]) / still(pixel)).collect();
    if gains.is_empty() {
        return 1.0;
    }
    let middle = gains.len() / 2;
    let gain = *gains.select_nth_unstable_by(middle, f32::total_cmp).1;
    if gain > 0.0 { gain } else { 1.0 }
}
