//! `epiline estimate`: F from point pairs given as numbers.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::arguments::{on_threads, point_pair, threads};
use super::console::tell;
use super::geometry_file::{GeometryOutput, image_notes};
use super::output::Output;
use super::overrides::Overrides;
use super::{CliError, summary};
use crate::estimate::{
    CancelFlag, Counts, Estimate, EstimateError, Method, Monitor, Parameters, PatchSupport, Preset, Progress,
    StageTiming, Verdict, Warning, estimate,
};
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance, symmetric_epipolar_distance};
use crate::image::Picture;
use crate::io::{Format, GeometryFile};
use crate::synthetic::Sample;

/// Estimate the fundamental matrix of two images from two or three point pairs
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Arguments {
    /// Left image
    #[arg(required_unless_present = "sample", requires = "right")]
    left: Option<PathBuf>,
    /// Right image
    right: Option<PathBuf>,
    /// The same scene point in both images, pixels; give two or three
    #[arg(long = "pair", value_name = "X1,Y1,X2,Y2", value_parser = point_pair, allow_hyphen_values = true)]
    pairs: Vec<PointPair>,
    /// Whose choices to use
    #[arg(long, value_enum, default_value_t)]
    preset: Preset,
    /// How to find the geometry: three-point when three pairs are given, two-point otherwise
    #[arg(long, value_enum)]
    method: Option<Method>,
    /// Seed of every random choice: the same seed gives the same F
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads to use, all cores by default
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
    /// Write the result as JSON, to standard output when it is -
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write F, the epipoles, the points and the matched patches for another program
    #[arg(long, value_name = "FILE")]
    export: Option<PathBuf>,
    /// Format of the export, by default the one its extension stands for
    #[arg(long, value_enum, requires = "export")]
    format: Option<Format>,
    /// Use a built-in pair instead of two files, by default with its own two points
    #[arg(long, value_name = "NAME", conflicts_with = "left", num_args = 0..=1, default_missing_value = "")]
    sample: Option<String>,
    #[command(flatten)]
    overrides: Overrides,
}

/// The images and the clicks on them.
struct Input {
    pictures: [Picture; 2],
    pairs: Vec<PointPair>,
}

/// Estimates, writes the JSON file, prints the summary.
pub(super) fn run(arguments: &Arguments) -> Result<(), CliError> {
    let output = Output::prepare(arguments.json.as_deref())?;
    let export = GeometryOutput::prepare_optional(arguments.export.as_deref(), arguments.format)?;
    if export.as_ref().is_some_and(GeometryOutput::is_piped) && matches!(output, Output::Piped) {
        return Err(CliError::Arguments("--json and --export cannot both be -".into()));
    }
    let mut parameters = arguments.overrides.parameters(arguments.preset)?;
    parameters.seed = arguments.seed;
    let with_third = arguments.pairs.len() > 2;
    let fallback = if with_third { Method::ThreePoint } else { Method::TwoPoint };
    parameters.method = arguments.method.unwrap_or(fallback);

    let input = input(arguments, parameters.method.pairs_needed())?;
    let found = on_threads(arguments.threads, || watched(&input, &parameters))??;
    if let Some(export) = export {
        export.write(&geometry_file(&found, &input))?;
    }
    let result = ResultFile::new(&found, &input, &parameters);
    output.write(&result, &summary::summary(&found, &input.pictures))
}

/// Reads the images; counts the pairs before, which is quicker.
fn input(arguments: &Arguments, needed: usize) -> Result<Input, CliError> {
    let found = arguments.pairs.len();
    match (&arguments.sample, &arguments.left, &arguments.right) {
        (Some(name), ..) => sample(name, needed, &arguments.pairs),
        (None, Some(left), Some(right)) if found >= needed => Ok(Input {
            pictures: [Picture::open(left)?, Picture::open(right)?],
            pairs: arguments.pairs.clone(),
        }),
        (None, Some(_), Some(_)) => Err(EstimateError::TooFewPairs { found, needed }.into()),
        _ => Err(CliError::Arguments("two images are needed, LEFT and RIGHT".into())),
    }
}

/// A built-in pair, with its own points unless some are given.
fn sample(name: &str, needed: usize, pairs: &[PointPair]) -> Result<Input, CliError> {
    let found = if name.is_empty() { Some(Sample::default()) } else { Sample::from_name(name) };
    let Some(sample) = found else {
        let known = Sample::ALL.map(Sample::name).join(", ");
        return Err(CliError::Arguments(format!("there is no built-in sample {name}; there are {known}")));
    };
    let pair = sample.load();
    let own = pair.show_me.into_iter().chain([pair.third]).take(needed);
    let pairs = if pairs.is_empty() { own.collect() } else { pairs.to_vec() };
    Ok(Input { pictures: pair.pictures, pairs })
}

