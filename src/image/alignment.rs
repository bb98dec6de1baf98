//! Sub-pixel alignment of a patch under an affine map, gain and offset.
//!
//! Least squares over shift, affine map, gain and offset (Lucas & Kanade 1981; Baker & Matthews
//! 2004, forward additive):
//!
//! ```text
//!     gain·I1(p + x) + offset = I2(q + A x)        x in a square around 0
//! ```
//!
//! # Pitfalls
//! - Weakly textured patches do not determine the affine map, and patches with one texture
//!   direction slide along it. [`Hold`] therefore penalises changes of the affine map.

use std::ops::Range;

use multiversion::multiversion;
use nalgebra::{SMatrix, SVector};

use super::GrayPlane;
use super::patch::{HALF, Warp, offsets};
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
    /// Minimum fraction of the samples inside both images; samples outside are ignored. `None`
    /// keeps all samples and repeats the border intensities outside.
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
    /// Settings for pairs of similar corners, from starts within about a pixel. The patch is larger than the one that is
    /// compared: the error of a position falls with the side of the patch.
    pub(crate) const STRICT: Self = Self {
        half: LARGEST,
        iterations: 10,
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
/// lies too far outside.
pub(crate) fn align(
    planes: [&GrayPlane; 2],
    point1: Point,
    start: Placement,
    how: &Alignment,
) -> Option<Placement> {
    let counts = |image: usize, p: Point| how.least_inside.is_none() || planes[image].frame().contains(p);
    let area = (2 * how.half + 1).pow(2);
    let mut reference: Vec<(Vector, f64)> = Vec::with_capacity(area);
    for x in offsets(how.half) {
        if counts(0, point1 + x) {
            reference.push((x, f64::from(planes[0].sample(point1 + x)) - how.middle));
        }
    }
    let least = how.least_inside.unwrap_or(0.0) * area as f64;
    let mut placed = start;
    let mut equations = Equations::default();
    for _ in 0..how.iterations {
        equations.count = 0;
        for (offset, reference) in &reference {
            let q = placed.at + placed.affine * offset;
            if !counts(1, q) {
                continue;
            }
            let [value, gx, gy] = value_and_slopes(planes[1], q);
            // gain·I1 + offset − ∇I2·(step + dA x) = I2
            let (x, y) = (offset.x / how.unit, offset.y / how.unit);
            let row = [-gx, -gy, -gx * x, -gx * y, -gy * x, -gy * y, *reference, 1.0];
            equations.push(row, value - how.middle);
        }
        if (equations.count as f64) < least {
            return None;
        }
        let (mut normal, mut right) = equations.normal();
        let gradient = normal[(0, 0)] + normal[(1, 1)];
        for k in 2..6 {
            match how.hold {
                Hold::Step(penalty) => normal[(k, k)] += penalty,
                Hold::Start(share) => {
                    let penalty = share * gradient * (how.half as f64 / how.unit).powi(2);
                    let drift = how.unit * (placed.affine - start.affine)[((k - 2) / 2, (k - 2) % 2)];
                    normal[(k, k)] += penalty;
                    right[k] -= penalty * drift;
                }
            }
        }
        let solution = normal.cholesky()?.solve(&right);
        let step = Vector::new(solution[0], solution[1]);
        placed.at += step;
        placed.affine += Warp::new(solution[2], solution[3], solution[4], solution[5]) / how.unit;
        let far = (placed.at - start.at).norm();
        let determinant = placed.affine.determinant();
        if !far.is_finite()
            || far > how.largest_move
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

/// Largest `half` of an alignment.
const LARGEST: usize = 10;
/// Samples of the largest patch.
const AREA: usize = (2 * LARGEST + 1) * (2 * LARGEST + 1);
/// Numbers added in parallel.
const LANES: usize = 8;
const PADDED: usize = AREA.next_multiple_of(LANES);

/// Equations of a least-squares step, stored column by column.
struct Equations {
    count: usize,
    /// Eight coefficients and the right-hand side.
    columns: Vec<[f64; PADDED]>,
}

impl Default for Equations {
    fn default() -> Self {
        Self { count: 0, columns: vec![[0.0; PADDED]; 9] }
    }
}

impl Equations {
    fn push(&mut self, row: [f64; 8], right: f64) {
        for (column, value) in self.columns.iter_mut().zip(row) {
            column[self.count] = value;
        }
        self.columns[8][self.count] = right;
        self.count += 1;
    }

    /// Returns the normal equations.
    fn normal(&mut self) -> (Matrix8, Vector8) {
        let used = self.count.next_multiple_of(LANES);
        for column in &mut self.columns {
            column[self.count..used].fill(0.0);
        }
        let products = products(&self.columns, used);
        let entry = |row: usize, column: usize| products[row.max(column)][row.min(column)];
        (Matrix8::from_fn(entry), Vector8::from_fn(|k, _| products[8][k]))
    }
}

/// Returns the product of each column with itself and every earlier column, over the `used` entries.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn products(columns: &[[f64; PADDED]], used: usize) -> [[f64; 9]; 9] {
    let mut products = [[0.0; 9]; 9];
    for i in 0..9 {
        for j in 0..=i {
            let mut sums = [0f64; LANES];
            for (a, b) in columns[i][..used].chunks_exact(LANES).zip(columns[j][..used].chunks_exact(LANES)) {
                for k in 0..LANES {
                    sums[k] += a[k] * b[k];
                }
            }
            let [a, b, c, d, e, f, g, h] = sums;
            products[i][j] = ((a + e) + (c + g)) + ((b + f) + (d + h));
        }
    }
    products
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
