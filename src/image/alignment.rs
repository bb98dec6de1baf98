//! Sub-pixel alignment of a patch under an affine map, gain and offset.
//!
//! Least squares over shift, affine map, gain and offset (Lucas & Kanade 1981; Baker & Matthews
//! 2004, inverse compositional):
//!
//! ```text
//!     gain·I1(p + x) + offset = I2(q + A x)        x in a square around 0
//! ```
//!
//! Each step moves the patch of the first image and applies the inverse to the map. Only gradients of
//! the first image are needed, so the matrix of the equations is the same for all steps.
//!
//! # Pitfalls
//! - Weakly textured patches do not determine the affine map, and patches with one texture
//!   direction slide along it. [`Hold`] therefore penalises changes of the affine map.

use std::ops::Range;

use multiversion::multiversion;
use nalgebra::{Cholesky, SMatrix, SVector, U8};

use super::GrayPlane;
use super::patch::{HALF, Warp, offsets};
use super::plane::interpolate_all;
use crate::geometry::{Point, Vector};

/// Position of a first-image patch in the second image: `at + affine · x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub at: Point,
    pub affine: Warp,
}

/// Settings of an alignment.
#[derive(Debug)]
pub(crate) struct Alignment {
    /// Pixels of the patch on each side of its centre.
    half: usize,
    iterations: usize,
    /// Convergence threshold: a shorter step ends the iteration, px.
    settled: f64,
    /// Whether a patch that has not converged is rejected.
    must_settle: bool,
    /// Largest accepted distance from the start, px.
    largest_move: f64,
    /// Accepted determinants of the affine map; `None` accepts all.
    determinants: Option<Range<f64>>,
    /// Minimum fraction of the samples inside both images; samples outside, or where there is no
    /// picture, are ignored. `None` keeps all samples and repeats the border intensities outside.
    least_inside: Option<f64>,
    hold: Hold,
    /// Grey level subtracted from the intensities. `unit` is the unit of offsets from the centre,
    /// px. Both condition the equations.
    middle: f64,
    unit: f64,
}

/// Regularisation of the affine map.
#[derive(Debug)]
enum Hold {
    /// Penalty on each step of the affine map, squared grey levels.
    Step(f64),
    /// Penalty on the distance from the start, as a fraction of the sum of squared image gradients.
    Start(f64),
}

impl Alignment {
    /// Settings for pairs of similar corners, from starts within about a pixel. The patch is larger than
    /// the compared one, because the error of a position falls with the side of the patch.
    pub(crate) const STRICT: Self = Self {
        half: LARGEST,
        iterations: 25,
        settled: 0.01,
        must_settle: true,
        largest_move: 1.5,
        determinants: Some(0.2..4.0),
        least_inside: None,
        // About the texture of one grey level per pixel over a whole patch.
        hold: Hold::Step(500.0),
        middle: 0.0,
        unit: HALF as f64,
    };

    /// Settings for any place of an image, borders included, from starts found at a coarser level.
    pub(crate) const LENIENT: Self = Self {
        half: HALF,
        iterations: 8,
        settled: 0.02,
        must_settle: false,
        largest_move: 2.5,
        determinants: None,
        least_inside: Some(LEAST_INSIDE),
        hold: Hold::Start(0.1),
        middle: 128.0,
        unit: 1.0,
    };
}

/// Minimum fraction of a patch inside the image. A patch in the corner of an image is a little more
/// than a quarter inside.
pub(crate) const LEAST_INSIDE: f64 = 0.25;

type Vector8 = SVector<f64, 8>;
type Matrix8 = SMatrix<f64, 8, 8>;

