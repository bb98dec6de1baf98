//! Gaussian scale space in octaves (Lowe 2004, section 3).
//!
//! ```text
//!     L(σ) = G(σ) * I,    σᵢ = σ₀ · 2^(i/S),   i = 0 … S + 2
//! ```
//!
//! After each doubling of σ every second pixel is dropped, and the next octave begins. Pixel
//! `(i, j)` of every octave lies at `(i, j) · spacing` of the picture. All octaves, the doubled one
//! included, share the centre of the first pixel, so no position is off by a fraction of a pixel.

use multiversion::multiversion;

use crate::geometry::Frame;
use crate::image::GrayPlane;

/// Levels σ₀·2^(i/S) per octave that are searched for features (S in the equations).
pub(super) const INTERVALS: usize = 3;
/// Smoothing of the first level of an octave, px of that octave (σ₀).
pub(super) const BASE_SIGMA: f64 = 1.6;
/// Assumed smoothing of a camera's picture, px.
const CAMERA_SIGMA: f64 = 0.5;
/// Minimum shorter side of an octave, px.
const SMALLEST_SIDE: usize = 16;
/// Radius of the kernels in σ. A Gaussian has 10⁻⁴ of its mass beyond it.
const KERNEL_REACH: f64 = 4.0;
/// Rows smoothed by one task.
const STRIP: usize = 16;

/// The levels of one octave.
#[derive(Debug, Clone)]
pub(super) struct Octave {
    /// Distance between neighbouring pixels, px of the picture.
    pub spacing: f64,
    /// `INTERVALS + 3` planes of equal size; σ grows by `2^(1/INTERVALS)` per level.
    pub levels: Vec<GrayPlane>,
}

impl Octave {
    /// Builds an octave on `base`, which must be smoothed by [`BASE_SIGMA`].
    fn new(base: GrayPlane, spacing: f64) -> Self {
        let mut levels = vec![base];
        for i in 1..INTERVALS + 3 {
            let [before, now] = [i - 1, i].map(|level| sigma_at(level as f64));
            levels.push(smoothed(&levels[i - 1], (now * now - before * before).sqrt()));
        }
        Self { spacing, levels }
    }

    /// Returns the size of the planes.
    pub fn frame(&self) -> Frame {
        self.levels[0].frame()
    }
}

/// Returns the smoothing of a level, px of the octave. Levels may be fractional.
pub(super) fn sigma_at(level: f64) -> f64 {
    BASE_SIGMA * (level / INTERVALS as f64).exp2()
}

/// Passes each octave of a picture to `visit`, finest first. The first octave has twice the
/// picture's size if that is at most `largest` pixels, otherwise the picture's size, half of it and
/// so on.
pub(super) fn for_each_octave(plane: &GrayPlane, largest: usize, mut visit: impl FnMut(Octave)) {
    let Frame { width, height } = plane.frame();
    if width.min(height) < SMALLEST_SIDE {
        return;
    }
    let (mut base, mut spacing, mut sigma) = if 4 * width * height <= largest {
        (doubled(plane), 0.5, 2.0 * CAMERA_SIGMA)
    } else {
        (plane.clone(), 1.0, CAMERA_SIGMA)
    };
    loop {
        let more = (BASE_SIGMA * BASE_SIGMA - sigma * sigma).sqrt();
        if base.values().len() <= largest {
            base = smoothed(&base, more);
            break;
        }
        (base, spacing, sigma) = (smoothed_and_decimated(&base, more), 2.0 * spacing, 0.5 * BASE_SIGMA);
    }
    while base.frame().width.min(base.frame().height) >= SMALLEST_SIDE {
        let octave = Octave::new(base, spacing);
        // σ has doubled.
        base = decimated(&octave.levels[INTERVALS]);
        spacing *= 2.0;
        visit(octave);
    }
}

/// Returns every second pixel of every second row.
fn decimated(plane: &GrayPlane) -> GrayPlane {
    let frame = Frame::new(plane.frame().width.div_ceil(2), plane.frame().height.div_ceil(2));
    let values = (0..frame.height).flat_map(|y| plane.row(2 * y).iter().step_by(2).copied()).collect();
    GrayPlane::new(frame, values)
}

