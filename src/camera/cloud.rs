//! Scene points and cameras of a calibrated pair.

use nalgebra::Vector3;
use serde::Serialize;

use super::pose::RelativePose;
use super::view_pair::ViewPair;
use crate::geometry::{Point, PointPair};

/// Length of the pyramid of a camera, in units of the baseline.
const PYRAMID: f64 = 0.2;
const CORNERS: usize = 5;

/// Unit of a length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthUnit {
    /// Distance between the two cameras.
    Baseline,
    /// Unit of a calibration that names no unit: in most cases the unit in which the board was
    /// measured.
    Calibration,
    /// Metre.
    Metre,
    /// Millimetre.
    Millimetre,
}

/// Distance between two cameras.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Baseline {
    /// Length.
    pub length: f64,
    /// Unit of the length.
    pub unit: LengthUnit,
}

impl Baseline {
    /// A baseline of unknown length.
    pub const UNKNOWN: Self = Self { length: 1.0, unit: LengthUnit::Baseline };
}

/// Scene points of matches, with both cameras. Axes of camera 1.
#[derive(Debug, Clone, PartialEq)]
pub struct PointCloud {
    /// Scene points in front of both cameras.
    pub points: Vec<CloudPoint>,
    /// Corners of the pyramid of each camera: its centre, then the corners of its picture.
    pub cameras: [[Vector3<f64>; CORNERS]; 2],
    /// Distance between the cameras, in the unit of all positions.
    pub baseline: Baseline,
}

/// A triangulated match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CloudPoint {
    /// Position in the unit of [`PointCloud::baseline`].
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
    /// of view 1. Points that are not in front of both cameras are left out. The unit is the baseline.
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
        let cameras = [0, 1].map(|k| pyramid(pose, views, k));
        Self { points: points.collect(), cameras, baseline: Baseline::UNKNOWN }
    }

    /// Returns the cloud with another length of the baseline.
    #[must_use]
    pub fn with_baseline(mut self, baseline: Baseline) -> Self {
        let factor = baseline.length / self.baseline.length;
        for point in &mut self.points {
            point.place *= factor;
        }
        for corner in self.cameras.as_flattened_mut() {
            *corner *= factor;
        }
        Self { baseline, ..self }
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
