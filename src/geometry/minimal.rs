//! Fundamental matrices from minimal samples, fast enough for tens of thousands.
//!
//! A point pair gives one linear equation in the nine entries, `x2ᵀ F x1 = 0`. A match of covariant
//! features gives a second one (after Barath & Kukelova 2022). A step `v1` along the orientation of
//! the feature in image 1 is a step `v2` in image 2, turned and scaled as the two features are. There
//! the epipolar constraint holds to first order:
//!
//! ```text
//!     v2ᵀ (F x1) + v1ᵀ (Fᵀ x2) = 0 .
//! ```
//!
//! Seven equations leave a pencil of matrices. Those of rank 2 are the solutions.
//! [`crate::geometry::seven_point`] solves the same for seven points with singular values and
//! eigenvalues: it conditions the points, keeps double roots and says why points fail. Elimination and
//! the closed form of the roots take a fraction of the time. They suffice here, because a sample that
//! fails is drawn again.

use nalgebra::Matrix3;

use super::{Eliminated, determinant_on_pencil};

/// Coefficients of one equation in the entries of F, row by row.
pub(crate) type Equation = [f64; 9];

/// Largest determinant, for matrices of norm 1, that is rounding. The whole pencil then has rank 2.
const SMALLEST_DETERMINANT: f64 = 1e-15;
/// Largest pivot, for equations in conditioned coordinates, that is rounding. The equations then
/// depend on each other.
const SMALLEST_PIVOT: f64 = 1e-9;

/// Returns the equation `x2ᵀ F x1 = 0` for conditioned coordinates `x1 y1 x2 y2`.
pub(crate) fn point_equation([x1, y1, x2, y2]: [f64; 4]) -> Equation {
    [x2 * x1, x2 * y1, x2, y2 * x1, y2 * y1, y2, x1, y1, 1.0]
}

/// Returns the derivative of the epipolar constraint along `v1` in image 1 and `v2` in image 2.
pub(crate) fn frame_equation([x1, y1, x2, y2]: [f64; 4], v1: [f64; 2], v2: [f64; 2]) -> Equation {
    let ([u1, w1], [u2, w2]) = (v1, v2);
    [u2 * x1 + x2 * u1, u2 * y1 + x2 * w1, u2, w2 * x1 + y2 * u1, w2 * y1 + y2 * w1, w2, u1, w1, 0.0]
}

/// Returns all matrices of rank 2 that satisfy seven equations, none if the equations are dependent.
pub(crate) fn solve_seven(equations: &[Equation; 7]) -> Vec<Matrix3<f64>> {
    let Some([f, g]) = null_space(equations) else { return Vec::new() };
    // The end of the pencil with the larger determinant leads the cubic.
    let (cubic, constant) = (f.determinant(), g.determinant());
    let (f, g, cubic) = if cubic.abs() >= constant.abs() { (f, g, cubic) } else { (g, f, constant) };
    if cubic.abs() < SMALLEST_DETERMINANT {
        return Vec::new();
    }
    real_roots(determinant_on_pencil(&f, &g).map(|c| c / cubic))
        .into_iter()
        .map(|mu| f * mu + g)
        .map(|m| m / m.norm())
        .collect()
}

/// Returns two orthonormal matrices that satisfy all seven equations.
fn null_space(equations: &[Equation; 7]) -> Option<[Matrix3<f64>; 2]> {
    let [first, second] = Eliminated::new(*equations, SMALLEST_PIVOT)?.solutions();
    let first = first.normalize();
    let second = (second - first * first.dot(&second)).normalize();
    Some([first, second].map(|v| Matrix3::from_fn(|r, c| v[3 * r + c])))
}

/// Returns the real roots of `μ³ + c2 μ² + c1 μ + c0`, in closed form, each improved by a step of
/// Newton's method.
fn real_roots([c0, c1, c2]: [f64; 3]) -> Vec<f64> {
    let shift = c2 / 3.0;
    let p = c1 / 3.0 - shift * shift;
    let q = shift * (shift * shift - 0.5 * c1) + 0.5 * c0;
    let discriminant = q * q + p * p * p;
    let roots = if discriminant > 0.0 {
        // One root. Of the two cube roots, the one without cancellation is computed.
        let u = -q.signum() * (q.abs() + discriminant.sqrt()).cbrt();
        vec![if u == 0.0 { 0.0 } else { u - p / u }]
    } else {
        let radius = 2.0 * (-p).max(0.0).sqrt();
        let cosine = if p == 0.0 { 1.0 } else { (-q / (-p).powf(1.5)).clamp(-1.0, 1.0) };
        let third = cosine.acos() / 3.0;
        (0..3).map(|k| radius * (third - f64::from(k) * std::f64::consts::TAU / 3.0).cos()).collect()
    };
    roots
        .into_iter()
        .map(|root| {
            let mu = root - shift;
            let value = ((mu + c2) * mu + c1) * mu + c0;
            let slope = (3.0 * mu + 2.0 * c2) * mu + c1;
            let step = value / slope;
            if step.is_finite() && step.abs() < 1e-3 * (1.0 + mu.abs()) { mu - step } else { mu }
        })
        .filter(|mu| mu.is_finite())
        .collect()
}
