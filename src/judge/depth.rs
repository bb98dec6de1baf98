//! Whether the scene lies in front of the cameras.
//!
//! `F` is the same for a translation and for its opposite. The depths of the matches tell them apart: with
//! the wrong sign, all scene points lie behind both cameras (Hartley & Zisserman, §9.6.3).

use nalgebra::Rotation3;

use super::cameras::DecomposedCamera;
use super::contest::Contest;
use crate::camera::RelativePose;
use crate::geometry::{Camera, Frame, PointPair, finite_point};

/// Counts the places whose matches lie behind both cameras (first), and in front of both (second). Matches
/// within `limit` px of their place at infinity have no certain depth and do not count.
///
/// `None` for cameras at one place, and for cameras whose sign is open: a matrix with a negative determinant
/// may have been multiplied by −1, or belong to mirrored axes of the scene.
pub(super) fn behind(
    cameras: &[Camera; 2],
    matches: &[PointPair],
    frame1: Frame,
    limit: f64,
) -> Option<Contest> {
    if cameras.iter().any(|camera| camera.matrix().fixed_columns::<3>(0).determinant() <= 0.0) {
        return None;
    }
    let [first, second] = [DecomposedCamera::new(&cameras[0])?, DecomposedCamera::new(&cameras[1])?];
    let rotation = second.rotation * first.rotation.transpose();
    let translation = (second.translation - rotation * first.translation).try_normalize(0.0)?;
    let pose = RelativePose { rotation: Rotation3::from_matrix_unchecked(rotation), translation };
    let inverses = [first.calibration.try_inverse()?, second.calibration.try_inverse()?];
    let vote = |pair: &PointPair| {
        let rays = [inverses[0] * pair.point1.to_homogeneous(), inverses[1] * pair.point2.to_homogeneous()];
        let at_infinity = finite_point(&(second.calibration * (rotation * rays[0])))?;
        let depths = pose.depths(&rays).filter(|_| (pair.point2 - at_infinity).norm() > limit)?;
        let signs = depths.map(|depth| if depth < 0.0 { 1 } else { -1 });
        Some((pair.point1, if signs[0] == signs[1] { signs[0] } else { 0 }))
    };
    Some(Contest::of(matches.iter().filter_map(vote), frame1))
}
