//! Test whether the matches determine the direction of the baseline of two known cameras.
//!
//! A plane leaves the epipoles of a fundamental matrix open, but an essential matrix only two solutions (Hartley &
//! Zisserman, §13.5; Faugeras & Lustman 1988). Three things leave its baseline open:
//!
//! - **A camera that only turned.** Null hypothesis: `x2 = K2 R K1⁻¹ x1` with a rotation `R`. The calibration may be wrong
//!   by a factor of both focal lengths, a further one of the second, and a radial distortion. With a wrong focal
//!   length, a turn looks like a plane before a moving camera. Such a turn has six numbers, and the homography of a plane
//!   has eight, so a plane seldom looks like a turn. Matches beside the turn show the baseline if they lie on their
//!   epipolar lines, as in the test of [`relief`](super::relief).
//! - **A wrong calibration.** It moves the points of a turned camera along some lines, but half of their scene points
//!   then lie behind the cameras.
//! - **The other solution of a plane.** It is a rival if its scene points lie in front of both cameras, too. The
//!   matches off the plane decide.

use nalgebra::Matrix3;

use super::relief::{Beside, LeadOver, counted, likelier_beside};
use crate::camera::RelativePose;
use crate::estimate::evidence::patches::{LIKELY, UnguidedMatch, one_a_place};
use crate::estimate::fit::{Turn, other_pose};
use crate::estimate::verdict::trust::{Baseline, OtherPose, Witnesses};
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance};

/// What the test needs to know of a geometry.
pub(super) struct Posed<'a> {
    pub f: &'a FundamentalMatrix,
    pub calibrations: &'a [Matrix3<f64>; 2],
    /// Matches along the lines of the geometry.
    pub matches: &'a [PointPair],
    /// Matches that were found without the geometry.
    pub unguided: &'a [UnguidedMatch],
    pub lead_over: LeadOver<'a>,
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
        let turned = Turn::fit(self.calibrations, self.matches, self.side, self.tolerance)?;
        let points = pose.scene_points(self.calibrations, self.matches);
        Some(Baseline {
            beside: self.beside(&turned),
            other: self.other_pose(&pose),
            in_front: points.iter().flatten().count(),
            matches: points.len(),
        })
    }

    /// Counts the matches found without the geometry that lie beside a turn. Matches that are far from it do not count:
    /// wrong ones lie anywhere in the picture, and on buildings along rows rather than across. The place of a point after the turn need
    /// not lie on its line, as the turn may follow a plane.
    fn beside(&self, turned: &Turn) -> Witnesses {
        let mut on = 0;
        let mut beside = Vec::new();
        for pair in one_a_place(self.unguided, LIKELY) {
            let Some(off) = turned.off(&pair) else { continue };
            let distance = off.norm();
            if distance <= self.tolerance {
                on += 1;
            } else if distance < Turn::REACH * self.side
                && let Some(line) = self.f.line2_from_point1(pair.point1)
            {
                beside.push(Beside::at(pair, off, line.distance(pair.point2)));
            }
        }
        let (on, beside) = likelier_beside(on, beside, self.lead_over);
        counted(&beside, on, self.tolerance)
    }

    /// Compares the pose with the other solution of the largest plane. `None` if there is none that differs.
    fn other_pose(&self, pose: &RelativePose) -> Option<OtherPose> {
        let other = other_pose(pose, self.calibrations, self.matches, self.tolerance, self.seed)?;
        let explains = |f: &FundamentalMatrix, m: &PointPair| sampson_distance(f, m) < self.tolerance;
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

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3};

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
        judged(matches, calibrations(), turn, step, &|_, _| None)
    }

    fn judged(
        matches: &[PointPair],
        calibrations: [Matrix3<f64>; 2],
        turn: [f64; 3],
        step: [f64; 3],
        lead_over: LeadOver,
    ) -> Baseline {
        let pose = RelativePose {
            rotation: Rotation3::new(Vector3::from(turn)),
            translation: Vector3::from(step).normalize(),
        };
        let f = pose.fundamental(&calibrations).unwrap();
        let unguided: Vec<UnguidedMatch> =
            matches.iter().map(|pair| UnguidedMatch { pair: *pair, prior: 0.9 }).collect();
        let (unguided, side, tolerance) = (&unguided[..], 640.0, 1.0);
        Posed { f: &f, calibrations: &calibrations, matches, unguided, lead_over, side, tolerance, seed: 0 }
            .baseline()
            .unwrap()
    }

    #[test]
    fn a_plane_shows_the_baseline_of_known_cameras_and_a_turn_does_not() {
        let (turn, step) = ([0.02, -0.1, 0.01], [-1.0, 0.1, 0.2]);
        let wall = |x: f64, y: f64| 6.0 / (1.0 + 0.5 * x - 0.1 * y);
        let moved = of(&matches(turn, step, 1.0, wall), turn, step);
        assert!(moved.beside.show_the_epipole(), "{moved:?}");
        // Each match looks as well in its place after the turn.
        let equal = judged(&matches(turn, step, 1.0, wall), calibrations(), turn, step, &|_, _| Some(0.0));
        assert!(equal.beside.along == 0 && !equal.beside.show_the_epipole(), "{equal:?}");
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
            let longer = calibrations().map(|k| longer(&k, wrong));
            let turned = judged(&turned, longer, turn, step, &|_, _| None);
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
