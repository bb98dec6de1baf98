//! Normal equations of an alignment: values and slopes of the first image, and their products.

use multiversion::multiversion;
use nalgebra::{Cholesky, SMatrix, SVector, U8};

use super::GrayPlane;
use super::alignment_settings::{Alignment, Hold, LARGEST};
use crate::geometry::{Point, Vector};

type Vector8 = SVector<f64, 8>;
type Matrix8 = SMatrix<f64, 8, 8>;

/// Samples along a side of the largest patch.
const LARGEST_SIDE: usize = 2 * LARGEST + 1;
/// Samples of the largest patch.
const AREA: usize = LARGEST_SIDE * LARGEST_SIDE;
/// Numbers added in parallel.
const LANES: usize = 8;
/// A length that [`interpolate_all`](super::interpolate_all) accepts.
pub(super) const PADDED: usize = AREA.next_multiple_of(16);

/// Offsets of the samples from the centre of the patch, px.
pub(super) struct SampledOffsets {
    pub x: [f64; PADDED],
    pub y: [f64; PADDED],
    count: usize,
}

impl FromIterator<Vector> for SampledOffsets {
    fn from_iter<I: IntoIterator<Item = Vector>>(offsets: I) -> Self {
        let mut samples = Self { x: [0.0; PADDED], y: [0.0; PADDED], count: 0 };
        for offset in offsets {
            (samples.x[samples.count], samples.y[samples.count]) = (offset.x, offset.y);
            samples.count += 1;
        }
        samples
    }
}

impl SampledOffsets {
    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Returns the number of samples with padding, a multiple of sixteen.
    pub fn padded(&self) -> usize {
        self.count.next_multiple_of(16)
    }

    /// Returns the offsets in their order.
    pub fn iter(&self) -> impl Iterator<Item = Vector> {
        self.x.iter().zip(&self.y).take(self.count).map(|(x, y)| Vector::new(*x, *y))
    }
}

/// Normal equations of the steps, which stay the same while the samples do.
pub(super) struct Equations {
    /// Number of samples that count.
    pub used: usize,
    /// Coefficients of each unknown, zero for samples that do not count.
    columns: Vec<[f64; PADDED]>,
    /// Length of the columns that is used, a multiple of [`LANES`].
    padded: usize,
    pub cholesky: Cholesky<f64, U8>,
    /// Penalty on the affine map.
    pub penalty: f64,
}

impl Equations {
    /// Returns the equations of the samples that count, of all if `counts` is empty.
    pub fn new(
        plane1: &GrayPlane,
        point1: Point,
        samples: &SampledOffsets,
        counts: &[bool],
        how: &Alignment,
    ) -> Option<Self> {
        let mut slopes = Slopes::default();
        if samples.len() != (2 * how.half + 1).pow(2) || !slopes.of_square(plane1, point1, how.half) {
            slopes.of_each(plane1, point1, samples);
        }
        let mut columns = vec![[0.0; PADDED]; 8];
        fill(&mut columns, &slopes, samples, how);
        for column in &mut columns {
            column[samples.len()..].fill(0.0);
            for (value, _) in column.iter_mut().zip(counts).filter(|(_, counts)| !**counts) {
                *value = 0.0;
            }
        }
        let used = if counts.is_empty() { samples.len() } else { counts.iter().filter(|c| **c).count() };
        let padded = samples.len().next_multiple_of(LANES);
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
    pub fn right(&self, values: &[f32; PADDED], middle: f64) -> Vector8 {
        Vector8::from(right_hand_sides(&self.columns, &values[..self.padded], middle))
    }
}

/// Bilinear values of a patch, and twice their slopes in x and in y.
struct Slopes {
    value: [f32; PADDED],
    across: [f64; PADDED],
    down: [f64; PADDED],
}

impl Default for Slopes {
    fn default() -> Self {
        Self { value: [0.0; PADDED], across: [0.0; PADDED], down: [0.0; PADDED] }
    }
}

impl Slopes {
    /// Samples each offset by itself.
    fn of_each(&mut self, plane: &GrayPlane, point: Point, samples: &SampledOffsets) {
        for (k, offset) in samples.iter().enumerate() {
            let (value, [across, down]) = value_and_slopes(plane, point + offset);
            (self.value[k], self.across[k], self.down[k]) = (value, across, down);
        }
    }

