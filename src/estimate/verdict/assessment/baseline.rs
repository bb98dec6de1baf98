//! Test whether the matches determine the direction of the baseline of two known cameras.
//!
//! A plane leaves the epipoles of a fundamental matrix open, but an essential matrix only two solutions (Hartley &
//! Zisserman, §13.5; Faugeras & Lustman 1988). Three things leave its baseline open:
//!
//! - **A camera that only turned.** Null hypothesis: `x2 = K2 R K1⁻¹ x1` with a rotation `R`. The calibration may be wrong
//!   by a factor of both focal lengths, a further one of the second, and a radial distortion. With a wrong focal
//!   length, a turn looks like a plane before a moving camera. Such a turn has six numbers, and the homography of a plane
//!   has eight, so a plane seldom looks like a turn. Matches beside the turn show the baseline if they lie on their
//!   epipolar lines, as in the test of [`relief`](super::warp).
//! - **A wrong calibration.** It moves the points of a turned camera along some lines, but half of their scene points
//!   then lie behind the cameras.
//! - **The other solution of a plane.** It is a rival if its scene points lie in front of both cameras, too. The
//!   matches off the plane decide.

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, Vector3};

use super::warp::{Beside, counted, one_a_place};
use crate::camera::RelativePose;
use crate::estimate::evidence::patches::{LIKELY, UnguidedMatch};
use crate::estimate::fit::largest_plane;
use crate::estimate::verdict::trust::{Baseline, OtherPose, Witnesses};
use crate::geometry::{
    FundamentalMatrix, Point, PointPair, Vector, finite_point, point_equation, sampson_distance, solve_five,
    transfer_error,
};

/// First width of the robust cost, as a share of the longer side, and the ratio of successive widths. A wrong focal
/// length moves points by some tenths of the side. Matches that are farther from the turn do not count: wrong ones lie
/// anywhere in the picture, and on buildings along rows rather than across.
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
/// Number of samples of five matches on the plane. Each has both solutions, up to noise.
const SAMPLES: usize = 24;
/// Least share of the matches on the plane that its other solution explains.
const EXPLAINED: f64 = 0.9;
/// Angle between two directions of a baseline beyond which they differ, radians: 5°, within which poses are usually
/// counted as right.
const DIFFERENT: f64 = 0.087;

/// What the test needs to know of a geometry.
pub(super) struct Posed<'a> {
    pub f: &'a FundamentalMatrix,
    pub calibrations: &'a [Matrix3<f64>; 2],
    /// Matches along the lines of the geometry.
    pub matches: &'a [PointPair],
    /// Matches that were found without the geometry.
    pub unguided: &'a [UnguidedMatch],
    /// Longer side of image 1, px.
    pub side: f64,
    /// Largest error of a right match, px.
    pub tolerance: f64,
    pub seed: u64,
}

