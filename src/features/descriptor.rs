//! Orientation and descriptor of a feature, from the gradients around it.
//!
//! The surroundings are sampled on a grid defined by a **local frame** `A`, a 2×2 map from grid
//! offsets to picture offsets. Gradients are differences of neighbouring samples, in grid
//! coordinates. The gradients are therefore invariant to rotation and scale and, for a general `A`,
//! to shear. The positions and weights of the grid are constants.
//!
//! - **Orientation** (Lowe 2004, section 5): a histogram of the gradient directions within 4.5 σ.
//!   Votes are weighted by magnitude and a Gaussian of 1.5 σ; there are 36 bins. Every peak of at
//!   least 0.8 times the highest is an orientation.
//! - **Descriptor** (Lowe 2004, section 6): 4 × 4 cells of side 3 σ, each with a histogram of 8
//!   directions. Votes are interpolated linearly between cells and directions and weighted by a
//!   Gaussian of 2 cells. The vector has unit length, with entries clipped at 0.2.
//! - **`RootSIFT`** (Arandjelović & Zisserman 2012): entries are divided by their sum, then
//!   replaced by their square roots. The Euclidean distance is then the Hellinger distance of the
//!   histograms. Each entry is stored as a byte, multiplied by 512.

use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::LazyLock;

use multiversion::multiversion;
use nalgebra::Matrix2;

use crate::geometry::Point;
use crate::image::{GrayPlane, interpolate_all};

/// Entries of a descriptor: 4 × 4 cells of 8 directions.
pub(super) const ENTRIES: usize = 128;

/// A `RootSIFT` descriptor: 512 times the square roots of fractions that add up to one.
pub type Descriptor = [u8; ENTRIES];

/// Gradients along a side of the grid.
const SIDE: usize = 25;
/// Samples along a side of the grid. A gradient is the difference of two samples.
const SAMPLES: usize = SIDE + 2;
/// Samples of a row, padded to whole vectors.
const STRIDE: usize = SAMPLES.next_multiple_of(16);
/// Number of gradients, padded to whole vectors.
const PADDED: usize = (SIDE * SIDE).next_multiple_of(16);

/// Bins of the orientation histogram.
const BINS: usize = 36;
/// Radius of the orientation histogram, in σ.
const ORIENTATION_REACH: f64 = 4.5;
/// Minimum height of a further orientation, as a fraction of the highest peak.
const SECOND_PEAK: f32 = 0.8;

const CELLS: usize = 4;
const DIRECTIONS: usize = 8;
/// Side of a cell, in σ.
const CELL: f64 = 3.0;
/// Gradients along the side of a cell.
const PER_CELL: f64 = 5.0;
/// Largest entry of a descriptor of unit length, so that one strong edge cannot dominate.
const LARGEST_ENTRY: f32 = 0.2;

/// Magnitudes and directions of the gradients on a grid. Directions are in turns, 0 ≤ t < 1.
struct Gradients {
    lengths: [f32; PADDED],
    turns: [f32; PADDED],
}

/// Weights that depend only on the position in the grid.
struct Weights {
    orientation: [f32; PADDED],
    descriptor: [f32; PADDED],
    /// Cell before each column or row of the grid, counted from a cell outside, and the weight of
    /// the next cell.
    cells: [(usize, f32); SIDE],
}

static WEIGHTS: LazyLock<Weights> = LazyLock::new(|| {
    let half = (SIDE / 2) as f64;
    let place = |k: usize| k as f64 - half;
    let radius = |k: usize| place(k % SIDE).hypot(place(k / SIDE));
    let gauss = |r: f64, sigma: f64| (-0.5 * (r / sigma).powi(2)).exp();
    let mut weights =
        Weights { orientation: [0.0; PADDED], descriptor: [0.0; PADDED], cells: [(0, 0.0); SIDE] };
    for k in 0..SIDE * SIDE {
        let r = radius(k);
        if r <= half {
            // A third of the radius is 1.5 σ.
            weights.orientation[k] = gauss(r, half / 3.0) as f32;
        }
        weights.descriptor[k] = gauss(r, 2.0 * PER_CELL) as f32;
    }
    for (k, cell) in weights.cells.iter_mut().enumerate() {
        // Cell centres are at −1.5, −0.5, 0.5 and 1.5. One more cell before them takes the votes
        // outside.
        let position = place(k) / PER_CELL + 0.5 * CELLS as f64 + 0.5;
        *cell = (position as usize, (position - position.floor()) as f32);
    }
    weights
});

