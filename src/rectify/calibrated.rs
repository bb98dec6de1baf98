//! Rectification of calibrated cameras: both turn about their centres until their axes are parallel
//! and their rows agree (Fusiello, Trucco & Verri 2000).

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::choice::RectifyTask;
use super::extent::{Extent, Range};
use super::map::{ImageMap, MapKind};
use super::planar::{PlanarMap, corners};
use super::{Limits, Rectification, RectifyError, RectifyMethod};
use crate::camera::{RelativePose, ViewPair};
use crate::geometry::{Frame, PointPair, scaling};

/// Rectified stereo cameras: one calibration matrix, parallel axes, the right camera at +x of the
/// left one. Disparities `x_left − x_right` are positive, and depth is `f · baseline / disparity`.
#[derive(Debug, Clone, PartialEq)]
pub struct StereoRig {
    /// Calibration matrix of both rectified pictures, px.
    pub calibration: Matrix3<f64>,
    /// Rotations from the cameras of image 1 and image 2 to the rectified axes.
    pub rotations: [Rotation3<f64>; 2],
    /// Whether camera 2 is the left one.
    pub is_exchanged: bool,
}

/// Largest angle between the baseline and the plane of the rows, as the cosine between baseline and
/// mean optical axis: 60°. Beyond it the pictures are stretched by more than 4; a chosen value.
const MOST_FORWARD: f64 = 0.87;

/// Rectifies two calibrated views. `matches`, in the views, only measure the rows.
///
/// # Errors [`RectifyError::Forward`] if one camera stands nearly in front of the other, and the
/// errors of sizes as for [`super::rectify`].
pub fn rectify_calibrated(
    pose: &RelativePose,
    views: &ViewPair,
    matches: &[PointPair],
    limits: &Limits,
) -> Result<(Rectification, StereoRig), RectifyError> {
    let baseline = pose.position2();
    let axes = [Vector3::z(), pose.rotation.inverse() * Vector3::z()];
    let forward = (axes[0] + axes[1]).try_normalize(1e-6).ok_or(RectifyError::NoCommonPlane)?;
    if baseline.dot(&forward).abs() > MOST_FORWARD {
        return Err(RectifyError::Forward);
    }
    // The rows keep the sense of x in image 1.
    let is_exchanged = baseline.x < 0.0;
    let x = if is_exchanged { -baseline } else { baseline };
    let z = (forward - x * forward.dot(&x)).normalize();
    let first = Matrix3::from_rows(&[x.transpose(), z.cross(&x).transpose(), z.transpose()]);
    let first = Rotation3::from_matrix_unchecked(first);
    let rotations = [first, first * pose.rotation.inverse()];
    let calibrations = views.calibrations();
    let focal = 0.5 * (calibrations[0][(1, 1)] + calibrations[1][(1, 1)]);
    let mut maps = [Matrix3::identity(); 2];
    for k in 0..2 {
        let inverse = calibrations[k].try_inverse().ok_or(RectifyError::NoCommonPlane)?;
        maps[k] = Matrix3::from_diagonal(&Vector3::new(focal, focal, 1.0)) * rotations[k].matrix() * inverse;
    }
    let (placement, size, scale) = placement(&maps, views, limits.pixels)?;
    let placed = |k: usize| PlanarMap::new(placement * maps[k]).ok_or(RectifyError::NoCommonPlane);
    let maps = [placed(0)?, placed(1)?].map(|m| ImageMap::new(MapKind::Planar(m)));
    let calibration = placement * Matrix3::from_diagonal(&Vector3::new(focal, focal, 1.0));
    let fundamental = pose.fundamental(&calibrations).ok_or(RectifyError::NoCommonPlane)?;
    let task = RectifyTask { fundamental: &fundamental, frames: views.frames(), matches, limits };
    let reason = "the cameras are calibrated".to_owned();
    let made = task.rectification(RectifyMethod::Planar, reason, maps, size, scale, false);
    Ok((made.through(&views.views), StereoRig { calibration, rotations, is_exchanged }))
}

/// Returns the shift and the scale that fit both pictures into one frame with common rows and columns,
/// the size of the frame, and its reduction by the pixel limit.
fn placement(
    maps: &[Matrix3<f64>; 2],
    views: &ViewPair,
    limit: usize,
) -> Result<(Matrix3<f64>, Frame, f64), RectifyError> {
    let frames = views.frames();
    let quads = [corners(&maps[0], frames[0])?, corners(&maps[1], frames[1])?];
    let rows = quads.each_ref().map(|quad| Range::of(quad.iter().map(|p| p.y)));
    let rows = rows[0].common(&rows[1]).ok_or(RectifyError::NoCommonLines)?;
    let columns = Range::of(quads.iter().flatten().map(|p| p.x));
    let (frame, scale) = Extent { width: columns.length(), height: rows.length() }.limited(limit)?;
    Ok((scaling(scale, -columns.low * scale, -rows.low * scale), frame, scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{CameraModel, Lens, Radial, calibration};
    use crate::geometry::Frame;

    #[test]
    fn disparities_of_rectified_pictures_tell_depths() {
        let lens = Lens::perspective(Radial::polynomial(&[-0.1, 0.02]));
        let cameras = [
            CameraModel::new(&calibration([600.0, 605.0], [320.0, 240.0]), lens).unwrap(),
            CameraModel::new(&calibration([640.0; 2], [310.0, 250.0]), Lens::IDEAL).unwrap(),
        ];
        let frames = [Frame::new(640, 480); 2];
        let views = ViewPair::new([&cameras[0], &cameras[1]], frames).unwrap();
        for (position, is_exchanged) in
            [(Vector3::new(0.9, 0.1, 0.1), false), (Vector3::new(-0.8, 0.1, -0.2), true)]
        {
            let rotation = Rotation3::from_euler_angles(0.05, -0.1, 0.08);
            let position = position.normalize();
            let pose = RelativePose { rotation, translation: rotation * -position };
            let (made, rig) = rectify_calibrated(&pose, &views, &[], &Limits::default()).unwrap();
            assert_eq!(rig.is_exchanged, is_exchanged);
            let [left, right] = if is_exchanged { [1, 0] } else { [0, 1] };
            for scene in
                [Vector3::new(0.5, -0.3, 4.0), Vector3::new(-0.8, 0.6, 7.0), Vector3::new(0.2, 0.9, 5.0)]
            {
                let pixels = [
                    cameras[0].image_from_ray(&scene).unwrap(),
                    cameras[1].image_from_ray(&(rotation * scene + pose.translation)).unwrap(),
                ];
                let [a, b] = [left, right].map(|k| made.maps[k].rectified_from_original(pixels[k]).unwrap());
                assert!((a.y - b.y).abs() < 1e-6, "{a} {b}");
                let in_rig = rig.rotations[0] * scene;
                let depth = rig.calibration[(0, 0)] / (a.x - b.x);
                assert!((depth - in_rig.z).abs() < 1e-6, "{depth} {}", in_rig.z);
                let back = made.maps[left].original_from_rectified(a).unwrap();
                assert!((back - pixels[left]).norm() < 1e-6);
            }
        }
        let ahead = RelativePose { rotation: Rotation3::identity(), translation: -Vector3::z() };
        let refused = rectify_calibrated(&ahead, &views, &[], &Limits::default());
        assert!(matches!(refused, Err(RectifyError::Forward)));
    }
}
