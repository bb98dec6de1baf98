//! `epiline judge`: whether a geometry from elsewhere fits two images.

use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use serde::Serialize;

use super::CliError;
use super::arguments::{ImagePair, on_threads, pixels, threads};
use super::calibration::{CalibrationArguments, settled, views};
use super::estimate::watched;
use super::geometry_file::{read_geometry, read_matches, tell_remarks};
use super::output::Output;
use crate::camera::{PicturesOf, PoseDifference};
use crate::estimate::{Parameters, Verdict};
use crate::foreign::{reason, shown_path};
use crate::geometry::{FundamentalMatrix, Matrix9};
use crate::image::Picture;
use crate::io::{CalibratedCamera, GeometryFile, refuse_clashes};
use crate::judge::{
    FEWEST_MATCHES, Finding, GivenCalibration, GivenGeometry, LIMIT, ROW_LIMIT, RowJudgement, judge_rows,
};
use crate::presentation::{judgement_in_words, pose_difference_in_words, rows_in_words};
use crate::study::{Question, ShownGeometry, Study, matches_in};

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
    /// How the calibration was read, and the numbers of it that were not understood.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    calibration_notes: &'a [String],
    version: &'static str,
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
    let mut study = Study::of_pictures(arguments.images.load()?.0);
    let mut stereo = None;
    let mut notes = Vec::new();
    if let Some(calibrated) = calibrated {
        let calibrated = arguments.calibration.scaled(calibrated, Some(study.frames()))?;
        let calibrated = settled(calibrated, &study, matches.as_deref())?;
        notes = CalibratedCamera::notes_of(&calibrated);
        let (pose, _) = CalibratedCamera::relative_pose(&calibrated).ok_or_else(|| no_pose(&notes))?;
        let views = views(&calibrated, study.frames())?;
        matches = matches.map(|matches| matches_in(&views, &matches)).transpose()?;
        // The cameras are judged, so they take no part in the search.
        study = study.with_views(views).drawn_in(None);
        let calibration = GivenCalibration { pose, views };
        given = Some(calibration.geometry().ok_or_else(|| no_pose(&notes))?);
        stereo = Some(calibration);
    }
    let pictures_of = PicturesOf::from(stereo.as_ref().map(|calibration| &calibration.views));
    let frames = study.frames();
    let search = |seed: u64| match &matches {
        Some(matches) => ShownGeometry::of_matches(matches, frames, seed)
            .map_err(|error| CliError::Arguments(format!("the matches cannot be used: {error}"))),
        None => of_images(&study, arguments, seed),
    };
    let shown = search(arguments.seed)?;
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
    let beside = Beside { shown: &shown, pictures: &pictures_of, notes: &notes };
    let Some(given) = given else {
        let limit = arguments.limit.unwrap_or(ROW_LIMIT);
        let found = judge_rows(&shown.rows(), frames[1], limit).ok_or_else(too_few)?;
        let words = rows_in_words(&found);
        write(&output, &found, &words, None, &beside)?;
        if let Some(log) = &arguments.log {
            append(log, study.pictures(), &found)?;
        }
        return match (found.is_aligned, found.doubt) {
            (true, _) => Ok(()),
            (false, None) => Err(CliError::NotRectified),
            (false, Some(_)) => Err(CliError::RowsUndecided),
        };
    };
    let limit = arguments.limit.unwrap_or(LIMIT);
    let own_covariance = own_covariance.flatten();
    let again = || search(arguments.seed.wrapping_add(1));
    let found = shown.judged((&given, own_covariance.as_ref()), frames, limit, again)?;
    let found = found.ok_or_else(too_few)?;
    let mut words = judgement_in_words(&found);
    let compared = stereo.as_ref().and_then(|calibration| shown.compared_pose(&found, calibration));
    if let Some(compared) = &compared {
        words = format!("{words}\n{}", pose_difference_in_words(compared.difference.as_ref()));
    }
    let difference = compared.and_then(|compared| compared.difference);
    write(&output, &found, &words, difference, &beside)?;
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
            [left, right] => {
                let read = GeometryFile::read_cameras([left, right])?;
                tell_remarks(left, &read.1.remarks);
                read
            }
            [one, ..] => read_geometry(one)?,
            [] => return Ok(None),
        };
        if self.cameras.is_some() && file.cameras.is_none() {
            return Err(CliError::Arguments(
                "there are no two cameras in the file (P1 and P2). Use --fundamental for a matrix".into(),
            ));
        }
        Ok(Some((GivenGeometry { cameras: file.cameras, ..fundamental.into() }, file.covariance)))
    }
}

/// Estimates the geometry of the images without clicks.
fn of_images(study: &Study, arguments: &JudgeArguments, seed: u64) -> Result<ShownGeometry, CliError> {
    let parameters = Parameters { seed, ..Parameters::default() };
    let question = Question { clicks: &[], given: None, parameters: &parameters };
    let found = on_threads(arguments.threads, || watched(|monitor| study.solve(&question, monitor)))??;
    Ok(ShownGeometry::from(&found))
}

/// Returns the refusal of a calibration without a pose.
fn no_pose(notes: &[String]) -> CliError {
    let told = CalibratedCamera::without_pose(notes);
    CliError::Arguments(format!("{told} To judge a matrix, use --fundamental"))
}

/// What a written judgement rests on.
struct Beside<'a> {
    shown: &'a ShownGeometry,
    /// Pictures that the reference belongs to.
    pictures: &'a PicturesOf,
    /// How the calibration was read.
    notes: &'a [String],
}

fn write(
    output: &Output,
    judgement: &impl Serialize,
    words: &str,
    pose_difference: Option<PoseDifference>,
    beside: &Beside,
) -> Result<(), CliError> {
    let file = JudgeFile {
        message: words,
        judgement,
        pose_difference,
        reference: beside.shown.fundamental,
        pictures: beside.pictures,
        reference_verdict: beside.shown.verdict,
        calibration_notes: beside.notes,
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
fn append(log: &Path, pictures: [&Picture; 2], found: &RowJudgement) -> Result<(), CliError> {
    let failed = |error: std::io::Error| {
        CliError::Arguments(format!("cannot write {}: {}", shown_path(log), reason(&error)))
    };
    let mut file = OpenOptions::new().create(true).append(true).open(log).map_err(failed)?;
    let mut text = String::new();
    if file.metadata().map_err(failed)?.len() == 0 {
        let _ = writeln!(text, "{COLUMNS}");
    }
    let quoted = |name: &str| format!("\"{}\"", name.replace('"', "\"\""));
    let [left, right] = pictures.map(|picture| quoted(&picture.name));
    let RowJudgement { matches, constant, across, down, curved, typical, largest, is_aligned, .. } = found;
    let _ = writeln!(
        text,
        "{left},{right},{matches},{constant:.4},{across:.4},{down:.4},{curved:.4},{typical:.4},{largest:.4},{is_aligned}"
    );
    file.write_all(text.as_bytes()).map_err(failed)
}