/// Smooths and decimates a plane strip by strip, which avoids a smoothed copy of a large picture.
fn smoothed_and_decimated(plane: &GrayPlane, sigma: f64) -> GrayPlane {
    const ROWS: usize = STRIP.div_ceil(2) * 2;
    let full = plane.frame();
    let kernel = half_kernel(sigma, full);
    let frame = Frame::new(full.width.div_ceil(2), full.height.div_ceil(2));
    GrayPlane::from_strips(frame, ROWS / 2, |first, out| {
        let first = 2 * first;
        let mut rows = vec![0.0; ROWS.min(full.height - first) * full.width];
        smooth_rows(plane, &kernel, first, &mut rows);
        for (row, out) in rows.chunks(full.width).step_by(2).zip(out.chunks_mut(frame.width)) {
            for (value, out) in row.iter().step_by(2).zip(out) {
                *out = *value;
            }
        }
    })
}

/// Doubles the size by bilinear interpolation: pixel `i` lies at `i/2`.
fn doubled(plane: &GrayPlane) -> GrayPlane {
    let Frame { width, height } = plane.frame();
    let frame = Frame::new(2 * width - 1, 2 * height - 1);
    GrayPlane::from_strips(frame, 1, |y, out| {
        let (top, below) = (plane.row(y / 2), plane.row(y.div_ceil(2)));
        for x in 0..width {
            out[2 * x] = 0.5 * (top[x] + below[x]);
        }
        for x in 0..width - 1 {
            out[2 * x + 1] = 0.5 * (out[2 * x] + out[2 * x + 2]);
        }
    })
}

/// Smooths a plane by a Gaussian of the given σ, px, mirrored at the borders.
fn smoothed(plane: &GrayPlane, sigma: f64) -> GrayPlane {
    let frame = plane.frame();
    let kernel = half_kernel(sigma, frame);
    GrayPlane::from_strips(frame, STRIP, |first, out| smooth_rows(plane, &kernel, first, out))
}

/// Returns the centre and one side of a normalised Gaussian kernel, no wider than mirroring allows.
fn half_kernel(sigma: f64, frame: Frame) -> Vec<f32> {
    let reach = ((KERNEL_REACH * sigma).ceil() as usize).min(frame.width.min(frame.height) - 1);
    let weights: Vec<f64> = (0..=reach).map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp()).collect();
    let sum = 2.0 * weights.iter().sum::<f64>() - weights[0];
    weights.iter().map(|w| (w / sum) as f32).collect()
}

/// Columns smoothed at once. Their sums stay in registers while the kernel passes.
const BLOCK: usize = 32;

/// Fills `out` with smoothed rows, starting at row `first`. Each row is smoothed down the columns
/// into a buffer, then along the row.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn smooth_rows(plane: &GrayPlane, kernel: &[f32], first: usize, out: &mut [f32]) {
    let Frame { width, height } = plane.frame();
    let reach = kernel.len() - 1;
    let mut weights = kernel.to_vec();
    // The middle row and the middle pixel are added twice.
    weights[0] *= 0.5;
    let mut padded = vec![0f32; width + 2 * reach];
    let mut rows: Vec<[&[f32]; 2]> = Vec::with_capacity(weights.len());
    // The last block overlaps the one before, so that every block is whole.
    let length = BLOCK.min(width);
    for (k, out) in out.chunks_exact_mut(width).enumerate() {
        let y = first + k;
        rows.clear();
        for d in 0..=reach {
            // The two rows at the same distance above and below, mirrored into the picture.
            let below = if y + d < height { y + d } else { 2 * (height - 1) - (y + d) };
            rows.push([plane.row(y.abs_diff(d)), plane.row(below)]);
        }
        for block in (0..width).step_by(BLOCK) {
            let from = block.min(width - length);
            let mut total = [0f32; BLOCK];
            for (weight, [above, below]) in weights.iter().zip(&rows) {
                add(&mut total, *weight, &above[from..from + length], &below[from..from + length]);
            }
            padded[reach + from..][..length].copy_from_slice(&total[..length]);
        }
        for d in 1..=reach {
            padded[reach - d] = padded[reach + d];
            padded[reach + width - 1 + d] = padded[reach + width - 1 - d];
        }
        for block in (0..width).step_by(BLOCK) {
            let from = block.min(width - length);
            let around = &padded[from..from + 2 * reach + length];
            let mut total = [0f32; BLOCK];
            for (d, weight) in weights.iter().enumerate() {
                add(&mut total, *weight, &around[reach - d..][..length], &around[reach + d..][..length]);
            }
            out[from..from + length].copy_from_slice(&total[..length]);
        }
    }
}

