//! `epiline judge`: whether a geometry from elsewhere fits two images.

use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use serde::Serialize;

use super::CliError;
use super::arguments::{ImagePair, on_threads, pixels, threads};
use super::calibration::{CalibrationArguments, undistort_matches, undistorted, views};
use super::estimate::watched;
use super::geometry_file::{read_geometry, read_matches};
use super::output::Output;
use crate::camera::{PicturesOf, PoseDifference, RelativePose, ViewPair};
use crate::estimate::{Match, Monitor, Parameters, Uncertainty, Verdict, estimate, estimate_fundamental};
use crate::foreign::{reason, shown_path};
use crate::geometry::{Frame, FundamentalMatrix, Matrix9, PointPair};
use crate::image::Picture;
use crate::io::{CalibratedCamera, GeometryFile, refuse_clashes};
use crate::judge::{
    FEWEST_MATCHES, Finding, GivenGeometry, Judgement, LIMIT, ROW_LIMIT, Reference, RowJudgement, judge,
    judge_rows,
};
use crate::presentation::{NO_BASELINE, judgement_in_words, pose_difference_in_words, rows_in_words};

/// Judge whether a geometry from elsewhere fits two images, or whether they are rectified
///
/// The geometry is a matrix, two cameras, or a stereo calibration with lenses (--calibration). The
/// command estimates the geometry of the images without clicks, and compares the epipolar lines of
/// both geometries at the matches. If they differ, it looks for the simplest change after which the
/// geometry fits: another convention; resized, cropped, mirrored or turned images; mistakes with
/// cameras; missing lens distortion. The exit status is 0 if it fits, 1 if it does not, and 2 for bad
/// input or images that do not show enough.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("judged").required(true).args(["fundamental", "cameras", "rectified", "calibration"]))]
pub(super) struct JudgeArguments {
    #[command(flatten)]
    images: ImagePair,
    /// File with F or two cameras, in any format
    #[arg(long, value_name = "FILE")]
    fundamental: Option<PathBuf>,
    /// The two cameras: one file with both, or one file for each (.P)
    #[arg(long, num_args = 1..=2, value_name = "FILE")]
    cameras: Option<Vec<PathBuf>>,
    #[command(flatten)]
    calibration: CalibrationArguments,
    /// Judge whether the images are rectified: whether matching points lie in the same row
    #[arg(long)]
    rectified: bool,
    /// Matches to judge by, instead of the matches that the program finds
    #[arg(long, value_name = "FILE")]
    matches: Option<PathBuf>,
    /// Largest median distance between the epipolar lines of a geometry that fits, px, by default 1.
    /// With --rectified: largest typical difference of rows, by default 0.5
    #[arg(long, value_name = "PX", value_parser = pixels)]
    limit: Option<f64>,
    /// Write the judgement as JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// With --rectified, add a line to a CSV file, which shows how a pair of cameras drifts
    #[arg(long, value_name = "FILE", requires = "rectified")]
    log: Option<PathBuf>,
    /// Random seed; the same seed gives the same judgement
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Number of threads, by default one per core
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
}

/// Content of the JSON file.
#[derive(Serialize)]
struct JudgeFile<'a, T: Serialize> {
    message: &'a str,
    #[serde(flatten)]
    judgement: &'a T,
    /// Difference between the judged calibration and the pose that fits the matches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pose_difference: Option<PoseDifference>,
    reference: FundamentalMatrix,
    /// Pictures that the reference belongs to.
    #[serde(flatten)]
    pictures: &'a PicturesOf,
    /// Verdict on the reference; null for given matches.
    reference_verdict: Option<Verdict>,
    version: &'static str,
}

/// Geometry that the images show.
struct Shown {
    fundamental: FundamentalMatrix,
    matches: Vec<PointPair>,
    /// Whether the matches can refute a geometry. True for matches that a person gives.
    is_trusted: bool,
    /// Whether the verdict leaves the epipole open, and with it the pose.
    is_open: bool,
    verdict: Option<Verdict>,
    covariance: Option<Matrix9>,
}

