//! Normalised correlation of a template with every window of an image.
//!
//! ```text
//!     c(x, y) = Σ t·I / √(Σ (I − Ī)²),   Σ t = 0, Σ t² = 1
//! ```
//!
//! The template has no mean, so the mean of a window drops out of the numerator. The loops over
//! blocks of positions are compiled once per instruction set by the `multiversion` crate. The order
//! of every sum is fixed, so every instruction set gives the same bits.

use std::ops::Range;

use multiversion::multiversion;
use rayon::prelude::*;

use super::template::{HALF, LEAST_CONTRAST, SIDE, Template};
use crate::geometry::{Frame, Line};
use crate::image::GrayPlane;

/// Number of positions computed at once.
const BLOCK: usize = 32;

/// Image extended beyond its border by its last pixels, so that a window fits around every pixel.
pub(super) struct Windows {
    frame: Frame,
    stride: usize,
    /// Grey levels minus 128, which keeps the sums of squares small.
    values: Vec<f32>,
}

/// Search region: a range of columns per row.
pub(super) struct Region {
    rows: Vec<Range<usize>>,
}

/// Best template at each position of a region.
pub(super) struct Map {
    rows: Vec<Vec<Best>>,
    region: Region,
}

/// Correlation of a template, with the template's index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Best {
    pub correlation: f32,
    pub template: u16,
}

/// Local maximum of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    pub x: usize,
    pub y: usize,
    pub best: Best,
}

impl Region {
    pub fn whole(frame: Frame) -> Self {
        Self { rows: vec![0..frame.width; frame.height] }
    }

    /// Returns the pixels within `band` px of a line.
    pub fn band(frame: Frame, line: &Line, band: f64) -> Self {
        let (a, b, c) = (line.coefficients().x, line.coefficients().y, line.coefficients().z);
        let columns = |y: usize| {
            let rest = b * y as f64 + c;
            if a.abs() < 1e-9 {
                return if rest.abs() <= band { 0..frame.width } else { 0..0 };
            }
            let ends = [(-band - rest) / a, (band - rest) / a];
            let first = ends[0].min(ends[1]).ceil().clamp(0.0, frame.width as f64);
            let end = (ends[0].max(ends[1]).floor() + 1.0).clamp(first, frame.width as f64);
            first as usize..end as usize
        };
        Self { rows: (0..frame.height).map(columns).collect() }
    }
}

impl Windows {
    pub fn new(plane: &GrayPlane) -> Self {
        let frame = plane.frame();
        // The last block of a row may begin at its last column.
        let stride = HALF + frame.width + HALF + BLOCK;
        let mut values = Vec::with_capacity(stride * (frame.height + 2 * HALF));
        for y in 0..frame.height + 2 * HALF {
            let row = plane.row(y.saturating_sub(HALF).min(frame.height - 1));
            values.extend([row[0] - 128.0; HALF]);
            values.extend(row.iter().map(|v| v - 128.0));
            values.extend([row[frame.width - 1] - 128.0; HALF + BLOCK]);
        }
        Self { frame, stride, values }
    }

    /// Finds the best template at each position.
    pub fn best(&self, templates: &[Template], region: Region) -> Map {
        let rows = (0..self.frame.height)
            .into_par_iter()
            .map(|y| {
                let columns = &region.rows[y];
                let blocks = columns.len().div_ceil(BLOCK);
                let nothing = Best { correlation: -1.0, template: 0 };
                let mut best = vec![nothing; blocks * BLOCK];
                for (k, block) in best.chunks_exact_mut(BLOCK).enumerate() {
                    let start = y * self.stride + columns.start + k * BLOCK;
                    best_of_block(templates, &self.values[start..], self.stride, block);
                }
                best.truncate(columns.len());
                best
            })
            .collect();
        Map { rows, region }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn best_of_block(templates: &[Template], values: &[f32], stride: usize, best: &mut [Best]) {
    let (mut sums, mut squares) = ([0f32; BLOCK], [0f32; BLOCK]);
    for v in 0..SIDE {
        for u in 0..SIDE {
            let row = &values[v * stride + u..][..BLOCK];
            for k in 0..BLOCK {
                sums[k] += row[k];
                squares[k] += row[k] * row[k];
            }
        }
    }
    let mut factors = [0f32; BLOCK];
    for k in 0..BLOCK {
        let energy = squares[k] - sums[k] * sums[k] / (SIDE * SIDE) as f32;
        let least = LEAST_CONTRAST * LEAST_CONTRAST * (SIDE * SIDE) as f32;
        factors[k] = if energy > least { 1.0 / energy.sqrt() } else { 0.0 };
    }
    for (pair, two) in templates.chunks(2).enumerate() {
        // Two templates at a time halve the loads. An odd last template is paired with itself.
        let two = [&two[0].values, &two[two.len() - 1].values];
        let mut sums = [[0f32; BLOCK]; 2];
        for v in 0..SIDE {
            for u in 0..SIDE {
                let row = &values[v * stride + u..][..BLOCK];
                let [t0, t1] = two.map(|t| t[v * SIDE + u]);
                for k in 0..BLOCK {
                    sums[0][k] += t0 * row[k];
                    sums[1][k] += t1 * row[k];
                }
            }
        }
        for (n, sums) in sums.iter().enumerate() {
            for k in 0..BLOCK {
                let correlation = sums[k] * factors[k];
                if correlation > best[k].correlation {
                    best[k] = Best { correlation, template: (2 * pair + n) as u16 };
                }
            }
        }
    }
}

impl Map {
    fn get(&self, x: usize, y: usize) -> Option<f32> {
        let columns = self.region.rows.get(y)?;
        (columns.contains(&x)).then(|| self.rows[y][x - columns.start].correlation)
    }

    /// Returns the local maxima above `least`, best first, at most `count`.
    pub fn peaks(&self, least: f32, count: usize) -> Vec<Peak> {
        let mut peaks = Vec::new();
        for (y, (row, columns)) in self.rows.iter().zip(&self.region.rows).enumerate() {
            for (best, x) in row.iter().zip(columns.clone()) {
                if best.correlation > least && self.is_peak(x, y, best.correlation) {
                    peaks.push(Peak { x, y, best: *best });
                }
            }
        }
        peaks.sort_by(|a, b| {
            b.best.correlation.total_cmp(&a.best.correlation).then((a.y, a.x).cmp(&(b.y, b.x)))
        });
        peaks.truncate(count);
        peaks
    }

    fn is_peak(&self, x: usize, y: usize, value: f32) -> bool {
        (y.saturating_sub(1)..=y + 1).all(|v| {
            (x.saturating_sub(1)..=x + 1).all(|u| {
                // On a plateau the first pixel in reading order wins.
                self.get(u, v).is_none_or(|other| other < value || (other <= value && (v, u) >= (y, x)))
            })
        })
    }
}