    /// Samples a square of `2 half + 1` pixels a side, row by row. Returns whether it is inside the
    /// plane; otherwise samples nothing.
    fn of_square(&mut self, plane: &GrayPlane, point: Point, half: usize) -> bool {
        let side = 2 * half + 1;
        let offset = |k: usize| k as f64 - half as f64;
        let is_inside = |k: usize| is_inside(plane, Point::new(point.x + offset(k), point.y + offset(k)));
        if !is_inside(0) || !is_inside(side - 1) {
            return false;
        }
        // Pixel before each sample along an axis, and the position between the pixels.
        let axis = |centre: f64| {
            let first = (centre + offset(0)) as usize;
            let mut between = [0f32; LARGEST_SIDE];
            for (k, between) in between.iter_mut().take(side).enumerate() {
                *between = (centre + offset(k) - (first + k) as f64) as f32;
            }
            // Rounding may move a sample to the next pixel.
            let is_regular = (0..side).all(|k| (centre + offset(k)) as usize == first + k);
            is_regular.then_some((first, between))
        };
        let (Some((x, right)), Some((y, below))) = (axis(point.x), axis(point.y)) else { return false };
        let width = plane.frame().width;
        let pixels = &plane.values()[(y - 1) * width + x - 1..];
        slopes_of_square(pixels, width, [&right[..side], &below[..side]], self);
        true
    }
}

/// Returns whether a sample and its four neighbours are inside the plane.
fn is_inside(plane: &GrayPlane, p: Point) -> bool {
    let frame = plane.frame();
    p.x >= 1.0 && p.y >= 1.0 && p.x < frame.right() - 1.0 && p.y < frame.bottom() - 1.0
}

/// Returns the bilinear value at a point and its differences over two pixels in x and in y. Outside
/// the image the nearest border value counts.
fn value_and_slopes(plane: &GrayPlane, p: Point) -> (f32, [f64; 2]) {
    if !is_inside(plane, p) {
        let value = |dx: f64, dy: f64| f64::from(plane.sample(Point::new(p.x + dx, p.y + dy)));
        let slopes = [value(1.0, 0.0) - value(-1.0, 0.0), value(0.0, 1.0) - value(0.0, -1.0)];
        return (plane.sample(p), slopes);
    }
    let (x, y) = (p.x as usize, p.y as usize);
    let (fx, fy) = ((p.x - x as f64) as f32, (p.y - y as f64) as f32);
    let mut slopes = Slopes::default();
    let width = plane.frame().width;
    let pixels = &plane.values()[(y - 1) * width + x - 1..];
    slopes_of_square(pixels, width, [&[fx], &[fy]], &mut slopes);
    (slopes.value[0], [slopes.across[0], slopes.down[0]])
}

/// Samples a square whose upper left sample lies in the second pixel of the second row of `pixels`.
/// All five values of a sample share their position between pixels, so twelve pixels suffice.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn slopes_of_square(pixels: &[f32], width: usize, [right, below]: [&[f32]; 2], out: &mut Slopes) {
    let side = right.len();
    for (row, fy) in below.iter().enumerate() {
        let line = |k: usize| &pixels[(row + k) * width..][..side + 3];
        let (before, top, bottom, after) = (line(0), line(1), line(2), line(3));
        let own = row * side..(row + 1) * side;
        let (value, across) = (&mut out.value[own.clone()], &mut out.across[own.clone()]);
        let down = &mut out.down[own];
        for k in 0..side {
            let fx = right[k];
            let above = before[k + 1] + (before[k + 2] - before[k + 1]) * fx;
            let under = after[k + 1] + (after[k + 2] - after[k + 1]) * fx;
            let top0 = top[k] + (top[k + 1] - top[k]) * fx;
            let top1 = top[k + 1] + (top[k + 2] - top[k + 1]) * fx;
            let top2 = top[k + 2] + (top[k + 3] - top[k + 2]) * fx;
            let bottom0 = bottom[k] + (bottom[k + 1] - bottom[k]) * fx;
            let bottom1 = bottom[k + 1] + (bottom[k + 2] - bottom[k + 1]) * fx;
            let bottom2 = bottom[k + 2] + (bottom[k + 3] - bottom[k + 2]) * fx;
            value[k] = top1 + (bottom1 - top1) * fy;
            let (left, right) = (top0 + (bottom0 - top0) * fy, top2 + (bottom2 - top2) * fy);
            let (upper, lower) = (above + (top1 - above) * fy, bottom1 + (under - bottom1) * fy);
            (across[k], down[k]) = (f64::from(right - left), f64::from(lower - upper));
        }
    }
}

