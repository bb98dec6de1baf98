//! Calibrations of cameras: lenses, and poses where the file has any.
//!
//! | written by | recognised by |
//! |---|---|
//! | OpenCV (YAML, JSON), ROS | `K1`, `D1`, `K2`, `D2`, `R`, `T`, or `camera_matrix` and the like |
//! | Kalibr (YAML) | `cam0: … intrinsics: …` |
//! | caliscope, anipose (TOML) | sections with `matrix` and `distortions` |
//! | KITTI | `K_00: …`, or `P0: …` for rectified images |
//! | Middlebury | `cam0=[…]` |
//! | COLMAP (`cameras.txt`) | rows `ID MODEL WIDTH HEIGHT PARAMETERS` |

mod size;
mod tables;
#[cfg(test)]
mod tests;
mod tree;

use std::path::Path;

use nalgebra::{Rotation3, Vector3};

use super::geometry_file::yaml_value;
use super::number::rows;
use super::read::{ReadError, read_text};
use crate::camera::{Baseline, CameraModel, LengthUnit, RelativePose};
use crate::foreign::excerpt;
use crate::geometry::Frame;

/// Pose of a camera: `x = R X + t` in its coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPose {
    /// Rotation `R`.
    pub rotation: Rotation3<f64>,
    /// Translation `t` in the unit of the file.
    pub translation: Vector3<f64>,
}

/// A calibrated camera.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibratedCamera {
    /// Name in the file.
    pub name: String,
    /// Calibration matrix and lens.
    pub model: CameraModel,
    /// Size of its images, if the file has it.
    pub frame: Option<Frame>,
    /// Pose, if the file has it.
    pub pose: Option<CameraPose>,
    /// Unit of the pose; [`LengthUnit::Baseline`] if the file gives only its direction.
    pub unit: LengthUnit,
}

/// Cameras of a file, in its order; at least one.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The cameras.
    pub cameras: Vec<CalibratedCamera>,
}

impl Calibration {
    /// Reads a file; its content tells the format.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        Self::parse(&read_text(path)?).map_err(|problem| ReadError::content(path, problem))
    }

    /// Reads a text; its content tells the format.
    ///
    /// # Errors
    /// A clause for the user.
    pub fn parse(text: &str) -> Result<Self, String> {
        let first = rows(text).next().map_or("", |(_, row)| row);
        let cameras = if first.starts_with('{') {
            let value = serde_json::from_str(text).map_err(|e| format!("this is not valid JSON: {e}"))?;
            tree::cameras(&value)?
        } else if rows(text).any(|(_, row)| row.starts_with("cam0=[")) {
            tables::middlebury(text)?
        } else if tables::is_kitti(text) {
            tables::kitti(text)?
        } else if tables::is_colmap(first) {
            tables::colmap(text)?
        } else if first.starts_with('[') || rows(text).any(|(_, row)| is_section(row)) {
            let value =
                toml::from_str(text).map_err(|e| format!("this is not valid TOML: {}", e.message()))?;
            tree::cameras(&value)?
        } else {
            tree::cameras(&yaml_value(text).map_err(|problem| problem.problem)?)?
        };
        Ok(Self { cameras })
    }

    /// Returns the two cameras of an image pair: those named, or the first two of the file. A file
    /// with a single camera describes both images.
    ///
    /// # Errors
    /// A clause for the user that names the cameras of the file.
    pub fn pair(&self, names: Option<[&str; 2]>) -> Result<[CalibratedCamera; 2], String> {
        let Some(names) = names else {
            let first = &self.cameras[0];
            return Ok([first, self.cameras.get(1).unwrap_or(first)].map(CalibratedCamera::clone));
        };
        let find = |name: &str| {
            self.cameras.iter().find(|camera| camera.name == name).cloned().ok_or_else(|| {
                let known: Vec<_> = self.cameras.iter().map(|c| excerpt(&c.name)).collect();
                format!("there is no camera {}. The file has {}", excerpt(name), known.join(", "))
            })
        };
        Ok([find(names[0])?, find(names[1])?])
    }
}

impl CalibratedCamera {
    /// Returns the relative pose of two cameras and the length of the baseline in the unit of the
    /// file. `None` without poses, or for cameras at one place.
    pub fn relative_pose(pair: &[Self; 2]) -> Option<(RelativePose, f64)> {
        let [pose1, pose2] = [pair[0].pose?, pair[1].pose?];
        let rotation = pose2.rotation * pose1.rotation.inverse();
        let translation = pose2.translation - rotation * pose1.translation;
        let length = translation.norm();
        let is_apart = length > 1e-9 * (pose1.translation.norm() + pose2.translation.norm());
        is_apart.then(|| (RelativePose { rotation, translation: translation / length }, length))
    }

    /// Returns the distance between two cameras. `None` without poses, and if its length is
    /// unknown.
    pub fn baseline(pair: &[Self; 2]) -> Option<Baseline> {
        let unit = pair[0].unit;
        let (_, length) = Self::relative_pose(pair)?;
        let is_known = unit == pair[1].unit && unit != LengthUnit::Baseline;
        is_known.then_some(Baseline { length, unit })
    }
}

/// Returns whether a row opens a section of TOML.
fn is_section(row: &str) -> bool {
    row.starts_with('[') && row.ends_with(']') && row.chars().nth(1).is_some_and(char::is_alphabetic)
}