impl Posed<'_> {
    /// Returns the evidence for the direction of the baseline. `None` if no turn can be fitted.
    pub fn baseline(&self) -> Option<Baseline> {
        let pose = RelativePose::from_fundamental(self.f, self.calibrations, self.matches)?;
        let turned = self.fitted_turn()?;
        let points = pose.scene_points(self.calibrations, self.matches);
        Some(Baseline {
            beside: self.beside(&turned),
            other: self.other_pose(&pose),
            in_front: points.iter().flatten().count(),
            matches: points.len(),
        })
    }

    /// Fits a turn to most of the matches.
    fn fitted_turn(&self) -> Option<Turn> {
        let step_by = self.matches.len().div_ceil(FITTED_TO).max(1);
        let mut turn = Turn::of(self.calibrations, self.matches)?;
        let mut width = WIDEST * self.side;
        while width > 0.5 * self.tolerance {
            let steps: [Turn; PARAMETERS] = std::array::from_fn(|k| {
                let mut step = Step::zeros();
                step[k] = DIFFERENCE;
                turn.moved(&step)
            });
            let (mut normal, mut right) = (SMatrix::<f64, PARAMETERS, PARAMETERS>::zeros(), Step::zeros());
            for m in self.matches.iter().step_by(step_by) {
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

    /// Counts the matches found without the geometry that lie beside a turn. The place of a point after the turn need
    /// not lie on its line, as the turn may follow a plane.
    fn beside(&self, turned: &Turn) -> Witnesses {
        let mut on = 0;
        let mut beside = Vec::new();
        for pair in one_a_place(self.unguided, LIKELY) {
            let Some(off) = turned.off(&pair) else { continue };
            let distance = off.norm();
            if distance <= self.tolerance {
                on += 1;
            } else if distance < WIDEST * self.side
                && let Some(line) = self.f.line2_from_point1(pair.point1)
            {
                beside.push(Beside::at(pair, off, line.distance(pair.point2)));
            }
        }
        counted(&beside, on, self.tolerance)
    }

    /// Compares the pose with the other solution of the largest plane. `None` if there is none that differs.
    fn other_pose(&self, pose: &RelativePose) -> Option<OtherPose> {
        let (h, _) = largest_plane(self.matches, self.tolerance, self.seed)?;
        let on_plane: Vec<PointPair> =
            self.matches.iter().filter(|m| transfer_error(&h, m) < self.tolerance).copied().collect();
        let inverses = [self.calibrations[0].try_inverse()?, self.calibrations[1].try_inverse()?];
        if on_plane.len() < 5 {
            return None;
        }
        let equations: Vec<_> = on_plane
            .iter()
            .map(|m| {
                let [a, b] =
                    [inverses[0] * m.point1.to_homogeneous(), inverses[1] * m.point2.to_homogeneous()];
                point_equation([a.x / a.z, a.y / a.z, b.x / b.z, b.y / b.z])
            })
            .collect();
        let explains = |f: &FundamentalMatrix, m: &PointPair| sampson_distance(f, m) < self.tolerance;
        let share = |some: usize| some as f64 / on_plane.len() as f64;
        let mut best: Option<(f64, FundamentalMatrix)> = None;
        for sample in 0..SAMPLES {
            // One match of each fifth.
            let index = |fifth: usize| (fifth * SAMPLES + sample) * equations.len() / (5 * SAMPLES);
            for e in solve_five(&std::array::from_fn(|fifth| equations[index(fifth)])) {
                let matrix = inverses[1].transpose() * e * inverses[0];
                let Some(f) = FundamentalMatrix::from_rank_two(matrix) else { continue };
                let explained = share(on_plane.iter().filter(|m| explains(&f, m)).count());
                if explained < EXPLAINED || best.as_ref().is_some_and(|(most, _)| *most >= explained) {
                    continue;
                }
                let Some(other) = RelativePose::from_fundamental(&f, self.calibrations, &on_plane) else {
                    continue;
                };
                let seen = other.scene_points(self.calibrations, &on_plane);
                let is_in_front = share(seen.iter().flatten().count()) > 0.5;
                let apart = other.translation.angle(&pose.translation);
                if is_in_front && apart > DIFFERENT {
                    best = Some((explained, f));
                }
            }
        }
        let (_, other) = best?;
        let (mut this_only, mut other_only) = (0, 0);
        for m in one_a_place(self.unguided, LIKELY) {
            match (explains(self.f, &m), explains(&other, &m)) {
                (true, false) => this_only += 1,
                (false, true) => other_only += 1,
                _ => {}
            }
        }
        Some(OtherPose { this_only, other_only })
    }
}

/// Number of parameters of a turn.
const PARAMETERS: usize = 6;

type Step = SVector<f64, PARAMETERS>;

/// A camera that only turned, and whose calibration may be wrong.
#[derive(Debug, Clone, Copy)]
struct Turn {
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
    fn off(&self, m: &PointPair) -> Option<Vector> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::geometry::random_scene::RandomScene;

    const FOCAL: f64 = 600.0;

    fn calibrations() -> [Matrix3<f64>; 2] {
        [Matrix3::new(FOCAL, 0.0, 320.0, 0.0, FOCAL, 240.0, 0.0, 0.0, 1.0); 2]
    }

    /// Returns matches of scene points at depths by their place, after a turn and a step of the camera.
    fn matches(turn: [f64; 3], step: [f64; 3], zoom: f64, depth: impl Fn(f64, f64) -> f64) -> Vec<PointPair> {
        let rotation = Rotation3::new(Vector3::from(turn));
        let place = |k: usize| Point::new(20.0 + 28.0 * (k % 22) as f64, 20.0 + 24.0 * (k / 22) as f64);
        let matched = |k: usize| {
            let point1 = place(k);
            let ray = Vector3::new((point1.x - 320.0) / FOCAL, (point1.y - 240.0) / FOCAL, 1.0);
            let second = rotation * (ray * depth(ray.x, ray.y)) + Vector3::from(step);
            let at = |v: f64| zoom * FOCAL * v / second.z;
            PointPair { point1, point2: Point::new(320.0 + at(second.x), 240.0 + at(second.y)) }
        };
        RandomScene::new(3).disturbed(&(0..22 * 18).map(matched).collect::<Vec<_>>(), 0.1)
    }

    fn longer(calibration: &Matrix3<f64>, factor: f64) -> Matrix3<f64> {
        calibration * Matrix3::from_diagonal(&Vector3::new(factor, factor, 1.0))
    }

    fn of(matches: &[PointPair], turn: [f64; 3], step: [f64; 3]) -> Baseline {
        judged(matches, calibrations(), turn, step)
    }

    fn judged(
        matches: &[PointPair],
        calibrations: [Matrix3<f64>; 2],
        turn: [f64; 3],
        step: [f64; 3],
    ) -> Baseline {
        let pose = RelativePose {
            rotation: Rotation3::new(Vector3::from(turn)),
            translation: Vector3::from(step).normalize(),
        };
        let f = pose.fundamental(&calibrations).unwrap();
        let unguided: Vec<UnguidedMatch> =
            matches.iter().map(|pair| UnguidedMatch { pair: *pair, prior: 0.9 }).collect();
        let (unguided, side, tolerance) = (&unguided[..], 640.0, 1.0);
        Posed { f: &f, calibrations: &calibrations, matches, unguided, side, tolerance, seed: 0 }
            .baseline()
            .unwrap()
    }

    #[test]
    fn a_plane_shows_the_baseline_of_known_cameras_and_a_turn_does_not() {
        let (turn, step) = ([0.02, -0.1, 0.01], [-1.0, 0.1, 0.2]);
        let wall = |x: f64, y: f64| 6.0 / (1.0 + 0.5 * x - 0.1 * y);
        let moved = of(&matches(turn, step, 1.0, wall), turn, step);
        assert!(moved.beside.show_the_epipole(), "{moved:?}");
        for zoom in [1.0, 1.03] {
            let turned = of(&matches(turn, [0.0; 3], zoom, wall), turn, step);
            assert!(!turned.beside.show_the_epipole(), "{turned:?}");
        }
        // A wrong focal length, and a lens: the pose is that of a plane.
        let bent = |m: &PointPair| {
            let middle = Point::new(320.0, 240.0);
            let at = |p: Point| {
                let n = (p - middle) / FOCAL;
                middle + n * FOCAL * (1.0 - 0.1 * n.norm_squared())
            };
            PointPair { point1: at(m.point1), point2: at(m.point2) }
        };
        let turned: Vec<PointPair> = matches(turn, [0.0; 3], 1.0, wall).iter().map(bent).collect();
        for wrong in [0.7, 1.4] {
            let turned = judged(&turned, calibrations().map(|k| longer(&k, wrong)), turn, step);
            assert!(!turned.beside.show_the_epipole(), "{turned:?}");
        }
        // Half of the points are behind the cameras, as where a wrong calibration moves them.
        let half = |x: f64, y: f64| if (40.0 * x) as i32 % 2 == 0 { wall(x, y) } else { -wall(x, y) };
        let behind = of(&matches(turn, step, 1.0, half), turn, step);
        assert!(behind.is_behind() && !moved.is_behind(), "{behind:?}");
    }

    #[test]
    fn the_other_solution_of_a_plane_is_a_rival_until_matches_off_the_plane_decide() {
        // Two solutions have all points in front of both cameras, as the wall faces both.
        let (turn, step) = ([0.0, -0.15, 0.02], [-1.0, 0.05, 0.4]);
        let wall = |x: f64, y: f64| 6.0 / (1.0 + 0.4 * x + 0.3 * y);
        let flat = of(&matches(turn, step, 1.0, wall), turn, step);
        assert!(flat.other.is_some_and(|other| !other.is_decided()), "{flat:?}");
        let with_relief = |x: f64, y: f64| if (20.0 * x) as i32 % 3 == 0 { 3.0 } else { wall(x, y) };
        let decided = of(&matches(turn, step, 1.0, with_relief), turn, step);
        assert!(decided.other.is_none_or(OtherPose::is_decided), "{decided:?}");
    }
}
