//! A view of a scene from outside, that a person turns, moves and zooms.
//!
//! Axes of camera 1: x right, y down, z forwards. The unit is the distance of the cameras.

use nalgebra::{Rotation3, Vector2, Vector3};

use super::cloud::PointCloud;

/// Share of the points, nearest first, that a fitted view shows. Points with hardly any parallax lie
/// anywhere along their rays.
const FITTED: f64 = 0.95;
/// Half of the room that a fitted view fills, as a share of the area.
const HALF: f64 = 0.45;
/// Depth from the eye at which things disappear, as a share of the distance of the view.
const NEAREST: f64 = 0.02;
/// Turn of a fitted view: from the left and from above, radians. It shows a wall before the cameras nearly from the
/// front, and the cameras beside it.
const FROM_LEFT: f64 = -0.6;
const FROM_ABOVE: f64 = 0.25;
/// Steps of a fitted view towards the middle of all that it shows.
const CENTRING: usize = 8;
/// Length of the pyramid of a camera in the middle of a view, as a share of the area.
const CAMERA: f64 = 0.07;
/// Range of the distance of a view, baselines.
const DISTANCES: [f64; 2] = [0.05, 1e5];

/// A view of a scene from outside, by a camera that looks at a centre.
///
/// Screen positions are shares of the shorter side of the area, from its middle, x right, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Place in the middle of the area.
    centre: Vector3<f64>,
    /// Turn about the y axis of camera 1, radians.
    yaw: f64,
    /// Turn from above, radians.
    pitch: f64,
    /// Distance of the eye from the centre.
    distance: f64,
}

