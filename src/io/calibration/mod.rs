//! Calibrations of cameras: lenses, and poses where the file has any.
//!
//! | written by | recognised by |
//! |---|---|
//! | OpenCV (YAML, XML, JSON), ROS, ORB-SLAM, VINS, `EuRoC`, NumPy (`.npz`), MATLAB (JSON) | names such as `K1`, `dist_coeffs_left`, `Camera.fx`: [`names`] |
//! | ROS (`ost.txt`) | `# oST version 5.0 parameters` |
//! | Kalibr (YAML) | `cam0: … intrinsics: …` |
//! | caliscope, anipose (TOML) | sections with `matrix` and `distortions` |
//! | ZED (`.conf`) | `[LEFT_CAM_HD]` |
//! | KITTI | `K_00: …`, or `P0: …` for rectified images |
//! | Middlebury | `cam0=[…]` |
//! | COLMAP (`cameras.txt`) | rows `ID MODEL WIDTH HEIGHT PARAMETERS` |
//!
//! A number without a known name is never left out in silence: [`CalibratedCamera::unread`] names it. Where it
//! may be the distortion of a lens, the file is refused.

mod cameras;
mod fields;
mod kalibr;
mod lens;
mod names;
mod posed;
#[cfg(test)]
mod properties;
mod rig;
mod size;
mod source;
mod tables;
#[cfg(test)]
mod tests;
mod two_models;
mod zed;

use std::path::Path;

use nalgebra::{Rotation3, Vector3};
use thiserror::Error;

use super::read::{ReadError, read_bytes};
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
    /// How the file was read.
    pub reading: CameraReading,
}

/// How the file of a camera was read, where a person should know it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CameraReading {
    /// Names of the numbers that were not understood.
    pub unread: Vec<String>,
    /// Clauses for people.
    pub notes: Vec<String>,
    /// The camera with its four distortion coefficients read as those of a fisheye, if the file leaves that
    /// open. [`CalibratedCamera::settled`] decides.
    pub fisheye: Option<CameraModel>,
    /// The same camera for pictures of other sizes.
    pub other_sizes: Vec<CalibratedCamera>,
    /// Whether the name does not tell if this is the first camera of the file.
    pub is_unplaced: bool,
}

/// Cameras of a file, in its order; at least one.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The cameras.
    pub cameras: Vec<CalibratedCamera>,
}

/// Reason why a file is no calibration, a clause.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub(super) enum NoCalibration {
    /// The file has no camera. It may have the pose of cameras in another file.
    #[error("{0}")]
    NoCamera(String),
    #[error("{0}")]
    Wrong(String),
}

