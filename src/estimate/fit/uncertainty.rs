//! Uncertainty of `F`: bands of epipolar lines and ellipses of epipoles, from the covariance of the fit
//! (Hartley & Zisserman, §11.6 and chapter 5), to first order.
//!
//! The covariance says how far the matches leave `F` open. It does not say whether `F` is right: it is
//! also small for a wrong result that many matches support by accident. The verdict looks at both.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_4};

use nalgebra::{Matrix2, Matrix3, SVector, Vector2, Vector3};
use serde::Serialize;

use crate::geometry::{
    Frame, FundamentalMatrix, Matrix9, Point, PointPair, finite_point, median, rescaled, rescaling,
};

/// Covariance of a fundamental matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    fundamental: FundamentalMatrix,
    covariance: Matrix9,
    scales: [f64; 2],
}

/// One standard deviation of an epipole, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpipoleEllipse {
    /// Position of the epipole, px.
    pub centre: Point,
    /// Half axes, px, the longer one first.
    pub half_axes: [f64; 2],
    /// Direction of the longer axis, radians from the x axis.
    pub angle: f64,
}

/// Position of an epipole, seen from the middle of its image, with 95 % intervals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EpipoleBearing {
    /// Direction, radians from the x axis towards the y axis.
    pub direction: f64,
    /// Half of the interval of the direction, radians.
    pub direction_error: f64,
    /// Distance, px. Infinite for parallel lines.
    pub distance: f64,
    /// Shortest distance of the interval, px.
    pub nearest: f64,
    /// Longest distance of the interval, px. `None` if the epipole may be at infinity.
    pub farthest: Option<f64>,
}

/// Half widths of the 95 % bands of epipolar lines all over the pictures, px.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LineBands {
    /// Median of the lines of a grid of points of both images, each where it passes nearest to the middle of the
    /// other image.
    pub typical: f64,
    /// Exceeded by one line in twenty. Near an epipole, a line turns with any error, so there is no largest one.
    pub worst: f64,
}

impl LineBands {
    /// Returns the expected distance of the right lines from the typical one, px: the mean absolute value of a Gaussian
    /// variable.
    pub(in crate::estimate) fn expected_error(&self) -> f64 {
        self.typical / WITHIN * FRAC_2_PI.sqrt()
    }
}

/// Certainty of an epipole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EpipoleCertainty {
    /// The position is known.
    Position,
    /// The direction is known. The epipole may be at infinity.
    Direction,
    /// Neither is known.
    Open,
}

/// Rows and columns of the grid of points whose lines are looked at.
const GRID: usize = 8;
/// Share of the lines whose bands are not wider than the worst one.
const MOST: f64 = 0.95;
/// Returns the middles of the cells of a grid all over an image.
fn grid(frame: Frame) -> impl Iterator<Item = Point> {
    let at = |k: usize, length: f64| (k as f64 + 0.5) / GRID as f64 * length;
    (0..GRID * GRID).map(move |k| Point::new(at(k % GRID, frame.right()), at(k / GRID, frame.bottom())))
}

/// Largest error of a direction that is known: the epipole is on one side of the image.
const ONE_SIDE: f64 = FRAC_PI_4;
/// Half of the 95 % interval of a Gaussian variable, in standard deviations.
const WITHIN: f64 = 1.96;

impl EpipoleBearing {
    /// Returns the certainty of the epipole.
    pub fn certainty(&self) -> EpipoleCertainty {
        match self.farthest {
            Some(_) => EpipoleCertainty::Position,
            None if self.direction_error < ONE_SIDE => EpipoleCertainty::Direction,
            None => EpipoleCertainty::Open,
        }
    }
}

impl Uncertainty {
    /// Creates the uncertainty of `fundamental` from the covariance of its nine entries, row by
    /// row, in images resized by `scales`.
    pub(crate) fn new(fundamental: &FundamentalMatrix, covariance: &Matrix9, scales: [f64; 2]) -> Self {
        Self { fundamental: *fundamental, covariance: *covariance, scales }
    }

