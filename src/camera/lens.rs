//! Lens distortion: from undistorted to distorted image coordinates and back.
//!
//! Coordinates here are without unit: pixels less the principal point, over the focal length.

use std::f64::consts::PI;

use nalgebra::{Matrix2, Vector2, Vector3};
use serde::{Deserialize, Serialize};

/// Ideal projection of rays before distortion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Projection {
    /// `(X/Z, Y/Z)`; only rays in front of the camera.
    Perspective,
    /// The distance from the principal point is the angle from the optical axis: fisheye lenses.
    Equidistant,
}

/// Factor by which a lens moves a point away from the principal point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Radial {
    /// `(1 + n1 r² + n2 r⁴ + n3 r⁶ + n4 r⁸) / (1 + d1 r² + d2 r⁴ + d3 r⁶)` of the undistorted radius.
    Polynomial { numerator: [f64; 4], denominator: [f64; 3] },
    /// Field-of-view model: the distorted radius is `atan(2 r tan(ω/2)) / ω` (Devernay & Faugeras 2001).
    FieldOfView { omega: f64 },
    /// Division model: the undistorted radius is `r / (1 + λ r²)` of the distorted radius `r`
    /// (Fitzgibbon 2001).
    Division { lambda: f64 },
}

/// A lens: ideal projection and distortion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Lens {
    /// Ideal projection.
    pub projection: Projection,
    /// Radial distortion.
    pub radial: Radial,
    /// Tangential distortion `p1, p2`.
    pub tangential: [f64; 2],
    /// Thin prism `s1 … s4`: `s1 r² + s2 r⁴` is added to x, `s3 r² + s4 r⁴` to y.
    pub prism: [f64; 4],
}

/// Steps of the search for the radius at which a lens folds back.
const FOLD_STEPS: u32 = 2000;
/// Largest angle from the optical axis of a perspective projection, radians: 89.9°.
const WIDEST_PERSPECTIVE: f64 = 0.999 * 0.5 * PI;
/// Angle ω and coefficient λ below which a model has no distortion in `f64`.
const NEGLIGIBLE: f64 = 1e-9;

impl Lens {
    /// A lens without distortion.
    pub const IDEAL: Self = Self::perspective(Radial::NONE);

    /// Creates a lens of perspective projection with radial distortion only.
    pub const fn perspective(radial: Radial) -> Self {
        Self { projection: Projection::Perspective, radial, tangential: [0.0; 2], prism: [0.0; 4] }
    }

    /// Returns whether the lens images straight lines as straight lines.
    pub fn is_ideal(&self) -> bool {
        *self == Self::IDEAL
    }

    /// Returns the undistorted coordinates of a ray; `None` behind a perspective camera.
    pub(super) fn flat(&self, ray: &Vector3<f64>) -> Option<Vector2<f64>> {
        let across = ray.xy();
        match self.projection {
            Projection::Perspective => (ray.z > 0.0).then(|| across / ray.z),
            Projection::Equidistant => {
                let r = across.norm();
                let angle = r.atan2(ray.z);
                if r > 0.0 { Some(across * (angle / r)) } else { (ray.z > 0.0).then(Vector2::zeros) }
            }
        }
    }

    /// Returns the unit ray of undistorted coordinates.
    pub(super) fn ray(&self, flat: &Vector2<f64>) -> Vector3<f64> {
        match self.projection {
            Projection::Perspective => Vector3::new(flat.x, flat.y, 1.0).normalize(),
            Projection::Equidistant => {
                let angle = flat.norm();
                let across = if angle > 0.0 { flat * (angle.sin() / angle) } else { Vector2::zeros() };
                Vector3::new(across.x, across.y, angle.cos())
            }
        }
    }

    /// Returns the radius up to which the distorted radius grows with the undistorted one. Beyond
    /// it the lens folds back.
    pub(super) fn fold(&self) -> f64 {
        let widest = match self.projection {
            Projection::Perspective => WIDEST_PERSPECTIVE,
            Projection::Equidistant => PI,
        };
        let radius = |angle: f64| match self.projection {
            Projection::Perspective => angle.tan(),
            Projection::Equidistant => angle,
        };
        let grows = |angle: f64| {
            let r = radius(angle);
            let (factor, slope) = self.radial.factor(r * r);
            factor > 0.0 && factor + 2.0 * r * r * slope > 0.0
        };
        let angle = |step: u32| widest * f64::from(step) / f64::from(FOLD_STEPS);
        let Some(step) = (1..=FOLD_STEPS).find(|step| !grows(angle(*step))) else { return radius(widest) };
        let [mut below, mut above] = [angle(step - 1), angle(step)];
        for _ in 0..50 {
            let middle = 0.5 * (below + above);
            if grows(middle) { below = middle } else { above = middle }
        }
        radius(below)
    }

