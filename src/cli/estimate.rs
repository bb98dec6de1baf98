//! `epiline estimate`: F from point pairs given as numbers.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::Args;

use super::CliError;
use super::arguments::{ImagePair, on_threads, point_pair, threads};
use super::console::tell;
use super::overrides::Overrides;
use super::result_output::ResultArguments;
use crate::estimate::{
    CancelFlag, Estimate, EstimateError, Method, Monitor, Preset, Progress, Search, estimate,
};
use crate::geometry::PointPair;
use crate::image::Picture;

/// Estimate the fundamental matrix of two images from point pairs, or from none
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct EstimateArguments {
    #[command(flatten)]
    images: ImagePair,
    /// The same scene point in both images, pixels, any number of times: two are enough, and without any the images alone
    /// have to do (the preset paper takes none, two or three)
    #[arg(long = "pair", value_name = "X1,Y1,X2,Y2", value_parser = point_pair, allow_hyphen_values = true)]
    pairs: Vec<PointPair>,
    /// Whose choices to use
    #[arg(long, value_enum, default_value_t)]
    preset: Preset,
    /// How to find the geometry; by the number of pairs when it is not said: lines compares all lines of both images and
    /// needs no pair
    #[arg(long, value_enum)]
    method: Option<Method>,
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

/// The images and the clicks on them.
struct EstimateInput {
    pictures: [Picture; 2],
    pairs: Vec<PointPair>,
}

/// Estimates, writes the JSON file, prints the summary.
pub(super) fn run(arguments: &EstimateArguments) -> Result<(), CliError> {
    let output = arguments.result.prepare(&arguments.images.files().collect::<Vec<_>>())?;
    let mut parameters = arguments.overrides.parameters(arguments.preset)?;
    parameters.seed = arguments.seed;
    let fallback = match (arguments.pairs.len(), parameters.search) {
        (0, Search::Lines) if !arguments.images.is_sample() => Method::LinesAlone,
        (0..3, _) => Method::TwoPoint,
        _ => Method::ThreePoint,
    };
    parameters.method = arguments.method.unwrap_or(fallback);

    let input = input(arguments, parameters.pairs_needed(), parameters.method)?;
    let [image1, image2] = &input.pictures;
    let compute =
        |monitor: &Monitor| estimate(&image1.gray, &image2.gray, &input.pairs, &parameters, monitor);
    let found = on_threads(arguments.threads, || watched(compute))??;
    output.write(&found, &input.pairs, &input.pictures, &parameters, None)
}

/// Reads the images; counts the pairs before, which is quicker. A built-in pair has points of its own.
fn input(arguments: &EstimateArguments, needed: usize, method: Method) -> Result<EstimateInput, CliError> {
    let EstimateArguments { images, pairs, .. } = arguments;
    let found = pairs.len();
    if let Some(sample) = images.sample()? {
        let own = sample.show_me.into_iter().chain([sample.third]).take(method.pairs_needed());
        let pairs = if pairs.is_empty() { own.collect() } else { pairs.clone() };
        return Ok(EstimateInput { pictures: sample.pictures, pairs });
    }
    if found < needed {
        return Err(EstimateError::TooFewPairs { found, needed }.into());
    }
    let (pictures, _) = images.load()?;
    Ok(EstimateInput { pictures, pairs: pairs.clone() })
}

/// An estimate, its progress told on standard error.
pub(super) fn watched(
    work: impl FnOnce(&Monitor) -> Result<Estimate, EstimateError>,
) -> Result<Estimate, EstimateError> {
    let started = Instant::now();
    let is_first = AtomicBool::new(true);
    let monitor = Monitor::new(CancelFlag::default(), |news| {
        let seconds = started.elapsed().as_secs_f64();
        match news {
            Progress::Started(stage) => tell(format_args!("{seconds:7.2} s  {}", stage.label())),
            Progress::Preliminary(first) if is_first.swap(false, Ordering::Relaxed) => {
                let numbers = first.fundamental().rows().concat();
                let numbers = numbers.iter().map(|v| format!("{v:.4e}"));
                tell(format_args!("{seconds:7.2} s  First F: {}", numbers.collect::<Vec<_>>().join(" ")));
            }
            Progress::Pencils(_) | Progress::Preliminary(_) => {}
        }
    });
    work(&monitor)
}