/// The estimate, its progress told on standard error.
fn watched(input: &Input, parameters: &Parameters) -> Result<Estimate, EstimateError> {
    let started = Instant::now();
    let is_first = AtomicBool::new(true);
    let monitor = Monitor::new(CancelFlag::default(), |news| {
        let seconds = started.elapsed().as_secs_f64();
        match news {
            Progress::Started(stage) => tell(format_args!("{seconds:7.2} s  {}", stage.label())),
            Progress::Preliminary(first) if is_first.swap(false, Ordering::Relaxed) => {
                let numbers = first.fundamental.rows().concat();
                let numbers = numbers.iter().map(|v| format!("{v:.4e}"));
                tell(format_args!("{seconds:7.2} s  First F: {}", numbers.collect::<Vec<_>>().join(" ")));
            }
            Progress::Pencils(_) | Progress::Preliminary(_) => {}
        }
    });
    let [image1, image2] = &input.pictures;
    estimate(&image1.gray, &image2.gray, &input.pairs, parameters, &monitor)
}

/// What other programs can use of it: the clicks, and behind them the matches that the refinement found.
fn geometry_file(found: &Estimate, input: &Input) -> GeometryFile {
    GeometryFile {
        fundamental: Some(found.fundamental),
        pairs: input.pairs.iter().copied().chain(found.matches.iter().map(|m| m.pair)).collect(),
        images: Some(image_notes(&input.pictures)),
        ..GeometryFile::default()
    }
}

/// The content of a result file.
#[derive(Serialize)]
struct ResultFile<'a> {
    /// Nested rows, `x2ᵀ F x1 = 0`.
    fundamental: &'a FundamentalMatrix,
    epipole1: [f64; 3],
    epipole2: [f64; 3],
    score: f64,
    round_trip_area: f64,
    margin: Option<f64>,
    support: &'a Option<PatchSupport>,
    verdict: Option<Verdict>,
    reasons: Vec<String>,
    refined: bool,
    matches: Vec<MatchFile>,
    method: Method,
    preset: Preset,
    seed: u64,
    seconds: f64,
    first_seconds: f64,
    timings: &'a [StageTiming],
    counts: &'a Counts,
    warnings: Vec<Told<'a>>,
    images: [ImageFile<'a>; 2],
    /// As given, `x1 y1 x2 y2`.
    pairs: Vec<[f64; 4]>,
    /// Symmetric epipolar distance of every pair given, px.
    pair_distances: Vec<f64>,
    parameters: &'a Parameters,
    /// The version of the program.
    version: &'static str,
}

/// A match that the refinement rests on.
#[derive(Serialize)]
struct MatchFile {
    /// `x1 y1 x2 y2`, px.
    pair: [f64; 4],
    /// Correlation of the two patches, −1 to 1.
    correlation: f32,
    /// Sampson distance from the result, px.
    residual: f64,
}

/// A warning with its sentence.
#[derive(Serialize)]
struct Told<'a> {
    message: String,
    #[serde(flatten)]
    warning: &'a Warning,
}

/// An image of the result.
#[derive(Serialize)]
struct ImageFile<'a> {
    name: &'a str,
    width: usize,
    height: usize,
}

impl<'a> ResultFile<'a> {
    fn new(found: &'a Estimate, input: &'a Input, parameters: &'a Parameters) -> Self {
        let image = |k: usize| {
            let picture = &input.pictures[k];
            ImageFile { name: &picture.name, width: picture.frame().width, height: picture.frame().height }
        };
        let pairs = &input.pairs;
        Self {
            fundamental: &found.fundamental,
            epipole1: found.epipole1.into(),
            epipole2: found.epipole2.into(),
            score: found.score,
            round_trip_area: found.round_trip_area,
            margin: found.margin,
            support: &found.support,
            verdict: found.trust.as_ref().map(|t| t.verdict),
            reasons: found.trust.iter().flat_map(|t| t.reasons.iter().map(ToString::to_string)).collect(),
            refined: found.refined,
            matches: found
                .matches
                .iter()
                .map(|m| MatchFile {
                    pair: numbers(&m.pair),
                    correlation: m.correlation,
                    residual: sampson_distance(&found.fundamental, &m.pair),
                })
                .collect(),
            method: found.method,
            preset: found.preset,
            seed: found.seed,
            seconds: found.seconds,
            first_seconds: found.first_seconds,
            timings: &found.timings,
            counts: &found.counts,
            warnings: found.warnings.iter().map(|w| Told { message: w.to_string(), warning: w }).collect(),
            images: [image(0), image(1)],
            pairs: pairs.iter().map(numbers).collect(),
            pair_distances: pairs
                .iter()
                .map(|p| symmetric_epipolar_distance(&found.fundamental, p))
                .collect(),
            parameters,
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

/// `x1 y1 x2 y2`.
fn numbers(pair: &PointPair) -> [f64; 4] {
    [pair.point1.x, pair.point1.y, pair.point2.x, pair.point2.y]
}