/// Judges, writes the files and prints a sentence.
pub(super) fn run(arguments: &JudgeArguments) -> Result<(), CliError> {
    let output = Output::prepare(arguments.json.as_deref())?;
    let outputs: Vec<&Path> = output.file().into_iter().chain(arguments.log.as_deref()).collect();
    let inputs: Vec<&Path> = arguments.images.files().chain(arguments.files()).collect();
    refuse_clashes(&outputs, &inputs)?;
    arguments.log.as_deref().map(check_log).transpose()?;
    let calibrated = arguments.calibration.read()?;
    let (mut given, own_covariance) = arguments.given()?.unzip();
    let mut matches = arguments.matches.as_deref().map(read_matches).transpose()?;
    let (mut pictures, _) = arguments.images.load()?;
    let mut stereo = None;
    if let Some(calibrated) = calibrated {
        let (pose, _) = CalibratedCamera::relative_pose(&calibrated).ok_or_else(no_pose)?;
        let views = views(&calibrated, &pictures)?;
        undistort_matches(&mut matches, &views)?;
        pictures = undistorted(pictures, &views);
        given = Some(of_pose(&pose, &views).ok_or_else(no_pose)?);
        stereo = Some((pose, views));
    }
    let pictures_of = PicturesOf::from(stereo.as_ref().map(|(_, views)| views));
    let frames = pictures.each_ref().map(Picture::frame);
    let shown = match matches {
        Some(matches) => of_matches(&matches, frames, arguments.seed)?,
        None => of_images(&pictures, arguments)?,
    };
    let too_few = || {
        let found = shown.matches.len();
        CliError::Arguments(if arguments.matches.is_some() {
            format!("only {found} of the matches agree on a geometry, and a judgement needs {FEWEST_MATCHES}")
        } else {
            format!(
                "the images show only {found} matches, and a judgement needs {FEWEST_MATCHES}. Give matches of \
                 your own (--matches)"
            )
        })
    };
    let Some(given) = given else {
        let limit = arguments.limit.unwrap_or(ROW_LIMIT);
        let found = judge_rows(&shown.matches, frames[1], limit).ok_or_else(too_few)?;
        let words = rows_in_words(&found);
        write(&output, &found, &words, None, (&shown, &pictures_of))?;
        if let Some(log) = &arguments.log {
            append(log, &pictures, &found)?;
        }
        return if found.is_aligned { Ok(()) } else { Err(CliError::NotRectified) };
    };
    let Shown { fundamental, matches, is_trusted, is_open, covariance, .. } = &shown;
    let (fundamental, is_trusted) = (*fundamental, *is_trusted);
    // Both geometries may be uncertain; without a covariance, the judged one counts as exact.
    let covariance =
        covariance.map(|covariance| covariance + own_covariance.flatten().unwrap_or_else(Matrix9::zeros));
    let reference = Reference { fundamental, matches, frames, is_trusted, covariance };
    let found: Judgement = judge(&given, &reference, arguments.limit.unwrap_or(LIMIT)).ok_or_else(too_few)?;
    let mut words = judgement_in_words(&found);
    let is_calibrated = stereo.is_some();
    let difference = stereo.filter(|_| !is_open).and_then(|(pose, views)| {
        let fit = views.fit_pose(&fundamental, matches)?;
        // Without parallax the matches determine no pose.
        fit.difference(&pose).filter(|_| is_trusted)
    });
    if let Some(difference) = &difference {
        words = format!("{words}\n{}", pose_difference_in_words(difference));
    } else if is_calibrated && *is_open {
        words = format!("{words}\nThe pose cannot be judged. {NO_BASELINE}");
    }
    write(&output, &found, &words, difference, (&shown, &pictures_of))?;
    match found.finding {
        Finding::Fits => Ok(()),
        Finding::DoesNotFit => Err(CliError::DoesNotFit),
        Finding::Undecided => Err(CliError::Undecided),
    }
}

impl JudgeArguments {
    /// Returns the input files beside the images.
    fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.fundamental.iter().chain(self.cameras.iter().flatten()).chain(&self.matches);
        files.map(PathBuf::as_path).chain(self.calibration.files())
    }

    /// Reads the geometry, and its covariance if the file has one. `None` for a calibration or
    /// rectified images.
    fn given(&self) -> Result<Option<(GivenGeometry, Option<Matrix9>)>, CliError> {
        let files: Vec<&Path> =
            self.fundamental.iter().chain(self.cameras.iter().flatten()).map(PathBuf::as_path).collect();
        let (fundamental, file) = match files[..] {
            [left, right] => GeometryFile::read_cameras([left, right])?,
            [one, ..] => read_geometry(one)?,
            [] => return Ok(None),
        };
        if self.cameras.is_some() && file.cameras.is_none() {
            return Err(CliError::Arguments(
                "there are no two cameras in the file (P1 and P2). Use --fundamental for a matrix".into(),
            ));
        }
        Ok(Some((GivenGeometry { fundamental, cameras: file.cameras }, file.covariance)))
    }
}