    /// Returns the distorted coordinates of undistorted ones, and their derivatives.
    pub(super) fn distorted(&self, flat: &Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let (x, y) = (flat.x, flat.y);
        let s = x * x + y * y;
        let (factor, slope) = self.radial.factor(s);
        let [p1, p2] = self.tangential;
        let [s1, s2, s3, s4] = self.prism;
        let distorted = Vector2::new(
            x * factor + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x) + s1 * s + s2 * s * s,
            y * factor + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y + s3 * s + s4 * s * s,
        );
        let cross = 2.0 * x * y * slope + 2.0 * (p1 * x + p2 * y);
        let [prism_x, prism_y] = [2.0 * (s1 + 2.0 * s2 * s), 2.0 * (s3 + 2.0 * s4 * s)];
        let derivatives = Matrix2::new(
            factor + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x + x * prism_x,
            cross + y * prism_x,
            cross + x * prism_y,
            factor + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x + y * prism_y,
        );
        (distorted, derivatives)
    }

    /// Returns the undistorted coordinates of distorted ones, up to the radius `fold`. `None` where
    /// the lens has no inverse.
    pub(super) fn undistorted(&self, distorted: &Vector2<f64>, fold: f64) -> Option<Vector2<f64>> {
        let goal = distorted.norm();
        if goal == 0.0 && self.tangential.iter().chain(&self.prism).all(|p| *p == 0.0) {
            return Some(Vector2::zeros());
        }
        let radius = self.radial.inverse(goal, fold);
        // Tangential distortion may leave a point just outside the range of the radial part.
        let mut flat = if goal > 0.0 { distorted * (radius / goal) } else { Vector2::zeros() };
        for _ in 0..30 {
            let (found, derivatives) = self.distorted(&flat);
            let step = derivatives.try_inverse()? * (distorted - found);
            flat += step;
            if !flat.iter().all(|v| v.is_finite()) {
                return None;
            }
            if step.norm() <= 1e-14 * (1.0 + flat.norm()) {
                break;
            }
        }
        let (found, derivatives) = self.distorted(&flat);
        let is_inverse = (found - distorted).norm() <= 1e-10 * (1.0 + goal);
        (is_inverse && flat.norm() <= fold && derivatives.determinant() > 0.0).then_some(flat)
    }
}

impl Radial {
    /// No radial distortion.
    pub const NONE: Self = Self::Polynomial { numerator: [0.0; 4], denominator: [0.0; 3] };

    /// Creates the radial part `1 + k1 r² + k2 r⁴ + …` of up to four coefficients.
    pub fn polynomial(coefficients: &[f64]) -> Self {
        let numerator = std::array::from_fn(|k| coefficients.get(k).copied().unwrap_or(0.0));
        Self::Polynomial { numerator, denominator: [0.0; 3] }
    }

    /// Returns the factor at a squared undistorted radius, and its derivative by the squared radius.
    fn factor(&self, s: f64) -> (f64, f64) {
        match *self {
            Self::Polynomial { numerator: [a, b, c, d], denominator: [e, f, g] } => {
                let above = 1.0 + s * (a + s * (b + s * (c + s * d)));
                let below = 1.0 + s * (e + s * (f + s * g));
                let above_slope = a + s * (2.0 * b + s * (3.0 * c + s * 4.0 * d));
                let below_slope = e + s * (2.0 * f + s * 3.0 * g);
                if below <= 0.0 {
                    return (f64::NAN, f64::NAN);
                }
                let factor = above / below;
                (factor, (above_slope - factor * below_slope) / below)
            }
            Self::FieldOfView { omega } if omega.abs() < NEGLIGIBLE => (1.0, 0.0),
            Self::FieldOfView { omega } => {
                let c = 2.0 * (0.5 * omega).tan();
                let r = s.sqrt();
                if c * r < 1e-4 {
                    return (c / omega * (1.0 - c * c * s / 3.0), -c.powi(3) / (3.0 * omega));
                }
                let factor = (c * r).atan() / (omega * r);
                (factor, (c / (omega * (1.0 + c * c * s)) - factor) / (2.0 * s))
            }
            Self::Division { lambda } => {
                let root = (1.0 - 4.0 * lambda * s).sqrt();
                (2.0 / (1.0 + root), 4.0 * lambda / (root * (1.0 + root) * (1.0 + root)))
            }
        }
    }

    /// Returns the undistorted radius of a distorted one, at most `fold`: Newton's method, kept
    /// between bounds.
    fn inverse(&self, goal: f64, fold: f64) -> f64 {
        let value = |r: f64| r * self.factor(r * r).0;
        if value(fold) <= goal {
            return fold;
        }
        let [mut below, mut above] = [0.0, fold];
        let mut r = goal.min(fold);
        for _ in 0..100 {
            let (factor, slope) = self.factor(r * r);
            let off = r * factor - goal;
            if off > 0.0 {
                above = r;
            } else {
                below = r;
            }
            let next = r - off / (factor + 2.0 * r * r * slope);
            let next = if next > below && next < above { next } else { 0.5 * (below + above) };
            if (next - r).abs() <= 1e-15 * (1.0 + r) {
                return next;
            }
            r = next;
        }
        r
    }
}
