//! How well `F` is determined: bands of epipolar lines and ellipses of epipoles, from the covariance of the fit
//! (Hartley & Zisserman, §11.6 and chapter 5).
//!
//! To first order. The covariance holds what the matches leave open, not what a wrong geometry does: it is
//! small for a wrong result that many matches happen to support. The verdict looks at both.

use nalgebra::{Matrix2, Matrix3, SVector, Vector2};

use crate::geometry::{FundamentalMatrix, Matrix9, Point, PointPair, finite_point, rescaled};

/// Covariance of a fundamental matrix, with the level it was estimated at.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    fundamental: FundamentalMatrix,
    covariance: Matrix9,
    scales: [f64; 2],
}

/// One standard deviation of an epipole, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpipoleEllipse {
    /// Where the epipole is, px.
    pub centre: Point,
    /// Half axes, px, the longer one first.
    pub half_axes: [f64; 2],
    /// Direction of the longer axis, radians from the x axis.
    pub angle: f64,
}

impl Uncertainty {
    /// `covariance` is that of the nine entries of `fundamental`, row by row, in images resized by `scales`.
    pub(crate) fn new(fundamental: &FundamentalMatrix, covariance: &Matrix9, scales: [f64; 2]) -> Self {
        Self { fundamental: *fundamental, covariance: *covariance, scales }
    }

    /// Standard deviation, px, of the epipolar line of `point1` in image 2 across itself, where it passes
    /// nearest to `point2`. `None` at the epipole, where there is no line.
    pub fn line2_deviation(&self, point1: Point, point2: Point) -> Option<f64> {
        let (x1, x2) = (self.level(point1, 0), self.level(point2, 1));
        let on_line = self.fundamental.line2_from_point1(x1)?.foot(x2);
        let normal = (self.fundamental.matrix() * x1.to_homogeneous()).xy().norm();
        Some(self.deviation(x1, on_line, normal) / self.scales[1])
    }

    /// The same for the epipolar line of `point2` in image 1, where it passes nearest to `point1`.
    pub fn line1_deviation(&self, point2: Point, point1: Point) -> Option<f64> {
        let (x1, x2) = (self.level(point1, 0), self.level(point2, 1));
        let on_line = self.fundamental.line1_from_point2(x2)?.foot(x1);
        let normal = self.fundamental.matrix().tr_mul(&x2.to_homogeneous()).xy().norm();
        Some(self.deviation(on_line, x2, normal) / self.scales[0])
    }

    /// One standard deviation of the epipole in image 1; `None` when it is at infinity.
    pub fn epipole1(&self) -> Option<EpipoleEllipse> {
        self.epipole(false)
    }

    /// One standard deviation of the epipole in image 2; `None` when it is at infinity.
    pub fn epipole2(&self) -> Option<EpipoleEllipse> {
        self.epipole(true)
    }

    /// Median over matches of the deviation of their lines in image 2, px; `None` without matches.
    pub fn median_line2_deviation(&self, matches: &[PointPair]) -> Option<f64> {
        let mut deviations: Vec<f64> =
            matches.iter().filter_map(|m| self.line2_deviation(m.point1, m.point2)).collect();
        deviations.sort_by(f64::total_cmp);
        deviations.get(deviations.len() / 2).copied()
    }

    fn level(&self, p: Point, image: usize) -> Point {
        rescaled(p, self.scales[image])
    }

    /// Deviation of `x2ᵀ F x1 / normal`.
    fn deviation(&self, x1: Point, x2: Point, normal: f64) -> f64 {
        let (a, b) = (x1.to_homogeneous(), x2.to_homogeneous());
        let row = SVector::<f64, 9>::from_fn(|k, _| b[k / 3] * a[k % 3]);
        row.dot(&(self.covariance * row)).max(0.0).sqrt() / normal
    }

    fn epipole(&self, second: bool) -> Option<EpipoleEllipse> {
        let f = if second { self.fundamental.matrix().transpose() } else { *self.fundamental.matrix() };
        let e = if second { self.fundamental.epipole2() } else { self.fundamental.epipole1() };
        let scale = self.scales[usize::from(second)];
        let position = finite_point(&e)?;
        // F e = 0 ⇒ F de = −dF e, solved in the plane across e, then the derivative of (x/z, y/z).
        let inverse = f.pseudo_inverse(1e-14 * f.norm()).ok()?;
        let mut covariance = Matrix2::zeros();
        let eigen = self.covariance.symmetric_eigen();
        for k in 0..9 {
            let deviation = eigen.eigenvalues[k].max(0.0).sqrt();
            let entries = eigen.eigenvectors.column(k) * deviation;
            let change =
                Matrix3::from_fn(|r, c| if second { entries[3 * c + r] } else { entries[3 * r + c] });
            let de = -inverse * (change * e);
            let moved = Vector2::new((de.x - position.x * de.z) / e.z, (de.y - position.y * de.z) / e.z);
            covariance += moved * moved.transpose();
        }
        let axes = covariance.symmetric_eigen();
        let long = axes.eigenvalues.imax();
        let direction = axes.eigenvectors.column(long);
        let half = |k: usize| axes.eigenvalues[k].max(0.0).sqrt() / scale;
        let ellipse = EpipoleEllipse {
            centre: rescaled(position, 1.0 / scale),
            half_axes: [half(long), half(1 - long)],
            angle: direction.y.atan2(direction.x),
        };
        ellipse.half_axes.iter().all(|v| v.is_finite()).then_some(ellipse)
    }
}