/// Finds the placement near `start` that best aligns the surroundings of `point1` in the first
/// plane with the second plane. Returns `None` when the placement diverges, does not converge, or
/// lies too far outside or where there is no picture.
pub(crate) fn align(
    planes: [&GrayPlane; 2],
    point1: Point,
    start: Placement,
    how: &Alignment,
) -> Option<Placement> {
    let counts = |image: usize, p: Point| {
        how.least_inside.is_none() || planes[image].frame().contains(p) && planes[image].is_clear(p, 0.0)
    };
    // Samples that count as they are must all be picture.
    let clear = if how.least_inside.is_none() { HALF as f64 } else { 0.0 };
    let area = (2 * how.half + 1).pow(2);
    let least = how.least_inside.unwrap_or(0.0) * area as f64;
    let samples: Vec<Vector> = offsets(how.half).filter(|x| counts(0, point1 + x)).collect();
    let mut sampler = Sampler::new(planes[1]);
    let mut placed = start;
    let mut equations: Option<Equations> = None;
    let mut gain = 1.0;
    for _ in 0..how.iterations {
        let used = sampler.sample(&samples, &placed, |q| counts(1, q));
        if (used as f64) < least {
            return None;
        }
        let equations = if let Some(same) = equations.take().filter(|equations| equations.used == used) {
            equations.insert(same)
        } else {
            let row = |x: &Vector| row(planes[0], point1, x, how);
            let rows = samples.iter().zip(&sampler.counts).map(|(x, counts)| counts.then(|| row(x)));
            equations.insert(Equations::new(rows, used, how)?)
        };
        let mut right = equations.right(&sampler.values, how.middle);
        if let Hold::Start(_) = how.hold {
            // The change that would lead back to the start.
            let back = placed.affine.try_inverse()? * (placed.affine - start.affine) * (how.unit * gain);
            for k in 2..6 {
                right[k] += equations.penalty * back[((k - 2) / 2, (k - 2) % 2)];
            }
        }
        let solution = equations.cholesky.solve(&right);
        gain = solution[6];
        let step = |k: usize| solution[k] / gain;
        let change = Warp::new(step(2), step(3), step(4), step(5)) / how.unit;
        placed.affine *= (Warp::identity() + change).try_inverse()?;
        let step = placed.affine * Vector::new(step(0), step(1));
        placed.at -= step;
        let far = (placed.at - start.at).norm();
        let determinant = placed.affine.determinant();
        if !far.is_finite()
            || far > how.largest_move
            || !planes[1].is_clear(placed.at, clear)
            || how.determinants.as_ref().is_some_and(|allowed| !allowed.contains(&determinant))
        {
            return None;
        }
        if step.norm() < how.settled {
            return Some(placed);
        }
    }
    (!how.must_settle).then_some(placed)
}

/// Returns the bilinear value at a point and its central differences in x and in y. Outside the
/// image the nearest border value counts.
fn value_and_slopes(plane: &GrayPlane, p: Point) -> [f64; 3] {
    let frame = plane.frame();
    if !(p.x >= 1.0 && p.y >= 1.0 && p.x < frame.right() - 1.0 && p.y < frame.bottom() - 1.0) {
        let value = |dx: f64, dy: f64| f64::from(plane.sample(Point::new(p.x + dx, p.y + dy)));
        let slopes = [value(1.0, 0.0) - value(-1.0, 0.0), value(0.0, 1.0) - value(0.0, -1.0)];
        return [value(0.0, 0.0), 0.5 * slopes[0], 0.5 * slopes[1]];
    }
    // All five samples share their position between pixels, so twelve pixels and one set of weights
    // suffice.
    let (x, y) = (p.x as usize, p.y as usize);
    let (fx, fy) = ((p.x - x as f64) as f32, (p.y - y as f64) as f32);
    let row = |k: usize| &plane.row(y + k - 1)[x - 1..x + 3];
    let across = |row: &[f32], k: usize| row[k] + (row[k + 1] - row[k]) * fx;
    let down = |above: f32, below: f32| above + (below - above) * fy;
    let [before, top, below, after] = [row(0), row(1), row(2), row(3)];
    let [left, middle, right] = [0, 1, 2].map(|k| down(across(top, k), across(below, k)));
    let upper = down(across(before, 1), across(top, 1));
    let lower = down(across(below, 1), across(after, 1));
    [f64::from(middle), 0.5 * f64::from(right - left), 0.5 * f64::from(lower - upper)]
}

