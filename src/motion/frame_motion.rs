//! The moving pixels of one frame.

use super::background::{Background, gain};
use super::{BackgroundParameters, FrameSequence};
use crate::geometry::Frame;

/// Minimum number of moving pixels, of a pixel and its eight neighbours, for the pixel to move. The
/// vote removes specks of noise and holes.
const EVEN: u8 = 5;
/// Largest difference from the background used to measure the shift, grey levels. Moving objects
/// differ by more.
const SHIFT_DIFFERENCE: f32 = 40.0;

/// The moving pixels of one frame, and the shift of its background.
#[derive(Default)]
pub(super) struct FrameMotion {
    pub mask: Vec<bool>,
    pub shift: f64,
}

impl FrameMotion {
    pub(super) fn new(
        sequence: &FrameSequence,
        background: &Background,
        number: usize,
        parameters: &BackgroundParameters,
    ) -> Self {
        let frame = sequence.frame(number);
        let at = background.at(number);
        let gain = gain(frame, &|pixel| at(pixel).0);
        let difference = |pixel: usize| {
            let (still, deviation) = at(pixel);
            (f32::from(frame[pixel]) - gain * still, deviation)
        };
        let is_moving = |pixel: usize| {
            let (difference, deviation) = difference(pixel);
            difference.abs() > parameters.least_difference.max(parameters.deviations * deviation)
        };
        let mask = (0..frame.len()).map(is_moving).collect();
        let shift = shift(sequence.size(), &|p| at(p).0, &|p| difference(p).0);
        Self { mask, shift }
    }
}

/// Returns the shift of a frame against its background, px: one least-squares step on the
/// intensities.
fn shift(size: Frame, still: &dyn Fn(usize) -> f32, difference: &dyn Fn(usize) -> f32) -> f64 {
    let Frame { width, height } = size;
    let [mut xx, mut xy, mut yy, mut xd, mut yd] = [0.0f64; 5];
    // Every third pixel in each direction is enough to see the whole picture move.
    for y in (1..height.saturating_sub(1)).step_by(3) {
        for x in (1..width.saturating_sub(1)).step_by(3) {
            let pixel = y * width + x;
            let d = difference(pixel);
            if d.abs() > SHIFT_DIFFERENCE {
                continue;
            }
            let gx = f64::from(still(pixel + 1) - still(pixel - 1)) * 0.5;
            let gy = f64::from(still(pixel + width) - still(pixel - width)) * 0.5;
            let d = f64::from(d);
            (xx, xy, yy) = (xx + gx * gx, xy + gx * gy, yy + gy * gy);
            (xd, yd) = (xd + gx * d, yd + gy * d);
        }
    }
    let determinant = xx * yy - xy * xy;
    // A flat picture shows no shift.
    if determinant <= 1e-6 * (xx + yy).powi(2) {
        return 0.0;
    }
    let (dx, dy) = ((yy * xd - xy * yd) / determinant, (xx * yd - xy * xd) / determinant);
    dx.hypot(dy)
}

/// Sets each pixel to the majority of its 3×3 neighbourhood.
pub(super) fn by_majority(mask: &[bool], size: Frame) -> Vec<bool> {
    let Frame { width, height } = size;
    // Sums of three pixels in a row, then of three rows.
    let at = |x: usize, y: usize| u8::from(mask[y * width + x]);
    let mut rows = vec![0u8; mask.len()];
    for y in 0..height {
        for x in 0..width {
            let right = if x + 1 < width { at(x + 1, y) } else { 0 };
            rows[y * width + x] = at(x, y) + right + if x > 0 { at(x - 1, y) } else { 0 };
        }
    }
    let mut clean = Vec::with_capacity(mask.len());
    for y in 0..height {
        for x in 0..width {
            let above = if y > 0 { rows[(y - 1) * width + x] } else { 0 };
            let below = if y + 1 < height { rows[(y + 1) * width + x] } else { 0 };
            clean.push(above + rows[y * width + x] + below >= EVEN);
        }
    }
    clean
}