/// Computes the coefficients of the equations of all samples: gain·(I1 + ∇I1·(shift + change·x)) + offset.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn fill(columns: &mut [[f64; PADDED]], slopes: &Slopes, samples: &SampledOffsets, how: &Alignment) {
    let [gx, gy, xx, xy, yx, yy, value, one] = columns else { return };
    for k in 0..PADDED {
        let (x, y) = (samples.x[k] / how.unit, samples.y[k] / how.unit);
        let (across, down) = (0.5 * slopes.across[k], 0.5 * slopes.down[k]);
        (gx[k], gy[k]) = (across, down);
        (xx[k], xy[k]) = (across * x, across * y);
        (yx[k], yy[k]) = (down * x, down * y);
        (value[k], one[k]) = (f64::from(slopes.value[k]) - how.middle, 1.0);
    }
}

/// Returns the product of each column with the values less `middle`.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn right_hand_sides(columns: &[[f64; PADDED]], values: &[f32], middle: f64) -> [f64; 8] {
    let mut wide = [0.0; PADDED];
    for k in 0..values.len() {
        wide[k] = f64::from(values[k]) - middle;
    }
    let wide = &wide[..values.len()];
    let mut right = [0.0; 8];
    for k in (0..8).step_by(4) {
        let found =
            dots([&columns[k], &columns[k + 1], &columns[k + 2], &columns[k + 3]], [wide], wide.len());
        for i in 0..4 {
            right[k + i] = found[i][0];
        }
    }
    right
}

/// Returns the product of each column with itself and every earlier column, over the first
/// `padded` entries.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn products(columns: &[[f64; PADDED]], padded: usize) -> [[f64; 8]; 8] {
    let mut products = [[0.0; 8]; 8];
    for i in (0..8).step_by(2) {
        for j in (0..=i).step_by(2) {
            let found = dots([&columns[i], &columns[i + 1]], [&columns[j], &columns[j + 1]], padded);
            for k in 0..2 {
                (products[i + k][j], products[i + k][j + 1]) = (found[k][0], found[k][1]);
            }
        }
    }
    products
}

/// Returns the sums of products of each of some slices with each of others, over `length` entries,
/// a multiple of `LANES`.
#[expect(clippy::inline_always, reason = "it must take on the target features of its caller")]
#[inline(always)]
fn dots<const A: usize, const B: usize>(a: [&[f64]; A], b: [&[f64]; B], length: usize) -> [[f64; B]; A] {
    let mut sums = [[[0f64; LANES]; B]; A];
    let mut first = 0;
    while first < length {
        for i in 0..A {
            let own = &a[i][first..first + LANES];
            for j in 0..B {
                let other = &b[j][first..first + LANES];
                for k in 0..LANES {
                    sums[i][j][k] += own[k] * other[k];
                }
            }
        }
        first += LANES;
    }
    let mut totals = [[0.0; B]; A];
    for i in 0..A {
        for j in 0..B {
            let [a, b, c, d, e, f, g, h] = sums[i][j];
            totals[i][j] = ((a + e) + (c + g)) + ((b + f) + (d + h));
        }
    }
    totals
}

