//! Calibrated pairs: cameras from files, pictures without distortion.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{ArgGroup, Args};

use super::CliError;
use crate::camera::{CameraModel, FocalLength, LengthUnit, ViewPair};
use crate::estimate::Match;
use crate::foreign::shown_path;
use crate::geometry::PointPair;
use crate::image::Picture;
use crate::io::{CalibratedCamera, Calibration, focal_length_from_exif};

/// Cameras of both images.
#[derive(Debug, Args)]
pub(super) struct CalibrationArguments {
    /// Calibration of the cameras: one file for both images or one for each, of OpenCV, ROS, Kalibr,
    /// KITTI, Middlebury, COLMAP (cameras.txt), caliscope or anipose
    #[arg(long, num_args = 1..=2, value_name = "FILE")]
    calibration: Option<Vec<PathBuf>>,
    /// Names of the two cameras in the calibration, by default the first two
    #[arg(long, num_args = 2, value_names = ["LEFT", "RIGHT"], requires = "calibration")]
    camera_names: Option<Vec<String>>,
}

/// Cameras of both images, from a calibration or their focal lengths alone.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("known_cameras").args(["calibration", "focal_length"]))]
pub(super) struct CameraArguments {
    #[command(flatten)]
    calibration: CalibrationArguments,
    /// Focal length of both images or of each, in place of a calibration; "exif" guesses it from the data of
    /// a photograph. The principal point is taken to be in the middle, and the lens without distortion
    #[arg(long, num_args = 1..=2, value_name = "PX")]
    focal_length: Option<Vec<TypedFocal>>,
}

/// A focal length of the command line.
#[derive(Debug, Clone, Copy)]
enum TypedFocal {
    /// A typed one, px.
    Pixels(f64),
    /// That of the EXIF data.
    Exif,
}

impl FromStr for TypedFocal {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = text.parse().ok().filter(|focal: &f64| focal.is_finite() && *focal > 0.0);
        match number {
            Some(focal) => Ok(Self::Pixels(focal)),
            None if text == "exif" => Ok(Self::Exif),
            None => Err("a focal length is a positive number of pixels, or exif"),
        }
    }
}

/// Two calibrated cameras.
pub(super) struct CalibratedPair {
    pub(super) cameras: [CalibratedCamera; 2],
}

impl CalibrationArguments {
    /// Returns the files.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        self.calibration.iter().flatten().map(PathBuf::as_path)
    }

    /// Reads the calibration.
    pub(super) fn read(&self) -> Result<Option<CalibratedPair>, CliError> {
        let Some(files) = &self.calibration else { return Ok(None) };
        let names = match self.camera_names.as_deref() {
            Some([left, right]) => Some([left.as_str(), right.as_str()]),
            _ => None,
        };
        let pair = |path: &PathBuf| {
            let found = Calibration::read(path)?.pair(names);
            found.map_err(|e| CliError::Arguments(format!("{}: {e}", shown_path(path))))
        };
        let [first, second] = match &files[..] {
            [left, right] => [pair(left)?[0].clone(), pair(right)?[usize::from(names.is_some())].clone()],
            _ => pair(&files[0])?,
        };
        Ok(Some(CalibratedPair { cameras: [first, second] }))
    }
}

impl CameraArguments {
    /// Returns the files.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        self.calibration.files()
    }

    /// Reads the calibration.
    pub(super) fn read(&self) -> Result<Option<CalibratedPair>, CliError> {
        self.calibration.read()
    }

    /// Returns the calibrated cameras, or those of the given focal lengths.
    pub(super) fn of_pictures(
        &self,
        calibrated: Option<CalibratedPair>,
        pictures: &[Picture; 2],
    ) -> Result<Option<CalibratedPair>, CliError> {
        let Some(lengths) = &self.focal_length else { return Ok(calibrated) };
        let camera = |k: usize| -> Result<CalibratedCamera, CliError> {
            let (picture, side) = (&pictures[k], ["left", "right"][k]);
            let frame = picture.frame();
            let focal = match lengths[k.min(lengths.len() - 1)] {
                TypedFocal::Pixels(pixels) => Some(FocalLength { pixels, deviation: 0.0 }),
                TypedFocal::Exif => {
                    picture.path.as_deref().and_then(|path| focal_length_from_exif(path, frame))
                }
            };
            let model = focal.and_then(|focal| CameraModel::of_focal_length(focal, frame));
            let untold = || {
                CliError::Arguments(format!(
                    "the EXIF data of the {side} image do not tell its focal length. Give it in pixels \
                     (--focal-length PX)"
                ))
            };
            Ok(CalibratedCamera {
                name: side.to_owned(),
                model: model.ok_or_else(untold)?,
                frame: Some(frame),
                pose: None,
                unit: LengthUnit::Baseline,
            })
        };
        Ok(Some(CalibratedPair { cameras: [camera(0)?, camera(1)?] }))
    }
}

impl CalibratedPair {
    /// Plans the views without distortion, after checking the sizes of the pictures.
    pub(super) fn views(&self, pictures: &[Picture; 2]) -> Result<ViewPair, CliError> {
        for (camera, picture) in self.cameras.iter().zip(pictures) {
            camera.check_frame(picture.frame()).map_err(CliError::Arguments)?;
        }
        let views = ViewPair::new(
            [&self.cameras[0].model, &self.cameras[1].model],
            [pictures[0].frame(), pictures[1].frame()],
        );
        let problem = "the distortion of the lens cannot be undone: it folds back at the principal point";
        views.ok_or_else(|| CliError::Arguments(problem.into()))
    }
}

/// Draws the pictures without distortion.
pub(super) fn undistorted(pictures: [Picture; 2], views: &ViewPair) -> [Picture; 2] {
    let mut views = views.views.iter();
    pictures.map(|picture| match views.next() {
        Some(view) if !view.is_original() => picture.redrawn(view.frame(), |p| view.source_of(p)),
        _ => picture,
    })
}

/// Returns the places of point pairs in the views.
pub(super) fn undistorted_pairs(pairs: &[PointPair], views: &ViewPair) -> Result<Vec<PointPair>, CliError> {
    let place = |(k, pair): (usize, &PointPair)| {
        views.undistorted_from_original(pair).ok_or_else(|| {
            CliError::Arguments(format!(
                "pair {} lies where the distortion of the lens has no inverse. Use points nearer to the middle",
                k + 1
            ))
        })
    };
    pairs.iter().enumerate().map(place).collect()
}

/// Moves matches from elsewhere to their places in the views. Those beyond the range of a lens are left
/// out.
pub(super) fn undistort_matches(matches: &mut Option<Vec<Match>>, views: &ViewPair) -> Result<(), CliError> {
    let Some(all) = matches else { return Ok(()) };
    let moved = |found: &Match| Some(Match { pair: views.undistorted_from_original(&found.pair)?, ..*found });
    *all = all.iter().filter_map(moved).collect();
    if all.is_empty() {
        return Err(CliError::Arguments(
            "all matches lie where the distortion of the lens has no inverse".into(),
        ));
    }
    Ok(())
}
