//! Destinations of a result: text, JSON, and a file for another program.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::console::tell;
use super::geometry_file::GeometryOutput;
use super::output::Output;
use crate::camera::{Baseline, PicturesOf, PointCloud, PoseFit, UndistortedView, ViewPair};
use crate::estimate::{Estimate, Parameters, Uncertainty};
use crate::foreign::shown_path;
use crate::geometry::{Point, PointPair, median, sampson_distance};
use crate::image::Picture;
use crate::io::{
    CalibratedNote, Format, GeometryFile, ImageNote, PairLabel, PairOrigin, PointResultFile, ResultFile,
    TrustNote, UndistortedFiles, result_in_words,
};
use crate::presentation::{NO_BASELINE, pose_in_words, turn_in_words};
use crate::study::PoseOutcome;

/// Output options of a result.
#[derive(Debug, Args)]
pub(super) struct ResultArguments {
    /// Write the result as JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write F, the epipoles, the points and the matched patches for another program. If only a plane
    /// or a rotation of the camera is certain, its homography H21 is added. An .npz file has the
    /// covariances, a .ply file the triangulated matches of calibrated cameras
    #[arg(long, value_name = "FILE")]
    export: Option<PathBuf>,
    /// Format of the export, by default from the file extension
    #[arg(long, value_enum, requires = "export")]
    format: Option<Format>,
}

/// Outputs of a result, checked before the work.
pub(super) struct ResultOutput {
    output: Output,
    export: Option<GeometryOutput>,
    undistorted: Option<UndistortedFiles>,
}

/// Input of an estimate beside images and pairs.
#[derive(Clone, Copy, Default)]
pub(super) struct Beside<'a> {
    /// Time offset of two sequences.
    pub(super) offset: Option<i32>,
    /// Views of calibrated cameras.
    pub(super) views: Option<&'a ViewPair>,
    /// Distance between the cameras, if the calibration tells it.
    pub(super) baseline: Option<Baseline>,
    /// Matches from elsewhere.
    pub(super) given: &'a [PointPair],
    /// How the calibration was read.
    pub(super) calibration: &'a [String],
}

impl ResultArguments {
    /// Checks the outputs. Fails if one cannot be written, or would overwrite an input or the other
    /// output.
    pub(super) fn prepare(&self, inputs: &[&Path]) -> Result<ResultOutput, CliError> {
        let export = ("--export", self.export.as_deref(), self.format);
        let (output, export) = GeometryOutput::prepare_beside(self.json.as_deref(), export, inputs)?;
        Ok(ResultOutput { output, export, undistorted: None })
    }
}

impl ResultOutput {
    /// Adds a folder for the pictures without distortion. `has_lens` tells whether a lens is given.
    pub(super) fn with_undistorted(
        self,
        folder: Option<&Path>,
        has_lens: bool,
        inputs: &[&Path],
    ) -> Result<Self, CliError> {
        let Some(folder) = folder else { return Ok(self) };
        if !has_lens {
            return Err(no_distortion());
        }
        Ok(Self { undistorted: Some(UndistortedFiles::prepare(folder, inputs)?), ..self })
    }

    pub(super) fn write(
        self,
        found: &Estimate,
        pairs: &[PointPair],
        pictures: [&Picture; 2],
        parameters: &Parameters,
        beside: Beside,
    ) -> Result<(), CliError> {
        let Beside { offset, views, baseline, given, calibration } = beside;
        let matches = found.matched_pairs();
        let pictures_of = PicturesOf::from(views);
        let pose = views.map(|views| PoseOutcome::new(found, views));
        let lacks_depth =
            found.says_one_plane() && self.export.as_ref().is_some_and(GeometryOutput::is_cloud);
        if let Some(export) = self.export.filter(|_| !lacks_depth) {
            // Other programs would take the pose as certain.
            let pose = pose.as_ref().and_then(PoseOutcome::determined);
            let mut file = GeometryFile {
                covariance: found.uncertainty().map(Uncertainty::covariance),
                ..geometry_file(found, pairs, pictures, pictures_of.clone())
            };
            if let Some(views) = views {
                file = with_views(file, views, pose, baseline, &matches, |point| pictures[0].color_at(point));
            }
            export.write(&file)?;
        }
        if let Some(files) = &self.undistorted {
            if !pictures_of.is_undistorted() {
                let missing =
                    "there is no distortion to remove from the pictures, so --undistorted writes nothing";
                return Err(CliError::Arguments(missing.into()));
            }
            files.write(pictures, geometry_file(found, pairs, pictures, pictures_of.clone()))?;
            for path in files.paths() {
                tell(format_args!("wrote {}", shown_path(&path)));
            }
        }
        let images = pictures.map(ImageNote::from);
        let mut result = ResultFile::new(found, pairs, &images, parameters, &pictures_of)
            .at_offset(offset)
            .with_notes(calibration);
        let mut words = result_in_words(found, &images, &pictures_of);
        if !given.is_empty() {
            result = result.with_given(given);
            words += &given_in_words(found, given);
        }
        if let Some((views, pose)) = views.zip(pose.as_ref()) {
            result = result.calibrated(views, pose.fit(), baseline);
            words += &relative_pose_in_words(pose);
            words += &guess_in_words(views);
        }
        self.output.write(&result, &words)?;
        if lacks_depth { Err(CliError::NoDepth) } else { Ok(()) }
    }
}

