//! `epiline barcode`: F of two cameras that stand still, from what moves in front of them.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::arguments::{on_threads, point_pair, threads};
use super::console::tell;
use super::estimate::watched;
use super::overrides::Overrides;
use super::result_output::ResultArguments;
use crate::estimate::{CancelFlag, Estimate, Method, Monitor, PreparedPair, Preset, estimate_prepared};
use crate::geometry::PointPair;
use crate::io::{SequenceFile, read_sequence};
use crate::motion::{BackgroundParameters, MOST_OFFSET, MotionError, Silhouettes, find_offset};
use crate::similarity::LineMeasure;
use crate::synthetic::{BallScene, ThrownBalls};

/// Offsets told beside the best one.
const TOLD: usize = 3;
/// Frames between two news of reading.
const NEWS: usize = 100;

/// Estimate the fundamental matrix of two cameras that stand still from two sequences of frames recorded at the same time:
/// in which frames lines are crossed by things that move (motion barcodes). Without point pairs or with any number
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct BarcodeArguments {
    /// Frames of the left camera: a folder of numbered pictures, or a video if ffmpeg is installed
    #[arg(required_unless_present = "sample", requires = "right")]
    left: Option<PathBuf>,
    /// Frames of the right camera
    right: Option<PathBuf>,
    /// Use the built-in sequences: balls thrown about in a yard
    #[arg(long, conflicts_with = "left")]
    sample: bool,
    /// The same scene point in both cameras, pixels, any number of times
    #[arg(long = "pair", value_name = "X1,Y1,X2,Y2", value_parser = point_pair, allow_hyphen_values = true)]
    pairs: Vec<PointPair>,
    /// Frame K of the left camera was taken together with frame K + N of the right one
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "find_offset")]
    offset: i32,
    /// Find the offset, within 50 frames either way
    #[arg(long)]
    find_offset: bool,
    /// Whose choices to use
    #[arg(long, value_enum, default_value_t)]
    preset: Preset,
    /// Seed of every random choice: the same seed gives the same F
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads to use, all cores by default
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
    #[command(flatten)]
    result: ResultArguments,
    #[command(flatten)]
    overrides: Overrides,
}

/// Reads the sequences, finds what moves and the offset, estimates, writes and prints.
pub(super) fn run(arguments: &BarcodeArguments) -> Result<(), CliError> {
    let inputs: Vec<&Path> =
        [&arguments.left, &arguments.right].into_iter().flatten().map(PathBuf::as_path).collect();
    let output = arguments.result.prepare(&inputs)?;
    let mut parameters = arguments.overrides.parameters(arguments.preset)?;
    parameters.seed = arguments.seed;
    parameters.similarity.measure = LineMeasure::Barcodes;
    parameters.method = if arguments.pairs.len() < 2 { Method::LinesAlone } else { Method::TwoPoint };

    let (pictures, found, offset) = on_threads(arguments.threads, || -> Result<_, CliError> {
        let files = sequences(arguments)?;
        let [first, second] = moving(&files)?;
        let offset = if arguments.find_offset { best_offset([&first, &second])? } else { arguments.offset };
        let pictures = files.map(|file| file.first);
        let [image1, image2] = &pictures;
        let prepared = PreparedPair::of_sequences(&image1.gray, &image2.gray, [&first, &second], offset)?;
        let compute =
            |monitor: &Monitor| estimate_prepared(&prepared, &arguments.pairs, &parameters, monitor);
        let found: Estimate = watched(compute)?;
        Ok((pictures, found, offset))
    })??;
    output.write(&found, &arguments.pairs, &pictures, &parameters, Some(offset))
}

/// The two sequences with their notes told.
fn sequences(arguments: &BarcodeArguments) -> Result<[SequenceFile; 2], CliError> {
    let (Some(left), Some(right)) = (&arguments.left, &arguments.right) else {
        return built_in()
            .ok_or_else(|| CliError::Arguments("the built-in sequences cannot be drawn".into()));
    };
    let read = |path: &Path| -> Result<SequenceFile, CliError> {
        let each = |count: usize| {
            if count.is_multiple_of(NEWS) {
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
            "Note: the sequences have {count1} and {count2} frames; those in common at the offset are compared"
        ));
    }
    Ok(files)
}

/// The built-in sequences as if they had been read.
fn built_in() -> Option<[SequenceFile; 2]> {
    let [left, right] = BallScene::new(ThrownBalls::default())?.sequences()?;
    Some([SequenceFile::made(left).ok()?, SequenceFile::made(right).ok()?])
}

/// What moves in either sequence.
fn moving(files: &[SequenceFile; 2]) -> Result<[Silhouettes; 2], MotionError> {
    tell(format_args!("Telling what moves from what stands still"));
    let of = |file: &SequenceFile| {
        Silhouettes::new(&file.sequence, &BackgroundParameters::default(), &CancelFlag::default())
    };
    let [first, second] = files;
    Ok([of(first)?, of(second)?])
}

/// The offset at which the barcodes of lines agree best, told with the next ones.
fn best_offset(both: [&Silhouettes; 2]) -> Result<i32, CliError> {
    let found = find_offset(both, MOST_OFFSET, &CancelFlag::default())?;
    let Some(best) = found.first() else {
        return Err(CliError::Arguments(
            "the sequences are too short to find their offset: give it with --offset".into(),
        ));
    };
    let told: Vec<String> =
        found.iter().take(TOLD).map(|one| format!("{} ({:.3})", one.offset, one.correlation)).collect();
    tell(format_args!("Offsets with the best agreement: {}", told.join(", ")));
    Ok(best.offset)
}