impl Orbit {
    /// Returns a view of both cameras and of nearly all points, for an area of this size.
    pub fn fitting(cloud: &PointCloud, size: Vector2<f64>) -> Self {
        let mut places: Vec<Vector3<f64>> = cloud.points.iter().map(|point| point.place).collect();
        places.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        places.truncate((FITTED * places.len() as f64).ceil() as usize);
        let of_points = places.len();
        places.extend(cloud.cameras.iter().flatten());
        let start = Self { centre: Vector3::zeros(), yaw: FROM_LEFT, pitch: FROM_ABOVE, distance: 1.0 };
        let rotation = start.rotation();
        let turned: Vec<Vector3<f64>> = places.iter().map(|place| rotation * place).collect();
        let least = turned.iter().fold(Vector3::repeat(f64::INFINITY), |all, place| all.inf(place));
        let most = turned.iter().fold(Vector3::repeat(f64::NEG_INFINITY), |all, place| all.sup(place));
        let mut middle = 0.5 * (least + most);
        let half = size * (HALF / size.min().max(1e-9));
        let needed = |middle: Vector3<f64>| {
            let needed = turned.iter().map(|place| {
                let away = place - middle;
                (away.x.abs() / half.x).max(away.y.abs() / half.y) - away.z
            });
            needed.fold(0.0, f64::max).clamp(DISTANCES[0], DISTANCES[1])
        };
        // Near things take more room on the screen, so its middle is not that of the places.
        for _ in 0..CENTRING {
            let distance = needed(middle);
            let seen = turned.iter().map(|place| (place - middle).xy() / (place.z - middle.z + distance));
            let [least, most] = seen
                .fold([Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN)], |all, at| {
                    [all[0].inf(&at), all[1].sup(&at)]
                });
            let off = 0.5 * (least + most) * distance;
            middle += Vector3::new(off.x, off.y, 0.0);
        }
        let mut distance = needed(middle);
        // The same view, but turning is about the median depth of the points. About a place nearer to
        // the cameras, the points would leave the view.
        if of_points > 0 {
            let mut depths: Vec<f64> = turned[..of_points].iter().map(|place| place.z).collect();
            depths.sort_by(f64::total_cmp);
            let further = depths[of_points / 2] - middle.z;
            middle.z += further;
            distance = (distance + further).clamp(DISTANCES[0], DISTANCES[1]);
        }
        Self { centre: rotation.inverse() * middle, distance, ..start }
    }

    /// Returns the rotation from the axes of camera 1 to those of the view.
    pub fn rotation(&self) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Vector3::x_axis(), self.pitch)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), self.yaw)
    }

    /// Returns a function from a place to its screen position and its depth from the eye, as a multiple
    /// of the distance of the centre; `None` behind the eye.
    pub fn projection(&self) -> impl Fn(&Vector3<f64>) -> Option<(Vector2<f64>, f64)> {
        let (rotation, centre, distance) = (self.rotation(), self.centre, self.distance);
        move |place| {
            let seen = rotation * (place - centre);
            let depth = seen.z + distance;
            (depth > NEAREST * distance).then(|| (seen.xy() / depth, depth / distance))
        }
    }

    /// Returns the corners of the cameras of a cloud, enlarged or reduced so that a camera in the middle
    /// of the view has always the same size on the screen.
    pub fn cameras(&self, cloud: &PointCloud) -> [[Vector3<f64>; 5]; 2] {
        cloud.cameras.map(|corners| {
            let length = (0.25 * corners[1..].iter().sum::<Vector3<f64>>() - corners[0]).norm();
            let factor = CAMERA * self.distance / length.max(1e-12);
            corners.map(|corner| corners[0] + factor * (corner - corners[0]))
        })
    }

    /// Returns the view after a drag over the screen.
    #[must_use]
    pub fn turned(self, by: Vector2<f64>) -> Self {
        let pitch = (self.pitch + 3.0 * by.y).clamp(-1.55, 1.55);
        Self { yaw: self.yaw - 3.0 * by.x, pitch, ..self }
    }

    /// Returns the view in which the centre has moved over the screen.
    #[must_use]
    pub fn panned(self, by: Vector2<f64>) -> Self {
        let step = Vector3::new(by.x, by.y, 0.0) * self.distance;
        Self { centre: self.centre - self.rotation().inverse() * step, ..self }
    }

    /// Returns the view from nearer by a factor. A place as far away as the centre stays under the
    /// screen position.
    #[must_use]
    pub fn zoomed(self, at: Vector2<f64>, factor: f64) -> Self {
        let distance = (self.distance / factor).clamp(DISTANCES[0], DISTANCES[1]);
        let stays = at * (distance / self.distance - 1.0);
        Self { distance, ..self.panned(stays) }
    }

    /// Returns the number of the match whose point is nearest to a screen position, within reach. Of points at
    /// one place, the front one counts.
    pub fn nearest(&self, cloud: &PointCloud, at: Vector2<f64>, reach: f64) -> Option<usize> {
        let project = self.projection();
        let near = cloud.points.iter().filter_map(|point| {
            let (seen, depth) = project(&point.place)?;
            let away = (seen - at).norm();
            (away <= reach).then_some((away + 0.2 * reach * depth, point.number))
        });
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, number)| number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Baseline, CloudPoint};

    fn cloud() -> PointCloud {
        let places = (0..50).map(|k| {
            let k = f64::from(k);
            Vector3::new((k * 0.7).sin() * 3.0, (k * 1.3).cos() * 2.0, 6.0 + (k * 0.4).sin())
        });
        let points = places.enumerate().map(|(number, place)| CloudPoint { place, color: [9; 3], number });
        let pyramid = |x: f64| [0.0, 0.1, 0.2, 0.3, 0.4].map(|z| Vector3::new(x, z * 0.1, z));
        let cameras = [pyramid(0.0), pyramid(1.0)];
        PointCloud { points: points.collect(), cameras, baseline: Baseline::UNKNOWN }
    }

    #[test]
    fn a_fitted_view_shows_cameras_and_points_and_not_much_else() {
        let (cloud, size) = (cloud(), Vector2::new(1200.0, 500.0));
        let orbit = Orbit::fitting(&cloud, size);
        let project = orbit.projection();
        let seen: Vec<Vector2<f64>> =
            cloud.cameras.iter().flatten().map(|place| project(place).unwrap().0).collect();
        assert!(seen.iter().all(|at| at.x.abs() <= 1.2 && at.y.abs() <= 0.5), "{seen:?}");
        let points: Vec<_> = cloud.points.iter().map(|point| project(&point.place).unwrap().0).collect();
        let inside = points.iter().filter(|at| at.x.abs() <= 1.2 && at.y.abs() <= 0.5).count();
        assert!(inside * 100 >= points.len() * 95, "{inside}");
        let all = || points.iter().chain(&seen);
        let reach = all().map(|at| (at.x.abs() / 1.2).max(at.y.abs() / 0.5)).fold(0.0, f64::max);
        assert!(reach > 0.85, "{reach}");
        let [left, right] = [f64::min, f64::max].map(|of| all().map(|at| at.x).reduce(of).unwrap());
        let [top, bottom] = [f64::min, f64::max].map(|of| all().map(|at| at.y).reduce(of).unwrap());
        assert!((left + right).abs() < 0.05 && (top + bottom).abs() < 0.05, "in the middle of the screen");
    }

    #[test]
    fn points_stay_in_view_while_the_scene_turns() {
        let mut cloud = cloud();
        // A wall ten times as far away as the cameras are apart, and some trees before it.
        for (k, point) in cloud.points.iter_mut().enumerate() {
            point.place.z = if k % 10 == 0 { 3.0 } else { 10.0 + 0.1 * point.place.z };
        }
        let orbit = Orbit::fitting(&cloud, Vector2::new(1200.0, 800.0));
        for by in [Vector2::new(0.25, 0.1), Vector2::new(-0.25, -0.1)] {
            let turned = orbit.turned(by);
            let project = turned.projection();
            let seen = cloud.points.iter().filter_map(|point| project(&point.place));
            let inside = seen.filter(|(at, _)| at.x.abs() <= 0.75 && at.y.abs() <= 0.5).count();
            assert!(inside * 10 >= cloud.points.len() * 9, "{inside} of {}", cloud.points.len());
        }
    }

    #[test]
    fn things_follow_the_cursor_and_a_zoom_keeps_the_place_under_it() {
        let cloud = cloud();
        let orbit = Orbit::fitting(&cloud, Vector2::new(800.0, 600.0));
        let project = |orbit: &Orbit, place: &Vector3<f64>| orbit.projection()(place).unwrap().0;
        // A point in front of the centre moves with a drag.
        let front = orbit.centre - orbit.rotation().inverse() * Vector3::z() * (0.3 * orbit.distance);
        let by = Vector2::new(0.05, 0.03);
        let moved = project(&orbit.turned(by), &front) - project(&orbit, &front);
        assert!(moved.x > 0.0 && moved.y > 0.0, "{moved:?}");
        let moved = project(&orbit.panned(by), &orbit.centre);
        assert!((moved - by).norm() < 1e-9);
        let at = Vector2::new(0.2, -0.1);
        let under =
            orbit.centre + orbit.rotation().inverse() * Vector3::new(at.x, at.y, 0.0) * orbit.distance;
        let after = orbit.zoomed(at, 2.0);
        assert!((project(&after, &under) - at).norm() < 1e-9 && after.distance < orbit.distance);
    }

    #[test]
    fn a_camera_in_the_middle_keeps_its_size_on_the_screen() {
        let mut cloud = cloud();
        let near = Orbit::fitting(&cloud, Vector2::new(800.0, 600.0));
        for factor in [0.1, 1.0, 10.0] {
            let orbit = Orbit { distance: near.distance / factor, ..near };
            cloud.cameras = cloud.cameras.map(|corners| corners.map(|c| c - corners[0] + orbit.centre));
            let [corners, _] = orbit.cameras(&cloud);
            let length = (0.25 * corners[1..].iter().sum::<Vector3<f64>>() - corners[0]).norm();
            assert!((length / orbit.distance - CAMERA).abs() < 1e-9, "{length}");
        }
    }

    #[test]
    fn the_nearest_point_is_the_one_under_the_cursor() {
        let cloud = cloud();
        let orbit = Orbit::fitting(&cloud, Vector2::new(800.0, 600.0));
        let (at, _) = orbit.projection()(&cloud.points[7].place).unwrap();
        assert_eq!(orbit.nearest(&cloud, at, 0.005), Some(7));
        assert_eq!(orbit.nearest(&cloud, Vector2::new(5.0, 5.0), 0.005), None);
        let behind = orbit.centre - orbit.rotation().inverse() * Vector3::z() * (2.0 * orbit.distance);
        assert!(orbit.projection()(&behind).is_none());
    }
}
