//! Sub-pixel alignment of a patch under an affine map, gain and offset, and how well it then fits.
//!
//! Least squares over shift, affine map, gain and offset (Lucas & Kanade 1981; Baker & Matthews 2004, forward
//! additive):
//!
//! ```text
//!     gain·I1(p + x) + offset = I2(q + A x)        x in a square around 0
//! ```
//!
//! The affine map is held back by a penalty, because weakly textured patches do not determine it. Samples that
//! fall outside either image do not count, so patches at borders work with what is there.

use nalgebra::{Matrix2, SMatrix, SVector};

use crate::geometry::{Point, Vector};
use crate::image::GrayPlane;

/// Half width of an aligned patch, px of the clicked image.
const HALF: i32 = 5;
const ITERATIONS: usize = 8;
/// Grey levels are counted from here, which conditions the equations.
const MIDDLE: f64 = 128.0;
/// Largest way from the start, px.
const LARGEST_MOVE: f64 = 2.5;
/// Share of the samples that must lie inside both images: in the corner of an image little more than a quarter
/// is.
const LEAST_INSIDE: f64 = 0.25;
/// Weight of the penalty on changes of the affine map against the image gradients.
const STIFFNESS: f64 = 0.1;

/// Where a patch of the clicked image lies in the other one: `q + A x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    pub at: Point,
    pub affine: Matrix2<f64>,
}

/// A patch in the clicked plane and a plane to find it in.
#[derive(Clone, Copy)]
pub(super) struct Aligner<'a> {
    pub from: &'a GrayPlane,
    pub to: &'a GrayPlane,
    pub at: Point,
}

type Vector8 = SVector<f64, 8>;
type Matrix8 = SMatrix<f64, 8, 8>;

fn offsets() -> impl Iterator<Item = Vector> {
    (-HALF..=HALF).flat_map(|y| (-HALF..=HALF).map(move |x| Vector::new(f64::from(x), f64::from(y))))
}

fn count() -> f64 {
    f64::from((2 * HALF + 1).pow(2))
}

impl Aligner<'_> {
    /// The best placement near `start`; `None` when it runs away or too little of the patch is inside.
    pub fn align(&self, start: Placement) -> Option<Placement> {
        let mut placed = start;
        let patch: Vec<(Vector, f64)> = offsets()
            .filter(|x| self.from.frame().contains(self.at + x))
            .map(|x| (x, f64::from(self.from.sample(self.at + x)) - MIDDLE))
            .collect();
        for _ in 0..ITERATIONS {
            let (mut normal, mut right, mut inside) = (Matrix8::zeros(), Vector8::zeros(), 0.0);
            for (x, reference) in &patch {
                let q = placed.at + placed.affine * x;
                if !self.to.frame().contains(q) {
                    continue;
                }
                inside += 1.0;
                let value = |dx: f64, dy: f64| f64::from(self.to.sample(Point::new(q.x + dx, q.y + dy)));
                let gx = 0.5 * (value(1.0, 0.0) - value(-1.0, 0.0));
                let gy = 0.5 * (value(0.0, 1.0) - value(0.0, -1.0));
                // gain·I1 + offset − ∇I2·(step + dA x) = I2
                let row =
                    Vector8::from([-gx, -gy, -gx * x.x, -gx * x.y, -gy * x.x, -gy * x.y, *reference, 1.0]);
                normal.syger(1.0, &row, &row, 1.0);
                right += row * (value(0.0, 0.0) - MIDDLE);
            }
            if inside < LEAST_INSIDE * count() {
                return None;
            }
            let gradient = normal[(0, 0)] + normal[(1, 1)];
            let penalty = STIFFNESS * gradient * f64::from(HALF * HALF);
            for k in 2..6 {
                // Towards the start, not towards where the last step went.
                let drift = (placed.affine - start.affine)[((k - 2) / 2, (k - 2) % 2)];
                normal[(k, k)] += penalty;
                right[k] -= penalty * drift;
            }
            let solution = normal.cholesky()?.solve(&right);
            let step = Vector::new(solution[0], solution[1]);
            placed.at += step;
            placed.affine += Matrix2::new(solution[2], solution[3], solution[4], solution[5]);
            let far = (placed.at - start.at).norm();
            if !far.is_finite() || far > LARGEST_MOVE {
                return None;
            }
            if step.norm() < 0.02 {
                break;
            }
        }
        Some(placed)
    }

    /// Correlation of the patch with what lies there, −1 to 1; 0 where it is flat or mostly outside.
    pub fn correlation(&self, placed: &Placement) -> f64 {
        let (mut n, mut a, mut b, mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for x in offsets() {
            let (p, q) = (self.at + x, placed.at + placed.affine * x);
            if !self.from.frame().contains(p) || !self.to.frame().contains(q) {
                continue;
            }
            let (u, v) = (f64::from(self.from.sample(p)), f64::from(self.to.sample(q)));
            n += 1.0;
            a += u;
            b += v;
            aa += u * u;
            bb += v * v;
            ab += u * v;
        }
        if n < LEAST_INSIDE * count() {
            return 0.0;
        }
        let variances = [aa - a * a / n, bb - b * b / n];
        let least = f64::from(super::template::LEAST_CONTRAST).powi(2) * n;
        if variances.iter().any(|v| *v < least) {
            return 0.0;
        }
        (ab - a * b / n) / (variances[0] * variances[1]).sqrt()
    }
}
