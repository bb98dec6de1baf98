//! Calibrated pairs: cameras from files, pictures without distortion.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{ArgGroup, Args};

use super::CliError;
use super::arguments::size;
use super::console::tell;
use crate::camera::{FocalLength, LengthUnit, ViewPair};
use crate::estimate::Match;
use crate::geometry::{Frame, PointPair};
use crate::image::Picture;
use crate::io::{CalibratedCamera, Calibration, CameraReading, focal_length_from_exif};
use crate::presentation::camera_doubts;
use crate::study::{Study, assumed_camera, plan_views};

/// Cameras of both images.
#[derive(Debug, Args)]
pub(super) struct CalibrationArguments {
    /// Calibration of the cameras: one file for both images, one for each, or one with the cameras and one
    /// with their pose. OpenCV, ROS, Kalibr, KITTI, Middlebury, COLMAP (cameras.txt), ZED, MATLAB (JSON),
    /// ORB-SLAM, VINS, caliscope, anipose and NumPy (.npz) write such files
    #[arg(long, num_args = 1..=2, value_name = "FILE")]
    calibration: Option<Vec<PathBuf>>,
    /// Names of the two cameras in the calibration, by default the first two
    #[arg(long, num_args = 2, value_names = ["LEFT", "RIGHT"], requires = "calibration")]
    camera_names: Option<Vec<String>>,
    /// Scale the calibration to the size of the images. Give the size of the images that it is for, if the
    /// file does not tell it
    #[arg(
        long, value_name = "WIDTHxHEIGHT", requires = "calibration", value_parser = own_size, num_args = 0..=1,
        require_equals = true, default_missing_value = ""
    )]
    scale_calibration: Option<OwnSize>,
}

/// Size of the images that a calibration is for; `None` if the file tells it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct OwnSize(Option<Frame>);

/// Parses a size, or nothing.
fn own_size(text: &str) -> Result<OwnSize, String> {
    if text.is_empty() { Ok(OwnSize(None)) } else { Ok(OwnSize(Some(size(text)?))) }
}

/// Cameras of both images, from a calibration or their focal lengths alone.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("known_cameras").args(["calibration", "focal_length"]))]
pub(super) struct CameraArguments {
    #[command(flatten)]
    pub(super) calibration: CalibrationArguments,
    /// Focal length of both images or of each, in place of a calibration; "exif" guesses it from the data of
    /// a photograph. The principal point is taken to be in the middle
    #[arg(long, num_args = 1..=2, value_name = "PX")]
    focal_length: Option<Vec<TypedFocal>>,
    /// Radial distortion without a calibration, for both images or for each: λ of the division model. Radii
    /// are in half diagonals, and barrel distortion is negative. "auto" fits λ to the matches
    #[arg(
        long, num_args = 1..=2, value_name = "LAMBDA", conflicts_with = "calibration",
        allow_negative_numbers = true
    )]
    division: Option<Vec<TypedDivision>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum TypedDivision {
    /// λ of the division model.
    Lambda(f64),
    /// λ fitted to the matches.
    Auto,
}

impl FromStr for TypedDivision {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.parse() {
            Ok(lambda) if (-0.9..=0.9).contains(&lambda) => Ok(Self::Lambda(lambda)),
            _ if text == "auto" => Ok(Self::Auto),
            _ => Err("a coefficient is a number from -0.9 to 0.9, or auto"),
        }
    }
}

#[derive(Debug, Clone, Copy)]
enum TypedFocal {
    Pixels(f64),
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

impl CalibrationArguments {
    /// Returns the arguments for two files.
    pub(super) fn of_files(files: [&Path; 2]) -> Self {
        let calibration = Some(files.map(Path::to_owned).to_vec());
        Self { calibration, camera_names: None, scale_calibration: None }
    }

    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        self.calibration.iter().flatten().map(PathBuf::as_path)
    }

    pub(super) fn read(&self) -> Result<Option<[CalibratedCamera; 2]>, CliError> {
        let Some(files) = &self.calibration else { return Ok(None) };
        let names = match self.camera_names.as_deref() {
            Some([left, right]) => Some([left.as_str(), right.as_str()]),
            _ => None,
        };
        let paths: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
        let pair = Calibration::read_pair(&paths, names)?;
        tell_notes(&CalibratedCamera::notes_of(&pair));
        Ok(Some(pair))
    }
}

impl CalibrationArguments {
    /// Returns the cameras scaled to images of these sizes, if that is asked for.
    pub(super) fn scaled(
        &self,
        mut cameras: [CalibratedCamera; 2],
        frames: Option<[Frame; 2]>,
    ) -> Result<[CalibratedCamera; 2], CliError> {
        let Some(OwnSize(own)) = self.scale_calibration else { return Ok(cameras) };
        let unknown =
            "the sizes of the images are needed to scale the calibration. Give the images (--images)";
        let frames = frames.ok_or_else(|| CliError::Arguments(unknown.into()))?;
        for (camera, frame) in cameras.iter_mut().zip(frames) {
            camera.frame = own.or(camera.frame);
            let advice = match camera.frame {
                None => ". Give it: --scale-calibration=WIDTHxHEIGHT",
                Some(_) => "",
            };
            let told = |problem| CliError::Arguments(format!("{problem}{advice}"));
            *camera = camera.resized_to(frame).map_err(told)?;
        }
        Ok(cameras)
    }
}

fn tell_notes(notes: &[String]) {
    for note in notes {
        tell(note);
    }
}

