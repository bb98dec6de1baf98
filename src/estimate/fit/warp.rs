//! Smooth warp of one image to the other: `x2 = H(x1) + p(x1) + r(x1)`, with a homography `H`, polynomials `p`, and
//! cubic splines `r` of the row (a rolling shutter). It is fitted by reweighted least squares of a Cauchy cost, whose
//! width shrinks.

use nalgebra::{DMatrix, DVector, Matrix3};

use crate::geometry::{Frame, Point, PointPair, Vector, finite_point};

/// Degree of the polynomials. Degree 4 follows a strong lens to a tenth of a pixel.
const DEGREE: i32 = 4;
/// Number of knots of the cubic splines of the row inside the picture: a rolling shutter that swings up
/// to three times. Piecewise linear functions of as many knots leave a third of such a swing, which
/// looked like parallax on 7 of 24 results; splines leave it on 1 of 24.
const KNOTS: i32 = 10;
/// Largest number of knots of the finer warp: five to a swing of a shutter that swings 3.5 times. Each coefficient takes
/// two matches.
const FINER_KNOTS: i32 = 18;
/// Degree in `x` of the part that differs from row to row: each row is shifted, stretched and bent
/// by the perspective of a turn.
const ACROSS_ROW: i32 = 2;
/// First width of the robust cost, as a share of the longer side: a homography beside a strong lens
/// is off by about as much.
const WIDEST: f64 = 0.01;
/// Ratio of the widths of successive fits.
const NARROWING: f64 = 0.8;
/// Largest number of matches that a warp is fitted to: twenty for each coefficient, or thirteen of the finer one.
const FITTED: usize = 1000;
/// Pull towards the homography, in matches. It determines terms that the matches leave open.
const PULL: f64 = 1e-3;

/// How closely a warp follows the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate) enum Follows {
    Rows,
    RowsClosely,
}

/// A smooth warp fitted to matches.
pub(in crate::estimate) struct Warp {
    homography: Matrix3<f64>,
    middle: Point,
    half: f64,
    half_height: f64,
    /// Number of knots of the splines of the row inside the picture.
    knots: i32,
    coefficients: [DVector<f64>; 2],
}

impl Warp {
    /// Number of the coefficients of each coordinate.
    pub const COEFFICIENTS: usize =
        ((DEGREE + 1) * (DEGREE + 2) / 2 + (KNOTS + 2) * (ACROSS_ROW + 1)) as usize;

    /// Fits a warp to most of the matches, starting at the homography `h` of pixels. `tolerance` is
    /// the error of a match that follows the warp, px. `None` if the fit fails.
    pub fn fit(
        matches: &[PointPair],
        h: &Matrix3<f64>,
        frame: Frame,
        tolerance: f64,
        follows: Follows,
    ) -> Option<Self> {
        let knots = match follows {
            Follows::Rows => KNOTS,
            Follows::RowsClosely => {
                let of_rows = (matches.len() / 2) as i32 - (DEGREE + 1) * (DEGREE + 2) / 2;
                (of_rows / (ACROSS_ROW + 1) - 2).clamp(KNOTS, FINER_KNOTS)
            }
        };
        let side = frame.longer_side();
        let mut warp = Self {
            homography: *h,
            middle: frame.centre(),
            half: 0.5 * side,
            half_height: 0.5 * frame.height as f64,
            knots,
            coefficients: [DVector::zeros(0), DVector::zeros(0)],
        };
        let step = matches.len().div_ceil(FITTED).max(1);
        let rows: Vec<(DVector<f64>, Vector)> = matches
            .iter()
            .step_by(step)
            .map(|m| {
                let mapped = finite_point(&(h * m.point1.to_homogeneous()))?;
                Some((warp.terms(m.point1), m.point2 - mapped))
            })
            .collect::<Option<_>>()?;
        let terms = rows.first()?.0.len();
        warp.coefficients = [DVector::zeros(terms), DVector::zeros(terms)];
        let mut width = WIDEST * side;
        while width > 0.5 * tolerance {
            let mut normal = DMatrix::identity(terms, terms) * PULL;
            let mut right = [DVector::zeros(terms), DVector::zeros(terms)];
            for (terms, shift) in &rows {
                let off = shift - warp.shift(terms);
                let weight = 1.0 / (1.0 + off.norm_squared() / (width * width));
                normal.syger(weight, terms, terms, 1.0);
                right[0].axpy(weight * shift.x, terms, 1.0);
                right[1].axpy(weight * shift.y, terms, 1.0);
            }
            let cholesky = normal.cholesky()?;
            warp.coefficients = right.map(|right| cholesky.solve(&right));
            width *= NARROWING;
        }
        Some(warp)
    }

    /// Returns the displacement of the point of image 2 from its place on the warp, px.
    pub fn beside(&self, m: &PointPair) -> Option<Vector> {
        let mapped = finite_point(&(self.homography * m.point1.to_homogeneous()))?;
        Some(m.point2 - mapped - self.shift(&self.terms(m.point1)))
    }

    fn shift(&self, terms: &DVector<f64>) -> Vector {
        Vector::new(self.coefficients[0].dot(terms), self.coefficients[1].dot(terms))
    }

    /// Returns the products of powers of both coordinates, and the functions of the row.
    fn terms(&self, point1: Point) -> DVector<f64> {
        let offset = point1 - self.middle;
        let at = offset / self.half;
        let powers = (0..=DEGREE).flat_map(|degree| (0..=degree).map(move |i| (i, degree - i)));
        let smooth = powers.map(|(i, j)| at.x.powi(i) * at.y.powi(j));
        let row = (offset.y / self.half_height + 1.0) * 0.5 * f64::from(self.knots - 1);
        let of_knot = move |knot: i32| cubic_spline(row - f64::from(knot));
        // A spline of a knot just outside reaches into the picture.
        let by_row = (-1..=self.knots).flat_map(|k| (0..=ACROSS_ROW).map(move |i| of_knot(k) * at.x.powi(i)));
        DVector::from_vec(smooth.chain(by_row).collect())
    }
}

/// Returns the cubic B-spline of unit knots at a distance from its centre.
fn cubic_spline(distance: f64) -> f64 {
    match distance.abs() {
        near if near < 1.0 => 2.0 / 3.0 - near * near + 0.5 * near.powi(3),
        far if far < 2.0 => (2.0 - far).powi(3) / 6.0,
        _ => 0.0,
    }
}
