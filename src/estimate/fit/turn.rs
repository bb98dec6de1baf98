//! A camera that only turned: `x2 = K2 R K1⁻¹ x1` with a rotation `R`. The calibration may be wrong by a factor of both
//! focal lengths, a further one of the second, and a radial distortion. The fit is a Gauss–Newton iteration of a Cauchy
//! cost, whose width shrinks.

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};

use crate::geometry::{Point, PointPair, Vector, finite_point};

/// First width of the robust cost, as a share of the longer side, and the ratio of successive widths. A wrong focal
/// length moves points by some tenths of the side.
const WIDEST: f64 = 0.1;
const NARROWING: f64 = 0.7;
/// Change for numerical derivatives, radians or shares.
const DIFFERENCE: f64 = 1e-6;
/// Largest number of matches that a turn is fitted to, evenly chosen.
const FITTED_TO: usize = 400;
/// Share of the curvature that is added to all parameters.
const RIDGE: f64 = 1e-9;
/// Largest change of a parameter in one step, radians or shares.
const LARGEST_STEP: f64 = 0.2;
/// Number of parameters of a turn.
const PARAMETERS: usize = 6;

type Step = SVector<f64, PARAMETERS>;

/// A camera that only turned, and whose calibration may be wrong.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct Turn {
    calibrations: [Matrix3<f64>; 2],
    inverse: Matrix3<f64>,
    rotation: Rotation3<f64>,
    /// Natural logarithm of the true focal lengths over those of the calibrations.
    focal: f64,
    /// Natural logarithm of a further factor of the second focal length.
    zoom: f64,
    /// Coefficient of the division model in units of the true focal length: `n = u / (1 + bend |u|²)`.
    bend: f64,
}

impl Turn {
    /// Largest distance from the turn at which a match has a say in it, as a share of the longer side.
    pub const REACH: f64 = WIDEST;

    /// Fits a turn to most of the matches. `side` is the longer side of image 1 and `tolerance` the largest error of a
    /// right match, px. `None` if the fit fails.
    pub fn fit(
        calibrations: &[Matrix3<f64>; 2],
        matches: &[PointPair],
        side: f64,
        tolerance: f64,
    ) -> Option<Self> {
        let step_by = matches.len().div_ceil(FITTED_TO).max(1);
        let mut turn = Self::of(calibrations, matches)?;
        let mut width = WIDEST * side;
        while width > 0.5 * tolerance {
            let steps: [Self; PARAMETERS] = std::array::from_fn(|k| {
                let mut step = Step::zeros();
                step[k] = DIFFERENCE;
                turn.moved(&step)
            });
            let (mut normal, mut right) = (SMatrix::<f64, PARAMETERS, PARAMETERS>::zeros(), Step::zeros());
            for m in matches.iter().step_by(step_by) {
                let Some(residual) = turn.off(m) else { continue };
                let by =
                    steps.each_ref().map(|turn| turn.off(m).map(|other| (other - residual) / DIFFERENCE));
                if by.iter().any(Option::is_none) {
                    continue;
                }
                let weight = 1.0 / (1.0 + residual.norm_squared() / (width * width));
                for axis in 0..2 {
                    let row = Step::from_iterator(by.iter().flatten().map(|by| by[axis]));
                    normal += row * row.transpose() * weight;
                    right -= row * residual[axis] * weight;
                }
            }
            // In a narrow field of view, focal length and distortion are hardly determined.
            normal += SMatrix::identity() * (RIDGE * normal.trace());
            let step = normal.cholesky()?.solve(&right);
            turn = turn.moved(&(step * (LARGEST_STEP / step.amax()).min(1.0)));
            width *= NARROWING;
        }
        Some(turn)
    }

    /// Returns the turn between the rays of the matches.
    fn of(calibrations: &[Matrix3<f64>; 2], matches: &[PointPair]) -> Option<Self> {
        let rotation = mean_turn(calibrations, matches)?;
        let inverse = calibrations[0].try_inverse()?;
        Some(Self { calibrations: *calibrations, inverse, rotation, focal: 0.0, zoom: 0.0, bend: 0.0 })
    }

    fn moved(&self, step: &Step) -> Self {
        let turn = Rotation3::new(Vector3::new(step[0], step[1], step[2]));
        Self {
            rotation: turn * self.rotation,
            focal: self.focal + step[3],
            zoom: self.zoom + step[4],
            bend: self.bend + step[5],
            ..*self
        }
    }

    /// Returns the place of a point of image 1 in image 2. `None` for a point behind the turned camera, or beyond the
    /// range of the distortion.
    fn place(&self, point1: Point) -> Option<Point> {
        let seen1 = finite_point(&(self.inverse * point1.to_homogeneous()))?.coords / self.focal.exp();
        let stretch = 1.0 + self.bend * seen1.norm_squared();
        let ray2 = self.rotation * Vector3::new(seen1.x, seen1.y, stretch);
        if stretch <= 0.0 || ray2.z <= 0.0 {
            return None;
        }
        let straight = ray2.xy() / ray2.z;
        let root = 1.0 - 4.0 * self.bend * straight.norm_squared();
        let seen2 = (root >= 0.0).then(|| straight * 2.0 / (1.0 + root.sqrt()))?;
        let seen2 = seen2 * (self.focal + self.zoom).exp();
        finite_point(&(self.calibrations[1] * Vector3::new(seen2.x, seen2.y, 1.0)))
    }

    /// Returns how far the second point of a match is from its place.
    pub fn off(&self, m: &PointPair) -> Option<Vector> {
        Some(m.point2 - self.place(m.point1)?)
    }
}

/// Returns the rotation between the rays of the matches, in the least-squares sense.
fn mean_turn(calibrations: &[Matrix3<f64>; 2], matches: &[PointPair]) -> Option<Rotation3<f64>> {
    let [to1, to2] = [calibrations[0].try_inverse()?, calibrations[1].try_inverse()?];
    let sum = matches.iter().fold(Matrix3::zeros(), |sum: Matrix3<f64>, m| {
        let a = (to1 * m.point1.to_homogeneous()).normalize();
        let b = (to2 * m.point2.to_homogeneous()).normalize();
        sum + b * a.transpose()
    });
    let svd = sum.try_svd(true, true, f64::EPSILON, 200)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let sign = (u * v_t).determinant().signum();
    let proper = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    Some(Rotation3::from_matrix_unchecked(proper))
}