    /// Returns the covariance of the nine entries of `F` at full size with Frobenius norm 1, row by
    /// row.
    pub fn covariance(&self) -> Matrix9 {
        let [from1, from2] = self.scales.map(rescaling);
        let by_entry = |k: usize| {
            let mut entry = Matrix3::zeros();
            entry[(k / 3, k % 3)] = 1.0;
            from2.transpose() * entry * from1
        };
        let f = from2.transpose() * self.fundamental.matrix() * from1;
        let norm = f.norm();
        let unit = f / norm;
        let columns: [Matrix3<f64>; 9] = std::array::from_fn(|k| {
            let moved = by_entry(k) / norm;
            moved - unit * unit.dot(&moved)
        });
        let jacobian = Matrix9::from_fn(|row, k| columns[k][(row / 3, row % 3)]);
        jacobian * self.covariance * jacobian.transpose()
    }

    /// Returns the standard deviation of the epipolar line of `point1` in image 2, px, across the line,
    /// where it passes nearest to `point2`. `None` at the epipole, which has no line.
    pub fn line2_deviation(&self, point1: Point, point2: Point) -> Option<f64> {
        let (x1, x2) = (self.level(point1, 0), self.level(point2, 1));
        let on_line = self.fundamental.line2_from_point1(x1)?.foot(x2);
        let normal = (self.fundamental.matrix() * x1.to_homogeneous()).xy().norm();
        Some(self.deviation(x1, on_line, normal) / self.scales[1])
    }

    /// Returns the standard deviation of the epipolar line of `point2` in image 1, px, where it passes
    /// nearest to `point1`.
    pub fn line1_deviation(&self, point2: Point, point1: Point) -> Option<f64> {
        let (x1, x2) = (self.level(point1, 0), self.level(point2, 1));
        let on_line = self.fundamental.line1_from_point2(x2)?.foot(x1);
        let normal = self.fundamental.matrix().tr_mul(&x2.to_homogeneous()).xy().norm();
        Some(self.deviation(on_line, x2, normal) / self.scales[0])
    }

    /// Returns one standard deviation of the epipole in image 1. `None` at infinity.
    pub fn epipole1(&self) -> Option<EpipoleEllipse> {
        self.epipole(false)
    }

    /// Returns one standard deviation of the epipole in image 2. `None` at infinity.
    pub fn epipole2(&self) -> Option<EpipoleEllipse> {
        self.epipole(true)
    }

    /// Returns the median deviation of the lines of matches in image 2, px. `None` without matches.
    pub fn median_line2_deviation(&self, matches: &[PointPair]) -> Option<f64> {
        let deviations: Vec<f64> =
            matches.iter().filter_map(|m| self.line2_deviation(m.point1, m.point2)).collect();
        (!deviations.is_empty()).then(|| median(deviations))
    }

    /// Returns how precise the lines are all over images of these sizes. Lines that pass beside the other image do not
    /// count. `None` if no line passes through it.
    pub fn line_bands(&self, frames: [Frame; 2]) -> Option<LineBands> {
        let f = self.fundamental.rescaled(self.scales.map(f64::recip))?;
        let middles = frames.map(|frame| frame.centre());
        let in2 = grid(frames[0]).filter_map(|point1| {
            let is_seen = frames[1].contains(f.line2_from_point1(point1)?.foot(middles[1]));
            self.line2_deviation(point1, middles[1]).filter(|_| is_seen)
        });
        let in1 = grid(frames[1]).filter_map(|point2| {
            let is_seen = frames[0].contains(f.line1_from_point2(point2)?.foot(middles[0]));
            self.line1_deviation(point2, middles[0]).filter(|_| is_seen)
        });
        let mut bands: Vec<f64> = in2.chain(in1).map(|deviation| WITHIN * deviation).collect();
        bands.sort_by(f64::total_cmp);
        let at = |share: f64| bands.get((share * bands.len() as f64) as usize).copied();
        at(0.5).zip(at(MOST)).map(|(typical, worst)| LineBands { typical, worst })
    }

