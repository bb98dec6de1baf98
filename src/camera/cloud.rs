//! Scene points and cameras of a calibrated pair.

use nalgebra::Vector3;

use super::pose::RelativePose;
use super::view_pair::ViewPair;
use crate::geometry::{Point, PointPair};

/// Length of the pyramid of a camera, in units of the baseline.
const PYRAMID: f64 = 0.2;
const CORNERS: usize = 5;

/// Scene points of matches, with both cameras. Axes of camera 1; the unit is the distance of the
/// cameras.
#[derive(Debug, Clone, PartialEq)]
pub struct PointCloud {
    /// Scene points in front of both cameras.
    pub points: Vec<CloudPoint>,
    /// Corners of the pyramid of each camera: its centre, then the corners of its picture.
    pub cameras: [[Vector3<f64>; CORNERS]; 2],
}

/// A triangulated match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudPoint {
    /// Position, in units of the baseline.
    pub place: Vector3<f64>,
    /// Red, green and blue.
    pub color: [u8; 3],
    /// Number of the match, from 0.
    pub number: usize,
}

impl PointCloud {
    /// Number of corners of a pyramid.
    pub const CORNERS: usize = CORNERS;
    /// Edges of a pyramid, as pairs of corners.
    pub const EDGES: [[usize; 2]; 8] = [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]];

    /// Triangulates the matches of two views without distortion. `color` returns the colour of a point
    /// of view 1. Points that are not in front of both cameras are left out.
    pub fn new(
        pose: &RelativePose,
        views: &ViewPair,
        matches: &[PointPair],
        color: impl Fn(Point) -> [u8; 3],
    ) -> Self {
        let places = pose.scene_points(&views.calibrations(), matches);
        let points = places.into_iter().zip(matches).enumerate();
        let points = points.filter_map(|(number, (place, pair))| {
            Some(CloudPoint { place: place?, color: color(pair.point1), number })
        });
        Self { points: points.collect(), cameras: [0, 1].map(|k| pyramid(pose, views, k)) }
    }

    /// Returns the angle between the rays of the two cameras to a place, radians.
    pub fn parallax(&self, place: &Vector3<f64>) -> f64 {
        let [ray1, ray2] = self.cameras.map(|corners| place - corners[0]);
        ray1.angle(&ray2)
    }
}

/// Returns the corners of the pyramid of a camera.
fn pyramid(pose: &RelativePose, views: &ViewPair, k: usize) -> [Vector3<f64>; CORNERS] {
    let view = &views.views[k];
    let (right, bottom) = (view.frame().right(), view.frame().bottom());
    let inverse = view.calibration().try_inverse().unwrap_or_default();
    let corner = |x: f64, y: f64| inverse * Vector3::new(x, y, 1.0) * PYRAMID;
    let corners =
        [Vector3::zeros(), corner(0.0, 0.0), corner(right, 0.0), corner(right, bottom), corner(0.0, bottom)];
    corners.map(|corner| if k == 0 { corner } else { pose.rotation.inverse() * (corner - pose.translation) })
}