#[cfg(test)]
mod tests {
    use super::super::patch::{HALF, offsets};
    use super::*;
    use crate::geometry::Frame;

    fn texture(x: f64, y: f64) -> f32 {
        (120.0 + 50.0 * (0.41 * x).sin() * (0.37 * y).cos() + 30.0 * (0.23 * x + 0.31 * y).sin()) as f32
    }

    #[test]
    fn values_and_slopes_are_those_of_interpolation() {
        let plane = GrayPlane::from_fn(Frame::new(30, 20), |x, y| texture(x as f64, y as f64));
        for (x, y) in [(8.3, 9.7), (1.0, 1.0), (28.2, 9.0), (27.9, 17.9), (0.4, 19.5), (-3.0, 40.0)] {
            let value = |dx: f64, dy: f64| f64::from(plane.sample(Point::new(x + dx, y + dy)));
            let expected =
                [value(0.0, 0.0), value(1.0, 0.0) - value(-1.0, 0.0), value(0.0, 1.0) - value(0.0, -1.0)];
            let (own, [across, down]) = value_and_slopes(&plane, Point::new(x, y));
            let found = [f64::from(own), across, down];
            // Single precision at some hundred grey levels.
            let apart = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 2e-3, "{x} {y}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn a_square_is_sampled_like_its_points() {
        let plane = GrayPlane::from_fn(Frame::new(60, 50), |x, y| texture(x as f64, y as f64));
        for half in [HALF, LARGEST] {
            let samples: SampledOffsets = offsets(half).collect();
            for (x, y) in [(30.0, 21.0), (25.37, 24.83), (12.999_999_999_999_998, 13.5)] {
                let point = Point::new(x, y);
                let (mut square, mut each) = (Slopes::default(), Slopes::default());
                each.of_each(&plane, point, &samples);
                if square.of_square(&plane, point, half) {
                    let slopes = |own: &Slopes| [own.across, own.down].map(|all| all.map(f64::to_bits));
                    assert_eq!(square.value.map(f32::to_bits), each.value.map(f32::to_bits));
                    assert_eq!(slopes(&square), slopes(&each));
                }
            }
            let mut none = Slopes::default();
            assert!(none.of_square(&plane, Point::new(30.4, 21.6), half));
            for outside in [Point::new(half as f64, 25.0), Point::new(30.0, 49.5 - half as f64)] {
                assert!(!none.of_square(&plane, outside, half));
            }
        }
    }

    #[test]
    fn products_are_those_of_the_samples_that_count() {
        let plane = GrayPlane::from_fn(Frame::new(60, 50), |x, y| texture(x as f64, y as f64));
        let samples: SampledOffsets = offsets(HALF).collect();
        let counts: Vec<bool> = (0..samples.len()).map(|k| k % 3 != 0).collect();
        let point = Point::new(30.2, 21.4);
        let equations = Equations::new(&plane, point, &samples, &counts, &Alignment::LENIENT).unwrap();
        assert_eq!(equations.used, counts.iter().filter(|counts| **counts).count());
        let columns: Vec<Vector8> =
            (0..samples.len()).map(|k| Vector8::from_fn(|i, _| equations.columns[i][k])).collect();
        let mut expected: Matrix8 = columns.iter().map(|c| c * c.transpose()).sum();
        for k in 2..6 {
            expected[(k, k)] += equations.penalty;
        }
        let l = equations.cholesky.l();
        assert!((l * l.transpose() - expected).norm() < 1e-9 * expected.norm());
        let values = std::array::from_fn(|k| (k % 7) as f32);
        let right: Vector8 = columns.iter().zip(&values).map(|(c, v)| c * (f64::from(*v) - 2.0)).sum();
        assert!((equations.right(&values, 2.0) - right).norm() < 1e-9 * right.norm());
    }
}