/// Returns the orientations of a blob of size `sigma` in a plane of matching smoothness, radians
/// from x towards y.
pub(super) fn orientations(plane: &GrayPlane, centre: Point, sigma: f64) -> Vec<f64> {
    let spacing = ORIENTATION_REACH * sigma / (SIDE / 2) as f64;
    let gradients = gradients(plane, centre, &(Matrix2::identity() * spacing));
    let votes = votes(&gradients, &WEIGHTS.orientation);
    let mut histogram = [0f32; BINS];
    for k in 0..SIDE * SIDE {
        let bin = votes.bins[k] as usize % BINS;
        histogram[bin] += votes.shares[0][k];
        histogram[(bin + 1) % BINS] += votes.shares[1][k];
    }
    let at = |h: &[f32; BINS], k: usize, d: usize| h[(k + BINS + d - 2) % BINS];
    let smooth: [f32; BINS] = std::array::from_fn(|k| {
        let h = &histogram;
        (at(h, k, 0) + at(h, k, 4) + 4.0 * (at(h, k, 1) + at(h, k, 3)) + 6.0 * at(h, k, 2)) / 16.0
    });
    let highest = smooth.iter().copied().fold(0.0, f32::max);
    (0..BINS)
        .filter_map(|k| {
            let [before, here, after] = [1, 2, 3].map(|d| at(&smooth, k, d));
            let peak = here > before && here >= after && here >= SECOND_PEAK * highest;
            // The vertex of the parabola through three bins.
            let offset = 0.5 * (before - after) / (before - 2.0 * here + after);
            peak.then(|| f64::from((k as f32 + offset) / BINS as f32 * TAU).rem_euclid(f64::from(TAU)))
        })
        .collect()
}

/// Votes of gradients for the orientation of a blob.
struct Votes {
    bins: [u32; PADDED],
    /// Weights in the bin and in the next one.
    shares: [[f32; PADDED]; 2],
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn votes(gradients: &Gradients, weights: &[f32; PADDED]) -> Votes {
    let mut votes = Votes { bins: [0; PADDED], shares: [[0.0; PADDED]; 2] };
    for (k, weight) in weights.iter().enumerate() {
        let position = gradients.turns[k] * BINS as f32;
        let bin = position.floor();
        let (share, vote) = (position - bin, weight * gradients.lengths[k]);
        votes.bins[k] = bin as u32;
        (votes.shares[0][k], votes.shares[1][k]) = (vote * (1.0 - share), vote * share);
    }
    votes
}

/// Returns the descriptor of a blob with the local frame `frame`, which maps offsets in units of σ
/// along the feature's axes to picture offsets. A rotation by θ has the frame `σ R(θ)`. Returns
/// `None` when the surroundings are flat.
pub(super) fn describe(plane: &GrayPlane, centre: Point, frame: &Matrix2<f64>) -> Option<Descriptor> {
    histogram(&gradients(plane, centre, &(frame * (CELL / PER_CELL))))
}

/// Samples the grid around a point and returns the differences of neighbours as magnitudes and
/// directions.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn gradients(plane: &GrayPlane, centre: Point, grid: &Matrix2<f64>) -> Gradients {
    let [a, b, c, d] = [grid.m11, grid.m21, grid.m12, grid.m22].map(|v| v as f32);
    let (x, y) = (centre.x as f32, centre.y as f32);
    let (right, bottom) = (plane.frame().right() as f32, plane.frame().bottom() as f32);
    let half = (SAMPLES / 2) as f32;
    let (mut px, mut py) = ([0f32; SAMPLES * STRIDE], [0f32; SAMPLES * STRIDE]);
    for row in 0..SAMPLES {
        let v = row as f32 - half;
        for column in 0..STRIDE {
            let u = column as f32 - half;
            // Border pixels repeat outside the picture, without a gradient across the border.
            px[row * STRIDE + column] = (x + a * u + c * v).clamp(0.0, right);
            py[row * STRIDE + column] = (y + b * u + d * v).clamp(0.0, bottom);
        }
    }
    let mut samples = [0f32; SAMPLES * STRIDE];
    interpolate_all(plane, &px, &py, &mut samples);
    let (mut dx, mut dy) = ([0f32; PADDED], [0f32; PADDED]);
    for row in 0..SIDE {
        let line = |k: usize| &samples[(row + k) * STRIDE..(row + k + 1) * STRIDE];
        let (above, middle, below) = (line(0), line(1), line(2));
        for column in 0..SIDE {
            dx[row * SIDE + column] = middle[column + 2] - middle[column];
            dy[row * SIDE + column] = below[column + 1] - above[column + 1];
        }
    }
    let mut gradients = Gradients { lengths: [0.0; PADDED], turns: [0.0; PADDED] };
    for k in 0..PADDED {
        gradients.lengths[k] = (dx[k] * dx[k] + dy[k] * dy[k]).sqrt();
        gradients.turns[k] = turns(dx[k], dy[k]);
    }
    gradients
}

