//! Extrema of the difference of Gaussians over position and scale (Lowe 2004, sections 3 and 4).
//!
//! ```text
//!     D(i) = L(i+1) − L(i),     x̂ = −(∂²D/∂x²)⁻¹ ∂D/∂x,     D(x̂) = D + ½ (∂D/∂x)ᵀ x̂
//! ```
//!
//! with `x = (x, y, i)`. A pixel above or below all 26 neighbours is refined to the extremum `x̂`
//! of the parabola through them. The extremum is kept if `|D(x̂)|` reaches the contrast threshold,
//! and if its principal curvatures are similar: `tr² / det < (r + 1)² / r` of the 2×2 Hessian,
//! which fails on edges.

use std::cmp::Ordering;

use multiversion::multiversion;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::scale_space::{INTERVALS, Octave};
use crate::lanes::marked;

/// Border width of an octave without extrema, px.
const MARGIN: usize = 5;
/// Maximum number of steps to neighbouring pixels before an extremum is rejected.
const STEPS: usize = 5;
/// Rows searched by one task.
const STRIP: usize = 32;

/// An extremum of the difference of Gaussians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extremum {
    /// Index of the octave.
    pub octave: usize,
    /// Position in pixels of the octave.
    pub position: [f64; 2],
    /// Level in the octave. The scale doubles every `INTERVALS` levels.
    pub level: f64,
    /// `|D(x̂)|`, grey levels.
    pub response: f64,
}

/// Finds all extrema of an octave, ordered by row. `contrast` is in grey levels; `edge_ratio` is
/// `r` above.
pub(super) fn find_extrema(octave: &Octave, index: usize, contrast: f64, edge_ratio: f64) -> Vec<Extremum> {
    let frame = octave.frame();
    if frame.width <= 2 * MARGIN || frame.height <= 2 * MARGIN {
        return Vec::new();
    }
    let last = frame.height - MARGIN;
    let strips: Vec<usize> = (MARGIN..last).step_by(STRIP).collect();
    let found: Vec<Vec<Extremum>> = strips
        .into_par_iter()
        .map(|first| {
            let pixels = pixels_of_extrema(octave, first..(first + STRIP).min(last), 0.5 * contrast);
            let refined = pixels.into_iter().filter_map(|pixel| refine(octave, pixel, edge_ratio));
            refined.filter(|e| e.response >= contrast).map(|e| Extremum { octave: index, ..e }).collect()
        })
        .collect();
    let mut found = found.concat();
    // Two pixels may converge to the same extremum.
    let place = |e: &Extremum| [e.position[1], e.position[0], e.level];
    let order = |a: &Extremum, b: &Extremum| {
        let pairs = place(a).into_iter().zip(place(b));
        pairs.fold(Ordering::Equal, |so_far, (a, b)| so_far.then(a.total_cmp(&b)))
    };
    found.sort_by(order);
    found.dedup_by_key(|e| place(e).map(f64::to_bits));
    found
}

/// Returns `[level, x, y]` of the pixels that exceed the threshold in magnitude and that no
/// neighbour exceeds.
fn pixels_of_extrema(octave: &Octave, rows: std::ops::Range<usize>, threshold: f64) -> Vec<[usize; 3]> {
    let width = octave.frame().width;
    let height = rows.len() + 2;
    // The differences of a strip and one row on either side fit into the cache.
    let differences: Vec<Vec<f32>> = octave
        .levels
        .windows(2)
        .map(|pair| {
            let [fine, coarse] = [&pair[0], &pair[1]]
                .map(|p| &p.values()[(rows.start - 1) * width..(rows.start - 1 + height) * width]);
            coarse.iter().zip(fine).map(|(c, f)| c - f).collect()
        })
        .collect();
    let threshold = threshold as f32;
    let mut found = Vec::new();
    let mut tops = vec![0u8; width - 2 * MARGIN];
    for level in 1..=INTERVALS {
        let [below, middle, above] = [level - 1, level, level + 1].map(|l| &differences[l]);
        for row in 1..height - 1 {
            let line = |row: usize| &middle[row * width..(row + 1) * width];
            let lines = [row - 1, row, row + 1].map(|row| &line(row)[MARGIN - 1..]);
            mark_tops(lines, threshold, &mut tops);
            for x in marked(&tops).map(|k| MARGIN + k) {
                let value = line(row)[x];
                // With its sign reversed, a minimum is a maximum.
                let sign = value.signum();
                let value = value.abs();
                let highest = |plane: &[f32]| {
                    (row - 1..=row + 1).all(|r| {
                        plane[r * width + x - 1..=r * width + x + 1].iter().all(|v| sign * v <= value)
                    })
                };
                if highest(middle) && highest(below) && highest(above) {
                    found.push([level, x, rows.start + row - 1]);
                }
            }
        }
    }
    found
}