/// Chooses the cameras for the sizes of the pictures, and the models of their lenses where the file leaves
/// these open: by given matches, or by matches of the pictures that are found without a geometry.
pub(super) fn settled(
    cameras: [CalibratedCamera; 2],
    study: &Study,
    given: Option<&[Match]>,
) -> Result<[CalibratedCamera; 2], CliError> {
    let pairs = || match given {
        Some(given) => given.iter().map(|found| found.pair).collect(),
        None => study.putative_pairs(),
    };
    settled_by(cameras, study.frames(), pairs)
}

/// Chooses the cameras as [`settled`] does, by point pairs.
pub(super) fn settled_by(
    cameras: [CalibratedCamera; 2],
    frames: [Frame; 2],
    pairs: impl FnOnce() -> Vec<PointPair>,
) -> Result<[CalibratedCamera; 2], CliError> {
    let before = CalibratedCamera::notes_of(&cameras);
    let settled = CalibratedCamera::settled(cameras, frames, pairs).map_err(CliError::Arguments)?;
    let mut notes = CalibratedCamera::notes_of(&settled);
    notes.retain(|note| !before.contains(note));
    tell_notes(&notes);
    Ok(settled)
}

impl CameraArguments {
    pub(super) fn is_given(&self) -> bool {
        self.calibration.calibration.is_some() || self.focal_length.is_some() || self.division.is_some()
    }

    /// Returns whether the distortion is to be fitted to the matches.
    pub(super) fn fits_lens(&self) -> bool {
        self.division.iter().flatten().any(|division| *division == TypedDivision::Auto)
    }

    /// Returns whether a focal length is to be read from a photograph.
    pub(super) fn asks_for_exif(&self) -> bool {
        self.focal_length.iter().flatten().any(|focal| matches!(focal, TypedFocal::Exif))
    }

    /// Returns the calibrated cameras, or cameras of the given focal lengths and distortion. `fitted` is the
    /// distortion of each image that was fitted to the matches.
    pub(super) fn of_pictures(
        &self,
        calibrated: Option<[CalibratedCamera; 2]>,
        pictures: [&Picture; 2],
        fitted: Option<[f64; 2]>,
    ) -> Result<Option<[CalibratedCamera; 2]>, CliError> {
        let files = pictures.map(|picture| picture.path.as_deref());
        self.of_frames(calibrated, pictures.map(Picture::frame), files, fitted)
    }

    /// Returns the cameras as [`Self::of_pictures`], of images of these sizes, of which there may be files.
    pub(super) fn of_frames(
        &self,
        calibrated: Option<[CalibratedCamera; 2]>,
        frames: [Frame; 2],
        files: [Option<&Path>; 2],
        fitted: Option<[f64; 2]>,
    ) -> Result<Option<[CalibratedCamera; 2]>, CliError> {
        if let Some(calibrated) = calibrated {
            return self.calibration.scaled(calibrated, Some(frames)).map(Some);
        }
        let camera = |k: usize| -> Result<Option<CalibratedCamera>, CliError> {
            let frame = frames[k];
            let lambda = match of_image(self.division.as_deref(), k) {
                Some(TypedDivision::Lambda(lambda)) => Some(lambda),
                Some(TypedDivision::Auto) => fitted.map(|lambdas| lambdas[k]),
                None => None,
            };
            let model = assumed_camera(lambda, self.focal_length(files[k], frame, k)?, frame);
            let name = SIDES[k].to_owned();
            let (frame, unit) = (Some(frame), LengthUnit::Baseline);
            let reading = CameraReading::default();
            Ok(model.map(|model| CalibratedCamera { name, model, frame, pose: None, unit, reading }))
        };
        Ok(camera(0)?.zip(camera(1)?).map(<[_; 2]>::from))
    }

    /// Returns the given focal length of an image, 0 or 1.
    fn focal_length(
        &self,
        file: Option<&Path>,
        frame: Frame,
        image: usize,
    ) -> Result<Option<FocalLength>, CliError> {
        let side = SIDES[image];
        match of_image(self.focal_length.as_deref(), image) {
            None => Ok(None),
            Some(TypedFocal::Pixels(pixels)) => Ok(Some(FocalLength { pixels, deviation: 0.0 })),
            Some(TypedFocal::Exif) => {
                let guess = file.and_then(|path| focal_length_from_exif(path, frame));
                guess.map(Some).ok_or_else(|| {
                    CliError::Arguments(format!(
                        "the EXIF data of the {side} image do not tell its focal length. Give it in pixels \
                         (--focal-length PX)"
                    ))
                })
            }
        }
    }
}

const SIDES: [&str; 2] = ["left", "right"];

/// Returns the value of an image, given one for both or one for each.
fn of_image<T: Copy>(values: Option<&[T]>, image: usize) -> Option<T> {
    let values = values?;
    values.get(image).or(values.first()).copied()
}

/// Plans the views without distortion, and tells doubts about the cameras.
pub(super) fn views(cameras: &[CalibratedCamera; 2], frames: [Frame; 2]) -> Result<ViewPair, CliError> {
    CalibratedCamera::check_settled(cameras).map_err(CliError::Arguments)?;
    for (camera, frame) in cameras.iter().zip(frames) {
        let is_resized = camera.is_resized_in(frame);
        let advice = if is_resized { ". If the image was resized, use --scale-calibration" } else { "" };
        let told = |problem| CliError::Arguments(format!("{problem}{advice}"));
        camera.check_frame(frame).map_err(told)?;
    }
    let views = plan_views(cameras.each_ref().map(|camera| &camera.model), frames)?;
    for (_, message) in camera_doubts([0, 1].map(|k| (&cameras[k].model, frames[k]))) {
        tell(format_args!("warning: {message}"));
    }
    Ok(views)
}