/// Coefficients of the equation of one sample: gain·(I1 + ∇I1·(shift + change·x)) + offset.
fn row(plane1: &GrayPlane, point1: Point, x: &Vector, how: &Alignment) -> [f64; 8] {
    let [value, gx, gy] = value_and_slopes(plane1, point1 + x);
    let (x, y) = (x.x / how.unit, x.y / how.unit);
    [gx, gy, gx * x, gx * y, gy * x, gy * y, value - how.middle, 1.0]
}

/// Largest `half` of an alignment.
const LARGEST: usize = 10;
/// Samples of the largest patch.
const AREA: usize = (2 * LARGEST + 1) * (2 * LARGEST + 1);
/// Numbers added in parallel.
const LANES: usize = 8;
/// A length that [`interpolate_all`] accepts.
const PADDED: usize = AREA.next_multiple_of(16);

/// Values of the second plane under the current placement.
struct Sampler<'a> {
    plane: &'a GrayPlane,
    x: [f32; PADDED],
    y: [f32; PADDED],
    values: [f32; PADDED],
    counts: Vec<bool>,
}

impl<'a> Sampler<'a> {
    fn new(plane: &'a GrayPlane) -> Self {
        Self { plane, x: [0.0; PADDED], y: [0.0; PADDED], values: [0.0; PADDED], counts: Vec::new() }
    }

    /// Samples around the placement and returns the number of samples that count. Outside the plane, the
    /// nearest border value is taken.
    fn sample(&mut self, offsets: &[Vector], placed: &Placement, counts: impl Fn(Point) -> bool) -> usize {
        let frame = self.plane.frame();
        let (right, bottom) = (frame.right().max(0.0) as f32, frame.bottom().max(0.0) as f32);
        self.counts.clear();
        for (k, offset) in offsets.iter().enumerate() {
            let q = placed.at + placed.affine * offset;
            self.x[k] = (q.x as f32).clamp(0.0, right);
            self.y[k] = (q.y as f32).clamp(0.0, bottom);
            self.counts.push(counts(q));
        }
        let padded = offsets.len().next_multiple_of(16);
        interpolate_all(self.plane, &self.x[..padded], &self.y[..padded], &mut self.values[..padded]);
        self.counts.iter().filter(|counts| **counts).count()
    }
}

/// Normal equations of the steps, which stay the same while the samples do.
struct Equations {
    /// Number of samples that count.
    used: usize,
    /// Coefficients of each unknown, zero for samples that do not count.
    columns: Vec<[f64; PADDED]>,
    /// Length of the columns that is used, a multiple of [`LANES`].
    padded: usize,
    cholesky: Cholesky<f64, U8>,
    /// Penalty on the affine map.
    penalty: f64,
}

impl Equations {
    fn new(rows: impl Iterator<Item = Option<[f64; 8]>>, used: usize, how: &Alignment) -> Option<Self> {
        let mut columns = vec![[0.0; PADDED]; 8];
        let mut length = 0;
        for (k, row) in rows.enumerate() {
            for (column, value) in columns.iter_mut().zip(row.unwrap_or_default()) {
                column[k] = value;
            }
            length = k + 1;
        }
        let padded = length.next_multiple_of(LANES);
        let products = products(&columns, padded);
        let mut normal = Matrix8::from_fn(|row, column| products[row.max(column)][row.min(column)]);
        let penalty = match how.hold {
            Hold::Step(penalty) => penalty,
            Hold::Start(share) => {
                share * (normal[(0, 0)] + normal[(1, 1)]) * (how.half as f64 / how.unit).powi(2)
            }
        };
        for k in 2..6 {
            normal[(k, k)] += penalty;
        }
        Some(Self { used, columns, padded, cholesky: normal.cholesky()?, penalty })
    }

    /// Returns the right-hand sides for the values of the second image.
    fn right(&self, values: &[f32; PADDED], middle: f64) -> Vector8 {
        let values = values.map(|value| f64::from(value) - middle);
        Vector8::from_fn(|k, _| dot(&self.columns[k][..self.padded], &values[..self.padded]))
    }
}