    /// Returns the position of the epipole in image 1 or in the `second`, of this size. The epipole is taken as
    /// a point of the unit sphere, with the middle of the image at the pole and infinity at the equator, so both
    /// are ordinary places. `None` if the covariance is not finite.
    pub fn bearing(&self, second: bool, frame: Frame) -> Option<EpipoleBearing> {
        let [from1, from2] = self.scales.map(rescaling);
        let unscaled = from2.transpose() * self.fundamental.matrix() * from1;
        let unscaled = unscaled / unscaled.norm();
        let (half, middle) = (0.5 * frame.longer_side(), frame.centre());
        let to_pixels = Matrix3::new(half, 0.0, middle.x, 0.0, half, middle.y, 0.0, 0.0, 1.0);
        let oriented = |m: Matrix3<f64>| if second { m.transpose() } else { m } * to_pixels;
        let f = oriented(unscaled);
        let svd = f.svd(false, true);
        let e: Vector3<f64> = svd.v_t?.row(svd.singular_values.imin()).transpose();
        let e = if e.z < 0.0 { -e } else { e };
        let from_axis = e.xy().norm_squared().max(f64::MIN_POSITIVE);
        let (mut turn, mut rise) = (0.0, 0.0);
        for de in null_vector_changes(&f, &e, &self.covariance(), oriented)? {
            turn += ((e.x * de.y - e.y * de.x) / from_axis).powi(2);
            rise += de.z * de.z;
        }
        let (turn, rise) = (WITHIN * turn.sqrt(), WITHIN * rise.sqrt());
        // The height of a point of the sphere is the cosine of its angle from the axis.
        let distance = |height: f64| half * height.clamp(0.0, 1.0).acos().tan();
        let bearing = EpipoleBearing {
            direction: e.y.atan2(e.x),
            direction_error: turn,
            distance: if e.z > 0.0 { distance(e.z) } else { f64::INFINITY },
            nearest: distance(e.z + rise),
            farthest: (e.z > rise).then(|| distance(e.z - rise)),
        };
        (turn.is_finite() && rise.is_finite()).then_some(bearing)
    }

    fn level(&self, p: Point, image: usize) -> Point {
        rescaled(p, self.scales[image])
    }

