//! `epiline barcode`: F of two stationary cameras, from moving objects.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::CliError;
use super::arguments::{on_threads, point_pair, threads};
use super::console::tell;
use super::estimate::watched;
use super::overrides::Overrides;
use super::result_output::{Beside, ResultArguments};
use crate::estimate::{CancelFlag, Preset};
use crate::geometry::PointPair;
use crate::io::{SequenceFile, read_sequence};
use crate::motion::{BackgroundParameters, MOST_OFFSET, MotionError, Silhouettes, clear_offset, find_offset};
use crate::study::{Question, Study, barcode_parameters};
use crate::synthetic::{BallScene, ThrownBalls};

/// Maximum number of offsets reported.
const REPORTED: usize = 3;
/// Frames between two progress messages.
const FRAMES_PER_MESSAGE: usize = 100;

/// Estimate the fundamental matrix of two stationary cameras from two sequences recorded at the
/// same time
///
/// The method compares motion barcodes, which record the frames in which moving objects cross a
/// line. Point pairs are optional
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct BarcodeArguments {
    /// Frames of the left camera: a folder of numbered pictures, or a video if ffmpeg is installed
    #[arg(required_unless_present = "sample", requires = "right")]
    left: Option<PathBuf>,
    /// Frames of the right camera
    right: Option<PathBuf>,
    /// Use the built-in sequences of balls thrown in a yard
    #[arg(long, conflicts_with = "left")]
    sample: bool,
    /// Point pair: the same scene point in both cameras, pixels; repeatable
    #[arg(long = "pair", value_name = "X1,Y1,X2,Y2", value_parser = point_pair, allow_hyphen_values = true)]
    pairs: Vec<PointPair>,
    /// Offset between the sequences: frame K of the left camera and frame K + N of the right camera
    /// are simultaneous
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "find_offset")]
    offset: i32,
    /// Find the offset, up to 50 frames in either direction; 0 if none is clear
    #[arg(long)]
    find_offset: bool,
    /// Preset of the parameters
    #[arg(long, value_enum, default_value_t)]
    preset: Preset,
    /// Random seed, by default 0; the same seed gives the same F
    #[arg(long)]
    seed: Option<u64>,
    /// Number of threads, by default one per core
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
    #[command(flatten)]
    result: ResultArguments,
    #[command(flatten)]
    overrides: Overrides,
}

/// Reads the sequences, detects motion, finds the offset, estimates F and writes the result.
pub(super) fn run(arguments: &BarcodeArguments) -> Result<(), CliError> {
    let inputs: Vec<&Path> =
        [&arguments.left, &arguments.right].into_iter().flatten().map(PathBuf::as_path).collect();
    let output = arguments.result.prepare(&inputs)?;
    let mut parameters = arguments.overrides.parameters(arguments.preset)?;
    parameters.seed = arguments.seed.unwrap_or(parameters.seed);
    let parameters = barcode_parameters(parameters, arguments.pairs.len());

    let (study, found, offset) = on_threads(arguments.threads, || -> Result<_, CliError> {
        let files = sequences(arguments)?;
        let [first, second] = moving(&files)?;
        let offset = if arguments.find_offset { best_offset([&first, &second])? } else { arguments.offset };
        let together = Silhouettes::overlapping([&first, &second], offset)?.map(Arc::new);
        let study = Study::of_pictures(files.map(|file| file.first)).with_silhouettes(together);
        let question = Question { clicks: &arguments.pairs, given: None, parameters: &parameters };
        let found = watched(|monitor| study.solve(&question, monitor))?;
        Ok((study, found, offset))
    })??;
    output.write(
        &found,
        &arguments.pairs,
        study.pictures(),
        &parameters,
        Beside { offset: Some(offset), ..Beside::default() },
    )
}

/// Reads both sequences and prints their notes.
fn sequences(arguments: &BarcodeArguments) -> Result<[SequenceFile; 2], CliError> {
    let (Some(left), Some(right)) = (&arguments.left, &arguments.right) else {
        return built_in()
            .ok_or_else(|| CliError::Arguments("the built-in sequences cannot be rendered".into()));
    };
    let read = |path: &Path| -> Result<SequenceFile, CliError> {
        let each = |count: usize| {
            if count.is_multiple_of(FRAMES_PER_MESSAGE) {
                tell(format_args!("{count} frames of {} read", path.display()));
            }
        };
        let file = read_sequence(path, &CancelFlag::default(), &each)?;
        for note in &file.notes {
            tell(format_args!("Note: {note}"));
        }
        Ok(file)
    };
    let files = [read(left)?, read(right)?];
    let [count1, count2] = files.each_ref().map(|file| file.sequence.len());
    if count1 != count2 {
        tell(format_args!(
            "Note: the sequences have {count1} and {count2} frames. Only frames in both at this offset are compared"
        ));
    }
    Ok(files)
}

fn built_in() -> Option<[SequenceFile; 2]> {
    let [left, right] = BallScene::new(ThrownBalls::default())?.sequences()?;
    Some([SequenceFile::made(left).ok()?, SequenceFile::made(right).ok()?])
}

/// Detects the moving objects in both sequences.
fn moving(files: &[SequenceFile; 2]) -> Result<[Silhouettes; 2], MotionError> {
    tell(format_args!("Separating moving objects from the background"));
    let of = |file: &SequenceFile| {
        Silhouettes::new(&file.sequence, &BackgroundParameters::default(), &CancelFlag::default())
    };
    let [first, second] = files;
    Ok([of(first)?, of(second)?])
}

/// Finds the offset with the highest correlation of barcodes, and prints the best ones. Returns 0 if
/// none is clear.
fn best_offset(both: [&Silhouettes; 2]) -> Result<i32, CliError> {
    let found = find_offset(both, MOST_OFFSET, &CancelFlag::default())?;
    if found.is_empty() {
        return Err(CliError::Arguments(
            "the sequences are too short to find their offset. Give it with --offset".into(),
        ));
    }
    let told: Vec<String> =
        found.iter().take(REPORTED).map(|one| format!("{} ({:.3})", one.offset, one.correlation)).collect();
    tell(format_args!("Best offsets (correlation): {}", told.join(", ")));
    let clear = clear_offset(&found);
    if clear.is_none() {
        tell(format_args!("Note: no offset is clear. The sequences are compared at offset 0"));
    }
    Ok(clear.map_or(0, |best| best.offset))
}