/// Estimates the geometry of the images without clicks.
fn of_images(pictures: &[Picture; 2], arguments: &JudgeArguments) -> Result<Shown, CliError> {
    let parameters = Parameters { seed: arguments.seed, ..Parameters::default() };
    let [left, right] = pictures;
    let compute = |monitor: &Monitor| estimate(&left.gray, &right.gray, &[], &parameters, monitor);
    let found = on_threads(arguments.threads, || watched(compute))??;
    Ok(Shown {
        fundamental: *found.fundamental(),
        matches: found.matched_pairs(),
        is_trusted: found.may_contradict(),
        is_open: found.says_one_plane(),
        verdict: found.assessment.trust.as_ref().map(|trust| trust.verdict),
        covariance: found.uncertainty().map(Uncertainty::covariance),
    })
}

/// Fits a geometry to given matches.
fn of_matches(matches: &[Match], frames: [Frame; 2], seed: u64) -> Result<Shown, CliError> {
    let fit = estimate_fundamental(matches, frames, seed)
        .map_err(|error| CliError::Arguments(format!("the matches cannot be used: {error}")))?;
    let right = matches.iter().zip(&fit.inlier_probabilities).filter(|(_, right)| **right > 0.5);
    let matches = right.map(|(found, _)| found.pair).collect();
    let covariance = fit.uncertainty.as_ref().map(Uncertainty::covariance);
    let fundamental = fit.fundamental;
    Ok(Shown { fundamental, matches, is_trusted: true, is_open: false, verdict: None, covariance })
}

/// Returns the geometry of a calibration in the views without distortion.
fn of_pose(pose: &RelativePose, views: &ViewPair) -> Option<GivenGeometry> {
    let fundamental = pose.fundamental(&views.calibrations())?;
    Some(GivenGeometry { fundamental, cameras: Some(views.posed(pose)?) })
}

fn no_pose() -> CliError {
    CliError::Arguments(
        "the calibration does not tell where the second camera is. To judge a matrix, use --fundamental"
            .into(),
    )
}

fn write(
    output: &Output,
    judgement: &impl Serialize,
    words: &str,
    pose_difference: Option<PoseDifference>,
    (shown, pictures): (&Shown, &PicturesOf),
) -> Result<(), CliError> {
    let file = JudgeFile {
        message: words,
        judgement,
        pose_difference,
        reference: shown.fundamental,
        pictures,
        reference_verdict: shown.verdict,
        version: env!("CARGO_PKG_VERSION"),
    };
    output.write(&file, &format!("{words}\n"))
}

/// Names of the columns, the first line of a log.
const COLUMNS: &str =
    "left,right,matches,constant_px,across_px,down_px,curved_px,typical_px,largest_px,rectified";

/// Refuses a file that is no log, before the work. Nothing is added to other files.
fn check_log(log: &Path) -> Result<(), CliError> {
    match std::fs::read_to_string(log) {
        Ok(text) if text.is_empty() || text.lines().next() == Some(COLUMNS) => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Ok(_) => Err(CliError::Arguments(format!(
            "{} is not a log of this command. Name a new file",
            shown_path(log)
        ))),
        Err(error) => {
            Err(CliError::Arguments(format!("cannot read {}: {}", shown_path(log), reason(&error))))
        }
    }
}

/// Adds a line to the log, which begins with the names of the columns.
fn append(log: &Path, pictures: &[Picture; 2], found: &RowJudgement) -> Result<(), CliError> {
    let failed = |error: std::io::Error| {
        CliError::Arguments(format!("cannot write {}: {}", shown_path(log), reason(&error)))
    };
    let mut file = OpenOptions::new().create(true).append(true).open(log).map_err(failed)?;
    let mut text = String::new();
    if file.metadata().map_err(failed)?.len() == 0 {
        let _ = writeln!(text, "{COLUMNS}");
    }
    let quoted = |name: &str| format!("\"{}\"", name.replace('"', "\"\""));
    let [left, right] = pictures.each_ref().map(|picture| quoted(&picture.name));
    let RowJudgement { matches, constant, across, down, curved, typical, largest, is_aligned, .. } = found;
    let _ = writeln!(
        text,
        "{left},{right},{matches},{constant:.4},{across:.4},{down:.4},{curved:.4},{typical:.4},{largest:.4},{is_aligned}"
    );
    file.write_all(text.as_bytes()).map_err(failed)
}