impl ResultOutput {
    /// Writes a result of points without pictures. `file` makes the content of the export, which has no scene
    /// points if the epipole is not determined.
    pub(super) fn write_points(
        self,
        result: &PointResultFile,
        words: &str,
        is_open: bool,
        file: impl FnOnce() -> GeometryFile,
    ) -> Result<(), CliError> {
        let lacks_depth = is_open && self.export.as_ref().is_some_and(GeometryOutput::is_cloud);
        if let Some(export) = self.export.filter(|_| !lacks_depth) {
            export.write(&file())?;
        }
        self.output.write(result, words)?;
        if lacks_depth { Err(CliError::NoDepth) } else { Ok(()) }
    }
}

/// Describes the relative pose of the cameras; empty where a focal length is unknown.
pub(super) fn relative_pose_in_words(pose: &PoseOutcome) -> String {
    match pose {
        PoseOutcome::Determined(fit) => pose_in_words(fit),
        PoseOutcome::OpenEpipole(_) => format!("Relative pose: {NO_BASELINE}\n"),
        PoseOutcome::OnlyTurned(fit) => format!("Relative pose: {NO_BASELINE}\n{}", turn_in_words(&fit.pose)),
        PoseOutcome::TooFewMatches => "Relative pose: too few matches for one\n".to_owned(),
        PoseOutcome::NoFocalLengths => String::new(),
    }
}

/// Adds the cameras of views without distortion, and the scene points of the matches.
pub(super) fn with_views(
    file: GeometryFile,
    views: &ViewPair,
    pose: Option<&PoseFit>,
    baseline: Option<Baseline>,
    matches: &[PointPair],
    color: impl Fn(Point) -> [u8; 3],
) -> GeometryFile {
    let cloud = pose.map(|fit| {
        let cloud = PointCloud::new(&fit.pose, views, matches, color);
        match baseline {
            Some(baseline) => cloud.with_baseline(baseline),
            None => cloud,
        }
    });
    let mut file = GeometryFile { calibrated: Some(CalibratedNote::new(None)), cloud, ..file };
    if let Some(fit) = pose {
        file.add_cameras(views, fit);
    }
    file
}

fn no_distortion() -> CliError {
    let problem = "there is no distortion to remove from the pictures. Give their lens (--calibration, --division), or leave out \
                   --undistorted";
    CliError::Arguments(problem.into())
}

/// Describes how well matches from elsewhere fit the result.
fn given_in_words(found: &Estimate, given: &[PointPair]) -> String {
    let distances: Vec<f64> = given.iter().map(|pair| sampson_distance(found.fundamental(), pair)).collect();
    let near = distances.iter().filter(|distance| **distance < 1.0).count();
    format!(
        "Given matches: {near} of {} are within 1 px of their epipolar lines (median distance {:.2} px)\n",
        given.len(),
        median(distances)
    )
}

/// Describes guessed focal lengths; empty for a calibration.
fn guess_in_words(views: &ViewPair) -> String {
    let cameras = views.views.each_ref().map(UndistortedView::camera);
    let Some(deviation) = cameras.iter().filter_map(|camera| camera.focal_deviation()).find(|d| *d > 0.0)
    else {
        return String::new();
    };
    let [left, right] = cameras.map(|camera| camera.calibration()[(0, 0)]);
    format!(
        "Focal lengths guessed from EXIF data: {left:.0} and {right:.0} px ± {:.0} %. The ± of the pose includes \
         this error\n",
        100.0 * deviation
    )
}

/// Returns the content of the export: the clicks followed by the matches of the refinement. If the
/// epipoles are undetermined, it includes the homography.
fn geometry_file(
    found: &Estimate,
    pairs: &[PointPair],
    pictures: [&Picture; 2],
    pictures_of: PicturesOf,
) -> GeometryFile {
    let label = |origin| PairLabel { origin, ..PairLabel::default() };
    let given = pairs.iter().map(|_| label(PairOrigin::Clicked));
    let matched = found.matches().iter().map(|_| label(PairOrigin::Automatic));
    GeometryFile {
        fundamental: Some(*found.fundamental()),
        pairs: pairs.iter().copied().chain(found.matched_pairs()).collect(),
        labels: given.chain(matched).collect(),
        trust: TrustNote::of(found, pictures.map(Picture::frame)),
        images: Some(pictures.map(ImageNote::from)),
        homography21: found.assessment.plane.map(|plane| plane.homography21),
        ..GeometryFile::of(pictures_of)
    }
}
