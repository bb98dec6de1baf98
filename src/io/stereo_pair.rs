//! Rectified pairs in the layout of stereo programs: pictures without alpha, the calibration, the
//! left picture first.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use image::DynamicImage;
use nalgebra::{Matrix3, Vector3};

use super::identity::refuse_clashes;
use super::output::OutputFile;
use super::picture_file::{PictureFormat, encode_picture};
use super::rectified::{RectifiedError, create_folder};
use crate::camera::ViewPair;
use crate::geometry::Frame;
use crate::rectify::StereoRig;

named! {
    fn name;
    /// Program that a rectified pair is for.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum StereoProgram {
        /// OpenCV: `left.png`, `right.png`, `stereo.yml` with the names of `stereoRectify`.
        OpenCv = "opencv",
        /// RAFT-Stereo and other programs for the Middlebury sets: `im0.png`, `im1.png`, `calib.txt`.
        RaftStereo = "raft-stereo",
        /// `FoundationStereo`: `left.png`, `right.png`, `K.txt`.
        FoundationStereo = "foundation-stereo",
    }
}

impl StereoProgram {
    /// Returns the names of the left picture, the right picture and the calibration.
    pub fn files(self) -> [&'static str; 3] {
        match self {
            Self::OpenCv => ["left.png", "right.png", "stereo.yml"],
            Self::RaftStereo => ["im0.png", "im1.png", "calib.txt"],
            Self::FoundationStereo => ["left.png", "right.png", "K.txt"],
        }
    }
}

/// Rectified pair with everything that a stereo program asks for.
#[derive(Debug)]
pub struct StereoPair<'a> {
    /// Rectified cameras.
    pub rig: &'a StereoRig,
    /// Views before the rectification.
    pub views: &'a ViewPair,
    /// Length of the baseline in the unit of the calibration; `None` if unknown, which is written as
    /// 1.
    pub baseline: Option<f64>,
    /// Smallest and largest disparity of the matches, px.
    pub disparities: Option<[f64; 2]>,
}

/// Files of a pair for a stereo program, found writable.
#[derive(Debug)]
pub struct StereoPairFiles {
    program: StereoProgram,
    files: [OutputFile; 3],
}

impl StereoPairFiles {
    /// Creates the folder if necessary and checks, before the work, that all files can be written. None of
    /// `inputs` is replaced.
    pub fn prepare(folder: &Path, program: StereoProgram, inputs: &[&Path]) -> Result<Self, RectifiedError> {
        create_folder(folder)?;
        let [left, right, calibration] = program.files().map(|name| OutputFile::prepare(&folder.join(name)));
        let files = Self { program, files: [left?, right?, calibration?] };
        refuse_clashes(&files.paths(), inputs)?;
        Ok(files)
    }

    /// Writes the pair. `rectified` are the drawn pictures of image 1 and image 2.
    pub fn write(&self, pair: &StereoPair, rectified: [&DynamicImage; 2]) -> Result<(), RectifiedError> {
        let [first, second] = rectified;
        let ordered = if pair.rig.is_exchanged { [second, first] } else { [first, second] };
        let frame = Frame::new(first.width() as usize, first.height() as usize);
        let calibration = match self.program {
            StereoProgram::OpenCv => pair.opencv(frame),
            StereoProgram::RaftStereo => pair.middlebury(frame),
            StereoProgram::FoundationStereo => pair.numbers(),
        };
        let mut staged = Vec::new();
        for (file, picture) in self.files.iter().zip(ordered) {
            // The programs read three channels of 8 bits.
            staged.push(file.stage(&encode_picture(&picture.to_rgb8().into(), PictureFormat::Png)?)?);
        }
        staged.push(self.files[2].stage(calibration.as_bytes())?);
        for file in staged {
            file.put()?;
        }
        Ok(())
    }

    /// Returns the paths of all files.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.files.iter().map(|file| file.path().to_owned()).collect()
    }
}

impl StereoPair<'_> {
    fn length(&self) -> f64 {
        self.baseline.unwrap_or(1.0)
    }

    /// Returns `K` row by row and the baseline on a second line.
    fn numbers(&self) -> String {
        let rows: Vec<String> = self.rig.calibration.transpose().iter().map(f64::to_string).collect();
        format!("{}\n{}\n", rows.join(" "), self.length())
    }

    /// Returns the calibration file of the Middlebury sets.
    fn middlebury(&self, frame: Frame) -> String {
        let k = &self.rig.calibration;
        let (f, x, y) = (k[(0, 0)], k[(0, 2)], k[(1, 2)]);
        let Frame { width, height } = frame;
        let mut text = String::new();
        for camera in ["cam0", "cam1"] {
            let _ = writeln!(text, "{camera}=[{f} 0 {x}; 0 {f} {y}; 0 0 1]");
        }
        let _ = write!(text, "doffs=0\nbaseline={}\nwidth={width}\nheight={height}\n", self.length());
        let [low, high] = self.disparities.unwrap_or([0.0, width as f64 - 1.0]);
        let _ = write!(
            text,
            "ndisp={}\nvmin={}\nvmax={}\n",
            high.ceil().max(1.0) as usize + 1,
            low.floor().max(0.0),
            high.ceil()
        );
        text
    }

    /// Returns a calibration with the names of `cv2.stereoRectify`, left camera first.
    fn opencv(&self, frame: Frame) -> String {
        let [left, right] = if self.rig.is_exchanged { [1, 0] } else { [0, 1] };
        let calibrations = self.views.calibrations();
        let rotations = self.rig.rotations;
        let relative = rotations[right].inverse() * rotations[left];
        let k = &self.rig.calibration;
        let (f, x, y) = (k[(0, 0)], k[(0, 2)], k[(1, 2)]);
        let length = self.length();
        // The right camera is at +x of the left one in rectified coordinates.
        let translation: Vector3<f64> = rotations[right].inverse() * Vector3::new(-length, 0.0, 0.0);
        let projection = |shift: f64| vec![f, 0.0, x, shift, 0.0, f, y, 0.0, 0.0, 0.0, 1.0, 0.0];
        let rows = |m: &Matrix3<f64>| m.transpose().iter().copied().collect::<Vec<f64>>();
        let back = vec![1.0, 0.0, 0.0, -x, 0.0, 1.0, 0.0, -y, 0.0, 0.0, 0.0, f, 0.0, 0.0, 1.0 / length, 0.0];
        let Frame { width, height } = frame;
        let mut text = format!("%YAML:1.0\n---\nimage_width: {width}\nimage_height: {height}\n");
        let zero = vec![0.0; 5];
        for (name, columns, values) in [
            ("K1", 3, rows(&calibrations[left])),
            ("D1", 5, zero.clone()),
            ("K2", 3, rows(&calibrations[right])),
            ("D2", 5, zero),
            ("R", 3, rows(relative.matrix())),
            ("T", 1, translation.iter().copied().collect()),
            ("R1", 3, rows(rotations[left].matrix())),
            ("R2", 3, rows(rotations[right].matrix())),
            ("P1", 4, projection(0.0)),
            ("P2", 4, projection(-f * length)),
            ("Q", 4, back),
        ] {
            let numbers: Vec<String> = values.iter().map(|v| format!("{v:?}")).collect();
            let _ = write!(
                text,
                "{name}: !!opencv-matrix\n   rows: {}\n   cols: {columns}\n   dt: d\n   data: [ {} ]\n",
                values.len() / columns,
                numbers.join(", ")
            );
        }
        text
    }
}