/// Returns the product of each column with itself and every earlier column, over the first
/// `padded` entries.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn products(columns: &[[f64; PADDED]], padded: usize) -> [[f64; 8]; 8] {
    let mut products = [[0.0; 8]; 8];
    for i in 0..8 {
        for j in 0..=i {
            products[i][j] = dot(&columns[i][..padded], &columns[j][..padded]);
        }
    }
    products
}

/// Returns the sum of products of two slices of a length divisible by `LANES`.
#[expect(clippy::inline_always, reason = "it must take on the target features of its caller")]
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0f64; LANES];
    for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Frame;

    fn texture(x: f64, y: f64) -> f32 {
        (120.0 + 50.0 * (0.41 * x).sin() * (0.37 * y).cos() + 30.0 * (0.23 * x + 0.31 * y).sin()) as f32
    }

    #[test]
    fn alignment_finds_a_fraction_of_a_pixel_under_a_change_of_brightness() {
        let frame = Frame::new(60, 60);
        let plane1 = GrayPlane::from_fn(frame, |x, y| texture(x as f64, y as f64));
        let (dx, dy) = (0.37, -0.61);
        let plane2 = GrayPlane::from_fn(frame, |x, y| 0.8 * texture(x as f64 - dx, y as f64 - dy) + 12.0);
        let corner = Point::new(30.0, 28.0);
        let start = Placement { at: corner, affine: Warp::identity() };
        for how in [&Alignment::STRICT, &Alignment::LENIENT] {
            let Placement { at, .. } = align([&plane1, &plane2], corner, start, how).unwrap();
            assert!((at - Point::new(30.0 + dx, 28.0 + dy)).norm() < 0.03, "{at}");
        }
    }

    #[test]
    fn alignment_follows_a_turned_and_scaled_surface() {
        let frame = Frame::new(80, 80);
        let truth = Warp::new(1.1, -0.25, 0.2, 1.15);
        let (from, to) = (Point::new(40.0, 38.0), Point::new(41.3, 39.6));
        let plane1 = GrayPlane::from_fn(frame, |x, y| texture(x as f64, y as f64));
        let inverse = truth.try_inverse().unwrap();
        let plane2 = GrayPlane::from_fn(frame, |x, y| {
            let p = from + inverse * (Point::new(x as f64, y as f64) - to);
            texture(p.x, p.y)
        });
        let start = Placement { at: Point::new(41.0, 40.0), affine: Warp::new(0.95, -0.3, 0.3, 0.95) };
        let Placement { at, affine } = align([&plane1, &plane2], from, start, &Alignment::STRICT).unwrap();
        assert!((at - to).norm() < 0.03, "{at}");
        assert!((affine - truth).norm() < 0.05, "{affine}");
    }

    #[test]
    fn values_and_slopes_are_those_of_interpolation() {
        let plane = GrayPlane::from_fn(Frame::new(30, 20), |x, y| texture(x as f64, y as f64));
        for (x, y) in [(8.3, 9.7), (1.0, 1.0), (28.2, 9.0), (27.9, 17.9), (0.4, 19.5), (-3.0, 40.0)] {
            let value = |dx: f64, dy: f64| f64::from(plane.sample(Point::new(x + dx, y + dy)));
            let expected = [
                value(0.0, 0.0),
                0.5 * (value(1.0, 0.0) - value(-1.0, 0.0)),
                0.5 * (value(0.0, 1.0) - value(0.0, -1.0)),
            ];
            let found = value_and_slopes(&plane, Point::new(x, y));
            // Single precision at some hundred grey levels.
            let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-3, "{x} {y}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn flat_patches_are_not_aligned() {
        let flat = GrayPlane::from_fn(Frame::new(30, 30), |_, _| 5.0);
        let start = Placement { at: Point::new(12.0, 13.0), affine: Warp::identity() };
        assert!(align([&flat, &flat], start.at, start, &Alignment::STRICT).is_none());
    }
}
