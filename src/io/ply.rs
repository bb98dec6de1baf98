//! Scene points and cameras as a PLY file for viewers of point clouds.
//!
//! Cameras are pyramids: vertices after the points, joined by edges. `MeshLab` draws edges; viewers that
//! know points only show the corners. Source of the format: Turk, "The PLY polygon file format".

use std::fmt::Write;

use super::geometry_file::TrustNote;
use crate::camera::{Baseline, LengthUnit, PointCloud};

/// Colours of the left and the right camera.
const COLOURS: [[u8; 3]; 2] = [[230, 60, 40], [40, 110, 230]];

/// Returns the text of the file, with the verdict on the geometry.
pub fn cloud_as_ply(cloud: &PointCloud, trust: Option<&TrustNote>) -> String {
    const CORNERS: usize = PointCloud::CORNERS;
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment {} scene points, then both cameras as pyramids of {CORNERS} vertices, written \
         by epiline {}.\ncomment Axes of camera 1: x right, y down, z forwards. {}\n{}element vertex \
         {}\n",
        cloud.points.len(),
        env!("CARGO_PKG_VERSION"),
        unit_in_words(&cloud.baseline),
        trust.map_or_else(String::new, |trust| format!("comment {}\n", trust.in_words().replace('\n', " "))),
        cloud.points.len() + 2 * CORNERS
    );
    for name in ["float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"] {
        let _ = writeln!(text, "property {name}");
    }
    let _ = writeln!(text, "element edge {}", 2 * PointCloud::EDGES.len());
    text += "property int vertex1\nproperty int vertex2\nend_header\n";
    let corners = cloud.cameras.iter().zip(COLOURS);
    let corners = corners.flat_map(|(corners, colour)| corners.iter().map(move |corner| (*corner, colour)));
    let points = cloud.points.iter().map(|point| (point.place, point.color));
    for (place, [red, green, blue]) in points.chain(corners) {
        // Viewers read single precision.
        let [x, y, z] = [place.x, place.y, place.z].map(|v| v as f32);
        let _ = writeln!(text, "{x} {y} {z} {red} {green} {blue}");
    }
    for camera in 0..2 {
        let first = cloud.points.len() + camera * CORNERS;
        for [from, to] in PointCloud::EDGES {
            let _ = writeln!(text, "{} {}", first + from, first + to);
        }
    }
    text
}

/// Describes the unit of a cloud.
fn unit_in_words(baseline: &Baseline) -> String {
    let unit = match baseline.unit {
        LengthUnit::Baseline => return "The unit is the distance between the cameras.".to_owned(),
        LengthUnit::Calibration => "that of the calibration",
        LengthUnit::Metre => "the metre",
        LengthUnit::Millimetre => "the millimetre",
    };
    format!("The unit is {unit}; the cameras are {} apart.", baseline.length)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3};

    use super::*;
    use crate::camera::{CameraModel, RelativePose, ViewPair};
    use crate::geometry::{Frame, PointPair};

    #[test]
    fn points_in_front_are_written_with_colours_and_both_cameras() {
        let camera = CameraModel::from_colmap("PINHOLE", &[100.0, 100.0, 32.5, 24.5]).unwrap();
        let views = ViewPair::new([&camera; 2], [Frame::new(64, 48); 2]).unwrap();
        let pose =
            RelativePose { rotation: Rotation3::identity(), translation: Vector3::new(-1.0, 0.0, 0.0) };
        // A point 10 units ahead has a disparity of 10 px; the other one would be behind the cameras.
        let matches = [PointPair::new(42.0, 24.0, 32.0, 24.0), PointPair::new(32.0, 24.0, 42.0, 24.0)];
        let cloud = PointCloud::new(&pose, &views, &matches, |_| [1, 2, 3]);
        let note = TrustNote::not_judged();
        let text = cloud_as_ply(&cloud, Some(&note));
        let (header, body) = text.split_once("end_header\n").unwrap();
        assert!(header.starts_with("ply\nformat ascii 1.0\n"), "{header}");
        assert!(header.contains("element vertex 11\n") && header.contains("element edge 16\n"), "{header}");
        let rows: Vec<&str> = body.lines().collect();
        assert_eq!((rows.len(), rows[0], rows[1]), (27, "1 0 10 1 2 3", "0 0 0 230 60 40"));
        assert_eq!((rows[6], rows[11], rows[26]), ("1 0 0 40 110 230", "1 2", "10 7"));
        assert!(header.contains("The unit is the distance between the cameras.\n"), "{header}");
        let known = Baseline { length: 120.5, unit: LengthUnit::Millimetre };
        let text = cloud_as_ply(&cloud.with_baseline(known), None);
        let (header, body) = text.split_once("end_header\n").unwrap();
        assert!(header.contains("The unit is the millimetre; the cameras are 120.5 apart.\n"), "{header}");
        let rows: Vec<&str> = body.lines().collect();
        assert_eq!((rows[0], rows[6]), ("120.5 0 1205 1 2 3", "120.5 0 0 40 110 230"));
    }
}