    /// Returns the deviation of `x2ᵀ F x1 / normal`.
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
        let oriented = |m: Matrix3<f64>| if second { m.transpose() } else { m };
        let mut covariance = Matrix2::zeros();
        for de in null_vector_changes(&f, &e, &self.covariance, oriented)? {
            // The derivative of (x/z, y/z).
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

/// Returns the changes of the null vector `e` of `f` by one standard deviation along each axis of the
/// covariance of the entries of `F`. `oriented` makes a change of `f` from one of `F`.
/// `F e = 0 ⇒ F de = −dF e`, solved in the plane across `e`.
fn null_vector_changes(
    f: &Matrix3<f64>,
    e: &Vector3<f64>,
    covariance: &Matrix9,
    oriented: impl Fn(Matrix3<f64>) -> Matrix3<f64>,
) -> Option<[Vector3<f64>; 9]> {
    let inverse = f.pseudo_inverse(1e-14 * f.norm()).ok()?;
    let eigen = covariance.symmetric_eigen();
    Some(std::array::from_fn(|k| {
        let entries = eigen.eigenvectors.column(k) * eigen.eigenvalues[k].max(0.0).sqrt();
        -inverse * (oriented(Matrix3::from_fn(|r, c| entries[3 * r + c])) * e)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME, rows};
    use crate::geometry::random_scene::RandomScene;
    use crate::geometry::{Line, Observation, fit_fundamental};

    /// Entries row by row, as in the covariance.
    fn entries(m: &Matrix3<f64>) -> SVector<f64, 9> {
        SVector::from_fn(|k, _| m[(k / 3, k % 3)])
    }

    /// Covariance along one direction: a shift of camera 2.
    fn along_a_motion() -> (ExactScene, [f64; 3], Matrix9, f64) {
        let (place, step) = ([-0.25, 0.12, 1.2], 1e-5);
        let at = |s: f64| ExactScene::moved([place[0] + s, place[1] - 2.0 * s, place[2]]);
        let change = (at(step).fundamental().matrix() - at(-step).fundamental().matrix()) / 2.0;
        let v = entries(&change);
        (at(0.0), place, v * v.transpose(), step)
    }

    #[test]
    fn the_covariance_at_full_size_gives_the_same_deviations() {
        let (scene, place, covariance, step) = along_a_motion();
        let half = Uncertainty::new(&scene.fundamental(), &covariance, [0.5; 2]);
        let full_size = scene.fundamental().rescaled([2.0; 2]).unwrap();
        let full = Uncertainty::new(&full_size, &half.covariance(), [1.0; 2]);
        for point1 in [Point::new(40.0, 60.0), Point::new(300.0, 200.0)] {
            let [a, b] = [&half, &full].map(|u| u.line2_deviation(point1, point1).unwrap());
            assert!(a > 0.0 && (a / b - 1.0).abs() < 1e-6, "{a} {b} {place:?} {step}");
        }
    }

    #[test]
    fn an_epipole_that_can_move_one_way_has_an_ellipse_that_way() {
        let (scene, place, covariance, step) = along_a_motion();
        let uncertainty = Uncertainty::new(&scene.fundamental(), &covariance, [1.0; 2]);
        let moved = ExactScene::moved([place[0] + step, place[1] - 2.0 * step, place[2]]).fundamental();
        for (ellipse, before, after) in [
            (uncertainty.epipole1(), scene.fundamental().epipole1(), moved.epipole1()),
            (uncertainty.epipole2(), scene.fundamental().epipole2(), moved.epipole2()),
        ] {
            let ellipse = ellipse.unwrap();
            let (before, after) = (finite_point(&before).unwrap(), finite_point(&after).unwrap());
            let motion = after - before;
            assert!((ellipse.centre - before).norm() < 1e-9);
            // First order suffices: the step is a hundred-thousandth of the distances.
            assert!((ellipse.half_axes[0] / motion.norm() - 1.0).abs() < 1e-3, "{ellipse:?} {motion}");
            assert!(ellipse.half_axes[1] < 1e-3 * ellipse.half_axes[0]);
            let along = Vector2::new(ellipse.angle.cos(), ellipse.angle.sin());
            assert!(along.perp(&motion).abs() < 1e-3 * motion.norm());
        }
    }

    #[test]
    fn figures_are_in_full_size_pixels_wherever_the_matrix_was_fitted() {
        let (scene, _, covariance, _) = along_a_motion();
        let f = scene.fundamental();
        let [full, half] = [[1.0; 2], [1.0, 0.5]].map(|scales| Uncertainty::new(&f, &covariance, scales));
        let (ellipse, doubled) = (full.epipole2().unwrap(), half.epipole2().unwrap());
        assert!((doubled.centre - rescaled(ellipse.centre, 2.0)).norm() < 1e-9);
        assert!((doubled.half_axes[0] / ellipse.half_axes[0] - 2.0).abs() < 1e-9);
        assert_eq!(full.epipole1(), half.epipole1(), "image 1 has its own scale");
        let pair = scene.pairs(3)[2];
        let at_half = PointPair { point2: rescaled(pair.point2, 2.0), ..pair };
        let [a, b] = [(full, pair), (half, at_half)]
            .map(|(u, m)| [u.line2_deviation(m.point1, m.point2), u.line1_deviation(m.point2, m.point1)]);
        assert!((b[0].unwrap() / a[0].unwrap() - 2.0).abs() < 1e-9);
        assert!((b[1].unwrap() / a[1].unwrap() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn bearings_agree_with_the_ellipse_at_any_distance() {
        let (scene, _, covariance, _) = along_a_motion();
        let middle = FRAME.centre();
        for growth in [1.0, 1e4, 1e9] {
            let uncertainty = Uncertainty::new(&scene.fundamental(), &(covariance * growth), [1.0; 2]);
            let ellipse = uncertainty.epipole2().unwrap();
            let bearing = uncertainty.bearing(true, FRAME).unwrap();
            let away = ellipse.centre - middle;
            assert!((bearing.distance / away.norm() - 1.0).abs() < 1e-6);
            assert!((bearing.direction - away.y.atan2(away.x)).abs() < 1e-9);
            // A covariance along one direction makes the ellipse a segment.
            let along =
                Vector2::new(ellipse.angle.cos(), ellipse.angle.sin()) * (1.96 * ellipse.half_axes[0]);
            let turn = (along.perp(&away) / away.norm_squared()).abs();
            assert!((bearing.direction_error / turn - 1.0).abs() < 1e-3, "{bearing:?} {turn}");
            if growth < 2.0 {
                let far = bearing.farthest.unwrap();
                let reach = (along.dot(&away) / away.norm()).abs();
                assert!(((far - bearing.nearest) / (2.0 * reach) - 1.0).abs() < 1e-2, "{bearing:?} {reach}");
                assert_eq!(bearing.certainty(), EpipoleCertainty::Position);
            }
        }
        let open = Uncertainty::new(&scene.fundamental(), &(covariance * 1e14), [1.0; 2]);
        assert_eq!(open.bearing(true, FRAME).unwrap().certainty(), EpipoleCertainty::Open);
        // Rows determine the direction, not the distance.
        let rows = Uncertainty::new(&rows(0.0), &(Matrix9::identity() * 1e-8), [1.0; 2]);
        let bearing = rows.bearing(false, FRAME).unwrap();
        assert_eq!((bearing.certainty(), bearing.distance), (EpipoleCertainty::Direction, f64::INFINITY));
        assert!(bearing.direction.sin().abs() < 1e-9 && bearing.nearest > FRAME.longer_side());
    }

    #[test]
    fn epipoles_at_infinity_have_no_ellipse_and_epipoles_no_line() {
        let uncertainty = Uncertainty::new(&rows(0.0), &(Matrix9::identity() * 1e-8), [1.0; 2]);
        assert_eq!((uncertainty.epipole1(), uncertainty.epipole2()), (None, None));
        let (point1, point2) = (Point::new(50.0, 60.0), Point::new(40.0, 60.0));
        assert!(uncertainty.line2_deviation(point1, point2).unwrap() > 0.0);
        let inside = Matrix3::new(0.0, -1.0, 3.0, 1.0, 0.0, -4.0, -3.0, 4.0, 0.0);
        let inside = FundamentalMatrix::from_rank_two(inside).unwrap();
        let uncertainty = Uncertainty::new(&inside, &Matrix9::identity(), [1.0; 2]);
        assert_eq!(uncertainty.line2_deviation(Point::new(4.0, 3.0), point2), None);
        assert_eq!(uncertainty.median_line2_deviation(&[]), None);
    }

    #[test]
    fn lines_are_less_precise_where_no_match_is() {
        // Rows, with an error that turns the lines about the middle of image 2.
        let f = rows(0.0);
        let turn = nalgebra::SVector::<f64, 9>::from_fn(|k, _| if k == 7 { 1e-3 } else { 0.0 });
        let uncertainty = Uncertainty::new(&f, &(turn * turn.transpose()), [1.0; 2]);
        let bands = uncertainty.line_bands([FRAME; 2]).unwrap();
        assert!(bands.typical > 0.0 && bands.worst >= bands.typical, "{bands:?}");
        let four = Uncertainty::new(&f, &(16.0 * turn * turn.transpose()), [1.0; 2]);
        let wider = four.line_bands([FRAME; 2]).unwrap();
        assert!(
            (wider.worst / bands.worst - 4.0).abs() < 1e-9
                && (wider.typical / bands.typical - 4.0).abs() < 1e-9
        );
        let half = [Frame::new(FRAME.width / 2, FRAME.height / 2); 2];
        let near = uncertainty.line_bands(half).unwrap();
        assert!(near.worst <= bands.worst + 1e-9, "{near:?} {bands:?}");
        // All lines pass below the other image.
        assert_eq!(
            Uncertainty::new(&rows(9000.0), &Matrix9::identity(), [1.0; 2]).line_bands([FRAME; 2]),
            None
        );
    }

    #[test]
    fn the_median_is_over_the_matches() {
        let (scene, _, covariance, _) = along_a_motion();
        let uncertainty = Uncertainty::new(&scene.fundamental(), &covariance, [1.0; 2]);
        let pairs = scene.pairs(7);
        let each = pairs.iter().map(|m| uncertainty.line2_deviation(m.point1, m.point2).unwrap());
        let median = uncertainty.median_line2_deviation(&pairs).unwrap();
        let below = each.clone().filter(|deviation| *deviation < median).count();
        assert!(each.clone().any(|deviation| deviation.total_cmp(&median).is_eq()));
        assert_eq!(below, 3);
    }

    /// Matches with noise, fitted repeatedly: the results scatter as each fit predicts.
    #[test]
    fn ellipses_and_line_deviations_are_the_scatter_under_noise() {
        let scene = ExactScene::forward();
        let (f, exact) = (scene.fundamental(), scene.pairs(80));
        let truth = [f.epipole1(), f.epipole2()].map(|e| finite_point(&e).unwrap());
        let probe = scene.seen(-0.5, 0.4, 6.0);
        let (line1, line2) =
            (f.line1_from_point2(probe.point2).unwrap(), f.line2_from_point1(probe.point1).unwrap());
        let [on1, on2] = [line1.foot(probe.point1), line2.foot(probe.point2)];
        let mut noise = RandomScene::new(11);
        let (sigma, runs) = (0.2, 200);
        // Squared errors, measured and predicted: of epipoles along and across, and of lines.
        let (mut seen, mut predicted) = ([[0.0; 2]; 3], [[0.0; 2]; 3]);
        for _ in 0..runs {
            let observed = noise.disturbed(&exact, sigma);
            let observations: Vec<_> = observed.iter().map(|m| Observation { pair: *m, sigma }).collect();
            let fit = fit_fundamental(&f, &observations, 6.0).unwrap();
            let uncertainty = Uncertainty::new(&fit.fundamental, &fit.covariance.unwrap(), [1.0; 2]);
            let ellipses = [uncertainty.epipole1(), uncertainty.epipole2()];
            for (image, ellipse) in ellipses.into_iter().enumerate() {
                let ellipse = ellipse.unwrap();
                let along = Vector2::new(ellipse.angle.cos(), ellipse.angle.sin());
                let off = ellipse.centre - truth[image];
                let parts = [off.dot(&along), off.perp(&along)];
                for axis in 0..2 {
                    seen[image][axis] += parts[axis].powi(2);
                    predicted[image][axis] += ellipse.half_axes[axis].powi(2);
                }
            }
            let found = [
                fit.fundamental.line1_from_point2(probe.point2).map(|line: Line| line.distance(on1)),
                fit.fundamental.line2_from_point1(probe.point1).map(|line: Line| line.distance(on2)),
            ];
            let deviations = [
                uncertainty.line1_deviation(probe.point2, probe.point1),
                uncertainty.line2_deviation(probe.point1, probe.point2),
            ];
            for image in 0..2 {
                seen[2][image] += found[image].unwrap().powi(2);
                predicted[2][image] += deviations[image].unwrap().powi(2);
            }
        }
        for (seen, predicted) in seen.into_iter().flatten().zip(predicted.into_iter().flatten()) {
            // A deviation from 200 runs is known to 5 %. Four times as much is allowed.
            let ratio: f64 = (seen / predicted).sqrt();
            assert!((0.8..1.2).contains(&ratio), "measured over predicted deviation {ratio}");
        }
    }
}