impl Calibration {
    /// Reads a file; its content tells the format.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        Self::read_files(&[path])
    }

    /// Reads one or two files. Two files have a camera each, or the cameras and their pose.
    pub fn read_files(paths: &[&Path]) -> Result<Self, ReadError> {
        Self::found_in(paths)?.map_err(|problem| ReadError::content(paths[0], problem.to_string()))
    }

    /// Reads the cameras of an image pair from one or two files: those named, or the first two. The model of a lens
    /// may be open; [`CalibratedCamera::settled`] decides it by the images.
    pub fn read_pair(paths: &[&Path], names: Option<[&str; 2]>) -> Result<[CalibratedCamera; 2], ReadError> {
        let found = Self::read_files(paths)?.open_pair(names);
        found.map_err(|problem| ReadError::content(paths[0], problem))
    }

    /// Reads a file as [`Calibration::read`] does. `None` if the file names no camera.
    pub fn find(path: &Path) -> Option<Result<Self, ReadError>> {
        match Self::found_in(&[path]).ok()? {
            Ok(found) => Some(Ok(found)),
            Err(NoCalibration::NoCamera(_)) => None,
            Err(problem) => Some(Err(ReadError::content(path, problem.to_string()))),
        }
    }

    /// Reads files. The outer error is about files that are no named values at all.
    fn found_in(paths: &[&Path]) -> Result<Result<Self, NoCalibration>, ReadError> {
        let mut sources = Vec::new();
        for path in paths {
            let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
            let source = source::Source::of_bytes(read_bytes(path)?, stem.as_deref().unwrap_or_default());
            sources.push(source.map_err(|problem| ReadError::content(path, problem))?);
        }
        let mut found: Vec<_> = sources.iter().map(source::Source::cameras).collect();
        let lacks_cameras = |found: &Result<_, _>| matches!(found, Err(NoCalibration::NoCamera(_)));
        if paths.len() > 1 && found.iter().any(lacks_cameras) {
            let both =
                source::Source::merged(&sources).map_err(|problem| ReadError::content(paths[1], problem))?;
            found = both.map_or(found, |both| vec![both.cameras()]);
        }
        let mut files = Vec::new();
        for (found, path) in found.into_iter().zip(paths) {
            match found {
                Ok(cameras) => files.push(cameras),
                Err(problem) if files.is_empty() => return Ok(Err(problem)),
                Err(problem) => return Err(ReadError::content(path, problem.to_string())),
            }
        }
        Ok(Self::joined(&files).map_err(NoCalibration::Wrong))
    }

    /// Reads a text; its content tells the format.
    ///
    /// # Errors
    /// A clause for the user.
    pub fn parse(text: &str) -> Result<Self, String> {
        let cameras = source::Source::of_text(text)?.cameras().map_err(|problem| problem.to_string())?;
        Ok(Self { cameras })
    }

    /// Joins the cameras of several files: the first of each file comes first.
    fn joined(files: &[Vec<CalibratedCamera>]) -> Result<Self, String> {
        if let [first, second] = files
            && (first.len() > 1 || second.len() > 1)
            && first.len() != second.len()
        {
            return Err(format!(
                "one file has {} cameras and the other {}. Give one file for each camera, or one for both",
                first.len(),
                second.len()
            ));
        }
        let most = files.iter().map(Vec::len).max().unwrap_or(0);
        let cameras = (0..most).flat_map(|k| files.iter().filter_map(move |file| file.get(k).cloned()));
        Ok(Self { cameras: cameras.collect() })
    }

    /// Returns the two cameras of an image pair: those named, or the first two of the file. A file
    /// with a single camera describes both images.
    ///
    /// # Errors
    /// A clause for the user that names the cameras of the file, or asks for the model of a lens.
    pub fn pair(&self, names: Option<[&str; 2]>) -> Result<[CalibratedCamera; 2], String> {
        let pair = self.open_pair(names)?;
        CalibratedCamera::check_settled(&pair).map(|()| pair)
    }

    /// Returns the two cameras of an image pair as [`Calibration::pair`] does. The model of a lens may be open;
    /// [`CalibratedCamera::settled`] decides it by the images.
    ///
    /// # Errors
    /// A clause for the user that names the cameras of the file.
    pub fn open_pair(&self, names: Option<[&str; 2]>) -> Result<[CalibratedCamera; 2], String> {
        let Some(names) = names else {
            if self.cameras.iter().take(2).any(|camera| camera.reading.is_unplaced) {
                let known: Vec<_> = self.cameras.iter().map(|c| excerpt(&c.name)).collect();
                return Err(format!(
                    "the names of the cameras do not tell which is the left one: {}. Name both",
                    known.join(", ")
                ));
            }
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
    /// Returns what a person should know about how a pair was read, one sentence each.
    pub fn notes_of(pair: &[Self; 2]) -> Vec<String> {
        let [first, second] = pair.each_ref().map(|camera| &camera.reading);
        let mut unread = first.unread.clone();
        unread.extend(second.unread.iter().filter(|name| !first.unread.contains(name)).cloned());
        let mut sentences = Vec::new();
        if !unread.is_empty() {
            let (names, are) = (cameras::listed(&unread), if unread.len() == 1 { "was" } else { "were" });
            sentences.push(format!("{names} of the calibration {are} not understood and not used."));
        }
        let name = |k: usize| excerpt(&pair[k].name);
        for note in &first.notes {
            let of = if second.notes.contains(note) { "calibration".to_owned() } else { name(0) };
            sentences.push(format!("{of}: {note}."));
        }
        let others = second.notes.iter().filter(|note| !first.notes.contains(note));
        sentences.extend(others.map(|note| format!("{}: {note}.", name(1))));
        sentences
    }

    /// Says that a calibration has no pose of the second camera. The notes of its reading may tell why.
    pub fn without_pose(notes: &[String]) -> String {
        if notes.is_empty() {
            return "the calibration does not tell where the second camera is.".to_owned();
        }
        format!("the calibration has no pose of the second camera. {}", notes.join(" "))
    }

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