/// Adds the weighted sums of two rows of pixels to the totals of a block.
#[expect(clippy::inline_always, reason = "it must take on the target features of its caller")]
#[inline(always)]
fn add(total: &mut [f32; BLOCK], weight: f32, one: &[f32], other: &[f32]) {
    if let (Some(one), Some(other)) = (one.first_chunk::<BLOCK>(), other.first_chunk::<BLOCK>()) {
        for i in 0..BLOCK {
            total[i] += weight * (one[i] + other[i]);
        }
    } else {
        for i in 0..one.len() {
            total[i] += weight * (one[i] + other[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(x: f64, y: f64, k: f64) -> f32 {
        (120.0 + 50.0 * (k * x).cos() * (k * y).cos()) as f32
    }

    /// A Gaussian damps a wave of frequency k by exp(−k²σ²/2) in each direction.
    #[test]
    fn a_wave_is_damped_like_under_a_gaussian() {
        let k = std::f64::consts::PI / 10.0;
        // The sides hold 30 and 10 half waves, so mirroring leaves no kink. The width is no
        // multiple of a block.
        let frame = Frame::new(301, 101);
        let plane = GrayPlane::from_fn(frame, |x, y| wave(x as f64, y as f64, k));
        for sigma in [0.8, 1.5, 3.0] {
            let out = smoothed(&plane, sigma);
            let damping = (-k * k * sigma * sigma).exp();
            for (x, y) in [(0, 0), (300, 100), (150, 50), (17, 93), (299, 3)] {
                let expected = 120.0 + damping * (f64::from(plane.at(x, y)) - 120.0);
                assert!((f64::from(out.at(x, y)) - expected).abs() < 0.05, "{sigma} {x} {y}");
            }
        }
    }

    #[test]
    fn narrow_planes_are_smoothed_too() {
        let plane = GrayPlane::from_fn(Frame::new(16, 40), |x, y| (x + y) as f32);
        let out = smoothed(&plane, 1.0);
        assert!((out.at(8, 20) - 28.0).abs() < 1e-3);
        let flat = smoothed(&GrayPlane::from_fn(Frame::new(19, 17), |_, _| 7.0), 6.0);
        assert!(flat.values().iter().all(|v| (v - 7.0).abs() < 1e-4));
    }

    #[test]
    fn octaves_begin_where_asked_and_share_their_origin() {
        let plane = GrayPlane::from_fn(Frame::new(200, 120), |x, y| (3 * x + y) as f32);
        for (largest, spacing, count) in [(usize::MAX, 0.5, 4), (24_000, 1.0, 3), (23_999, 2.0, 2)] {
            let mut octaves = Vec::new();
            for_each_octave(&plane, largest, |octave| octaves.push(octave));
            assert_eq!((octaves[0].spacing, octaves.len()), (spacing, count));
            for octave in &octaves {
                // Smoothing preserves a ramp away from the borders, so its value encodes the
                // position.
                let (x, y) = (octave.frame().width / 2, octave.frame().height / 2);
                let expected = octave.spacing * (3 * x + y) as f64;
                assert!((f64::from(octave.levels[0].at(x, y)) - expected).abs() < 0.1, "{largest}");
            }
        }
    }
}