/// Marks pixels beyond the threshold in magnitude that are no nearer to zero than their four
/// neighbours. The first mark is for the second pixel of `row`.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn mark_tops([above, row, below]: [&[f32]; 3], threshold: f32, tops: &mut [u8]) {
    let inner = tops.len();
    let (left, middle, right) = (&row[..inner], &row[1..=inner], &row[2..inner + 2]);
    let (above, below) = (&above[1..=inner], &below[1..=inner]);
    for x in 0..inner {
        let value = middle[x];
        let [l, r, a, b] = [left[x], right[x], above[x], below[x]];
        let is_high = value > threshold && value >= l && value >= r && value >= a && value >= b;
        let is_low = value < -threshold && value <= l && value <= r && value <= a && value <= b;
        tops[x] = u8::from(is_high || is_low);
    }
}

/// Returns the extremum of the parabola around a pixel. Returns `None` when the extremum does not
/// converge or lies on an edge.
fn refine(octave: &Octave, pixel: [usize; 3], edge_ratio: f64) -> Option<Extremum> {
    let frame = octave.frame();
    let [mut level, mut x, mut y] = pixel;
    for _ in 0..STEPS {
        let d = |dl: isize, dx: isize, dy: isize| {
            let (x, y) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
            let level = level.wrapping_add_signed(dl);
            f64::from(octave.levels[level + 1].at(x, y)) - f64::from(octave.levels[level].at(x, y))
        };
        let centre = d(0, 0, 0);
        let gradient =
            0.5 * Vector3::new(d(0, 1, 0) - d(0, -1, 0), d(0, 0, 1) - d(0, 0, -1), d(1, 0, 0) - d(-1, 0, 0));
        let xx = d(0, 1, 0) + d(0, -1, 0) - 2.0 * centre;
        let yy = d(0, 0, 1) + d(0, 0, -1) - 2.0 * centre;
        let ll = d(1, 0, 0) + d(-1, 0, 0) - 2.0 * centre;
        let xy = 0.25 * (d(0, 1, 1) + d(0, -1, -1) - d(0, 1, -1) - d(0, -1, 1));
        let xl = 0.25 * (d(1, 1, 0) + d(-1, -1, 0) - d(1, -1, 0) - d(-1, 1, 0));
        let yl = 0.25 * (d(1, 0, 1) + d(-1, 0, -1) - d(1, 0, -1) - d(-1, 0, 1));
        let hessian = Matrix3::new(xx, xy, xl, xy, yy, yl, xl, yl, ll);
        let offset = -hessian.try_inverse()? * gradient;
        if offset.amax() <= 0.5 {
            let (trace, determinant) = (xx + yy, xx * yy - xy * xy);
            let round =
                determinant > 0.0 && trace * trace * edge_ratio < (edge_ratio + 1.0).powi(2) * determinant;
            return round.then(|| Extremum {
                octave: 0,
                position: [x as f64 + offset.x, y as f64 + offset.y],
                level: level as f64 + offset.z,
                response: (centre + 0.5 * gradient.dot(&offset)).abs(),
            });
        }
        let moved = |from: usize, by: f64, low: usize, high: usize| {
            // A step longer than one pixel is reliable only in its direction.
            let to = from as f64 + by.round().clamp(-1.0, 1.0);
            (to >= low as f64 && to <= high as f64).then_some(to as usize)
        };
        x = moved(x, offset.x, MARGIN, frame.width - 1 - MARGIN)?;
        y = moved(y, offset.y, MARGIN, frame.height - 1 - MARGIN)?;
        level = moved(level, offset.z, 1, INTERVALS)?;
    }
    None
}