/// Returns the direction of a vector as a fraction of a full turn, to 10⁻⁴. The function has no
/// branches, so that loops over it vectorise.
#[inline]
fn turns(x: f32, y: f32) -> f32 {
    let (width, height) = (x.abs(), y.abs());
    let ratio = width.min(height) / width.max(height).max(1e-20);
    let square = ratio * ratio;
    let angle = ((-0.046_496_47 * square + 0.159_314_22) * square - 0.327_622_76) * square * ratio + ratio;
    let angle = if height > width { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    let angle = if y < 0.0 { TAU - angle } else { angle };
    (angle / TAU).clamp(0.0, 0.999_999_9)
}

/// Accumulates the votes of all gradients and normalises them.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx2", "x86_64+avx2", "aarch64+neon"))]
fn histogram(gradients: &Gradients) -> Option<Descriptor> {
    let weights = &*WEIGHTS;
    // A ring of cells around the 4 × 4 cells takes the votes outside.
    let mut cells = [[[0f32; DIRECTIONS]; CELLS + 2]; CELLS + 2];
    for row in 0..SIDE {
        let (cell_y, share_y) = weights.cells[row];
        for column in 0..SIDE {
            let (cell_x, share_x) = weights.cells[column];
            let k = row * SIDE + column;
            let length = gradients.lengths[k] * weights.descriptor[k];
            let direction = gradients.turns[k] * DIRECTIONS as f32;
            let mut votes = [0f32; DIRECTIONS];
            for (o, vote) in votes.iter_mut().enumerate() {
                let away = (direction - o as f32).abs();
                *vote = length * (1.0 - away.min(DIRECTIONS as f32 - away)).max(0.0);
            }
            for (dy, wy) in [(0, 1.0 - share_y), (1, share_y)] {
                for (dx, wx) in [(0, 1.0 - share_x), (1, share_x)] {
                    let cell = &mut cells[cell_y + dy][cell_x + dx];
                    for o in 0..DIRECTIONS {
                        cell[o] += wy * wx * votes[o];
                    }
                }
            }
        }
    }
    let mut entries = [0f32; ENTRIES];
    for (k, out) in entries.chunks_exact_mut(DIRECTIONS).enumerate() {
        out.copy_from_slice(&cells[1 + k / CELLS][1 + k % CELLS]);
    }
    let length = entries.iter().map(|v| v * v).sum::<f32>().sqrt();
    let mut sum = 0.0;
    for entry in &mut entries {
        *entry = entry.min(LARGEST_ENTRY * length);
        sum += *entry;
    }
    (sum > 1e-3).then(|| entries.map(|v| (512.0 * (v / sum).sqrt() + 0.5) as u8))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;

    #[test]
    fn directions_are_right_to_a_hundredth_of_a_degree() {
        for k in 0..720 {
            let angle = (k as f32 * 0.5).to_radians();
            let found = turns(3.0 * angle.cos(), 3.0 * angle.sin()) * TAU;
            let off = (found - angle).abs();
            assert!(off.min(TAU - off) < 3e-4, "{k}");
        }
        assert!(turns(0.0, 0.0) < 1.0 && turns(1.0, -1e-9) < 1.0);
    }

    #[test]
    fn a_ramp_has_one_orientation_and_describes_itself_by_one_direction() {
        for degrees in [0.0, 33.0, 90.0, 201.5, 359.0] {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            let plane = GrayPlane::from_fn(Frame::new(101, 101), |x, y| {
                (128.0 + cos * (x as f64 - 50.0) + sin * (y as f64 - 50.0)) as f32
            });
            let centre = Point::new(50.2, 49.7);
            let found = orientations(&plane, centre, 3.0);
            assert_eq!(found.len(), 1);
            let off = (found[0].to_degrees() - degrees).abs();
            // Parallel gradients are the worst case for a parabola through three bins of 10°.
            assert!(off.min(360.0 - off) < 1.0, "{degrees} {found:?}");
            let turned = Matrix2::new(cos, -sin, sin, cos) * 3.0;
            let descriptor = describe(&plane, centre, &turned).unwrap();
            for (k, entry) in descriptor.iter().enumerate() {
                let along = k % DIRECTIONS == 0;
                assert!(if along { *entry > 100 } else { *entry < 12 }, "{degrees} {k} {entry}");
            }
        }
        assert!(
            describe(
                &GrayPlane::from_fn(Frame::new(40, 40), |_, _| 9.0),
                Point::new(20.0, 20.0),
                &Matrix2::identity()
            )
            .is_none()
        );
    }
}
