//! Scene points and cameras as a PLY file for viewers of point clouds.
//!
//! Cameras are pyramids: vertices after the points, joined by edges. `MeshLab` draws edges; viewers that
//! know points only show the corners. Source of the format: Turk, "The PLY polygon file format".

use std::fmt::Write;

use image::DynamicImage;
use nalgebra::Vector3;

use crate::camera::{RelativePose, ViewPair};
use crate::geometry::PointPair;

/// Length of the pyramid of a camera, in units of the baseline.
const PYRAMID: f64 = 0.2;
/// Corners of a pyramid: the centre of the camera, then the corners of its picture.
const CORNERS: usize = 5;
/// Edges of a pyramid.
const EDGES: [[usize; 2]; 8] = [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]];
/// Colours of the left and the right camera.
const COLOURS: [[u8; 3]; 2] = [[230, 60, 40], [40, 110, 230]];

/// Scene points of matches, with both cameras. Axes of camera 1; the unit is the distance of the
/// cameras.
#[derive(Debug, Clone, PartialEq)]
pub struct PointCloud {
    /// Points with their colours.
    points: Vec<(Vector3<f64>, [u8; 3])>,
    /// Corners of the pyramids of both cameras.
    cameras: [[Vector3<f64>; CORNERS]; 2],
}

impl PointCloud {
    /// Triangulates the matches of two views without distortion. `left` is the picture of view 1, for the
    /// colours. Points that are not in front of both cameras are left out.
    pub fn new(pose: &RelativePose, views: &ViewPair, matches: &[PointPair], left: &DynamicImage) -> Self {
        let pixels = left.to_rgb8();
        let colour = |pair: &PointPair| {
            let at = |v: f64, size: u32| v.round().clamp(0.0, f64::from(size.saturating_sub(1))) as u32;
            let (x, y) = (at(pair.point1.x, pixels.width()), at(pair.point1.y, pixels.height()));
            pixels.get_pixel_checked(x, y).map_or([128; 3], |pixel| pixel.0)
        };
        let places = pose.scene_points(&views.calibrations(), matches);
        let points = places.into_iter().zip(matches);
        Self {
            points: points.filter_map(|(place, pair)| Some((place?, colour(pair)))).collect(),
            cameras: [0, 1].map(|k| pyramid(pose, views, k)),
        }
    }

    /// Returns the file.
    pub fn to_ply(&self) -> String {
        let mut text = format!(
            "ply\nformat ascii 1.0\ncomment {} scene points, then both cameras as pyramids of {CORNERS} vertices, written \
             by epiline {}.\ncomment Axes of camera 1: x right, y down, z forwards. The unit is the distance between the \
             cameras.\nelement vertex {}\n",
            self.points.len(),
            env!("CARGO_PKG_VERSION"),
            self.points.len() + 2 * CORNERS
        );
        for name in ["float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"] {
            let _ = writeln!(text, "property {name}");
        }
        let _ = writeln!(text, "element edge {}", 2 * EDGES.len());
        text += "property int vertex1\nproperty int vertex2\nend_header\n";
        let corners = self.cameras.iter().zip(COLOURS);
        let corners =
            corners.flat_map(|(corners, colour)| corners.iter().map(move |corner| (*corner, colour)));
        for (place, [red, green, blue]) in self.points.iter().copied().chain(corners) {
            // Viewers read single precision.
            let [x, y, z] = [place.x, place.y, place.z].map(|v| v as f32);
            let _ = writeln!(text, "{x} {y} {z} {red} {green} {blue}");
        }
        for camera in 0..2 {
            let first = self.points.len() + camera * CORNERS;
            for [from, to] in EDGES {
                let _ = writeln!(text, "{} {}", first + from, first + to);
            }
        }
        text
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

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;
    use crate::camera::CameraModel;
    use crate::geometry::Frame;

    #[test]
    fn points_in_front_are_written_with_colours_and_both_cameras() {
        let camera = CameraModel::from_colmap("PINHOLE", &[100.0, 100.0, 32.5, 24.5]).unwrap();
        let views = ViewPair::new([&camera; 2], [Frame::new(64, 48); 2]).unwrap();
        let pose =
            RelativePose { rotation: Rotation3::identity(), translation: Vector3::new(-1.0, 0.0, 0.0) };
        // A point 10 units ahead has a disparity of 10 px; the other one would be behind the cameras.
        let matches = [PointPair::new(42.0, 24.0, 32.0, 24.0), PointPair::new(32.0, 24.0, 42.0, 24.0)];
        let left = DynamicImage::from(image::RgbImage::from_pixel(64, 48, image::Rgb([1, 2, 3])));
        let text = PointCloud::new(&pose, &views, &matches, &left).to_ply();
        let (header, body) = text.split_once("end_header\n").unwrap();
        assert!(header.starts_with("ply\nformat ascii 1.0\n"), "{header}");
        assert!(header.contains("element vertex 11\n") && header.contains("element edge 16\n"), "{header}");
        let rows: Vec<&str> = body.lines().collect();
        assert_eq!((rows.len(), rows[0], rows[1]), (27, "1 0 10 1 2 3", "0 0 0 230 60 40"));
        assert_eq!((rows[6], rows[11], rows[26]), ("1 0 0 40 110 230", "1 2", "10 7"));
    }
}
