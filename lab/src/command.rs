//! Command line: the layout of a folder of pairs, the methods, and the trials.
//!
//! Text for people goes to standard output, progress and errors to standard error. Exit statuses: 0
//! success, 2 invalid input, 130 stopped by Ctrl-C, 70 an error in the program itself.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use epiline::estimate::{CancelFlag, Parameters, Preset, RefinementParameters};
use epiline::internals::cli::{CliError, Output, Overrides, pixels, run_program, tell, threads, whole};
use epiline::io::refuse_clashes;
use epiline::similarity::LineMeasure;
use serde::Serialize;

use crate::error::{INTERRUPTED, LabError};
use crate::progress::ProgressLine;
use crate::{
    Plan, Protocol, Report, SceneSet, contenders, files_read, method_names, pair_scene_set, run as run_plan,
    search_table, sequence_scene_set, table, verdict_sentences, vgg_scene_set,
};

/// Measure estimators on image pairs with ground truth
#[derive(Debug, Parser)]
#[command(name = "epiline-lab", version)]
struct CommandLine {
    #[command(subcommand)]
    source: PairSource,
}

/// Runs the program `epiline-lab`.
pub fn main() -> ExitCode {
    run_program(|arguments: CommandLine| run(&arguments), LabError::exit_status)
}

/// Parses a count, at least one.
fn count(text: &str) -> Result<usize, String> {
    whole(text, 1_000_000)
}

impl ValueEnum for Protocol {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Paper, Self::WellPosed, Self::WrongClick]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name()).help(match self {
            Self::Paper => "points at least 30 px apart in both images",
            Self::WellPosed => "also at least 12 % of the image from each other's true epipolar line",
            Self::WrongClick => "well-posed, but the second pair joins points of different matches",
        }))
    }
}

#[derive(Debug, Subcommand)]
enum PairSource {
    /// Views with cameras and tracks: PREFIX.NNN.pgm, .P, .corners and PREFIX.nview-corners
    #[command(allow_negative_numbers = true)]
    Vgg {
        /// Folder with the views
        folder: PathBuf,
        /// Compare view i with view i + STEP
        #[arg(long, default_value = "1", value_parser = count)]
        step: usize,
        #[command(flatten)]
        options: Box<Options>,
    },
    /// Sequences recorded together by calibrated cameras: folders of frames or videos NAME, NAME.P,
    /// and truth-NAME1-NAME2.txt with rows x1 y1 x2 y2
    #[command(allow_negative_numbers = true)]
    Sequences {
        /// Folder with the sequences
        folder: PathBuf,
        #[command(flatten)]
        options: Box<Options>,
    },
    #[command(
        allow_negative_numbers = true,
        about = "Pairs with true matches: NAMEA.*, NAMEB.* and NAME.txt with rows x1 y1 x2 y2; NAME_F.txt for \
                 the true F, if known"
    )]
    Pairs {
        /// Folder with the pairs
        folder: PathBuf,
        #[command(flatten)]
        options: Box<Options>,
    },
}

impl PairSource {
    /// Returns the name of the layout, the folder, the step between views, and the options.
    fn parts(&self) -> (&'static str, &Path, Option<usize>, &Options) {
        match self {
            Self::Vgg { folder, step, options } => ("vgg", folder, Some(*step), options),
            Self::Pairs { folder, options } => ("pairs", folder, None, options),
            Self::Sequences { folder, options } => ("sequences", folder, None, options),
        }
    }
}

#[derive(Debug, Args)]
struct Options {
    /// Number of trials per pair
    #[arg(long, default_value = "10", value_parser = count)]
    trials: usize,
    /// Selection of the true matches to click
    #[arg(long, value_enum, default_value_t = Protocol::WellPosed)]
    protocol: Protocol,
    /// Presets to compare, separated by commas; repeatable
    #[arg(long = "preset", value_enum, value_delimiter = ',', default_value = "robust")]
    presets: Vec<Preset>,
    /// Methods to compare, separated by commas; repeatable
    #[arg(long = "methods", alias = "method", value_name = "METHOD", value_delimiter = ',',
        default_value = "two-point", value_parser = PossibleValuesParser::new(method_names()))]
    methods: Vec<String>,
    /// Standard deviation of Gaussian noise on every clicked coordinate, pixels
    #[arg(long, value_name = "SIGMA", default_value = "0", value_parser = pixels)]
    noise: f64,
    /// Random seed of the clicks, the noise and the estimators
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Total number of threads, by default one per core
    #[arg(long, value_parser = threads)]
    threads: Option<usize>,
    /// Number of threads per trial; for realistic times give it the value of --threads
    #[arg(long, default_value = "1", value_parser = threads, value_name = "N")]
    threads_per_trial: usize,
    /// Evaluate only these pairs, separated by commas
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    only: Vec<String>,
    /// Run every preset with and without refinement
    #[arg(long, conflicts_with = "refine")]
    compare_refinement: bool,
    /// Also show the ranks of the best hypothesis and of the true geometry
    #[arg(long)]
    ranks: bool,
    /// Write every trial as JSON; - is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    overrides: Overrides,
}

/// Content of the JSON file.
#[derive(Serialize)]
struct ReportFile<'a> {
    /// Layout: `vgg`, `pairs` or `sequences`.
    layout: &'static str,
    folder: String,
    step: Option<usize>,
    /// Version of the program.
    version: &'static str,
    #[serde(flatten)]
    report: &'a Report,
}

/// Runs the evaluation, writes the JSON file and prints the table.
fn run(arguments: &CommandLine) -> Result<(), LabError> {
    let (layout, folder, step, options) = arguments.source.parts();
    let output = Output::prepare(options.json.as_deref())?;
    let mut presets = parameters(options)?;
    let of_sequences = matches!(arguments.source, PairSource::Sequences { .. });
    if of_sequences {
        for parameters in &mut presets {
            parameters.similarity.measure = LineMeasure::Barcodes;
        }
    }
    let contenders = contenders(&options.methods, &presets)?;
    let inputs = files_read(folder);
    let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    refuse_clashes(output.file().as_slice(), &inputs).map_err(CliError::from)?;
    let SceneSet { scenes, left_out } = match step {
        Some(step) => vgg_scene_set(folder, step, &options.only)?,
        None if of_sequences => sequence_scene_set(folder, &options.only, &CancelFlag::default())?,
        None => pair_scene_set(folder, &options.only)?,
    };
    for sentence in &left_out {
        tell(format_args!("warning: {sentence}"));
    }
    let threads =
        options.threads.or_else(|| std::thread::available_parallelism().ok().map(usize::from)).unwrap_or(1);
    let plan = Plan {
        protocol: options.protocol,
        trials: options.trials,
        noise: options.noise,
        seed: options.seed,
        trials_at_once: (threads / options.threads_per_trial).max(1),
        threads_per_trial: options.threads_per_trial,
    };
    let progress = ProgressLine::new();
    let stop = stop_on_interrupt();
    let mut report = run_plan(&scenes, &contenders, &plan, &|news| progress.hear(news), &stop)?;
    report.notes.splice(0..0, left_out);
    progress.finish();
    let file = ReportFile {
        layout,
        folder: folder.display().to_string(),
        step,
        version: env!("CARGO_PKG_VERSION"),
        report: &report,
    };
    output.write(&file, &text(&report, options.ranks))?;
    let (made, planned) = (report.trials_made, report.trials_planned);
    if made < planned { Err(LabError::Stopped { made, planned }) } else { Ok(()) }
}

/// Returns a flag that Ctrl-C sets. A second Ctrl-C ends the program at once.
fn stop_on_interrupt() -> CancelFlag {
    let stop = CancelFlag::default();
    let raised = stop.clone();
    let handler = move || {
        if raised.is_cancelled() {
            std::process::exit(i32::from(INTERRUPTED));
        }
        raised.cancel();
        tell("\nFinishing the running trials, then the report. Press Ctrl-C again to quit at once");
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        tell(format_args!("Ctrl-C will end the program without a report: {error}"));
    }
    stop
}

/// Returns the parameters of each preset once, or once with and once without refinement.
fn parameters(options: &Options) -> Result<Vec<Parameters>, CliError> {
    let mut presets: Vec<Preset> = Vec::new();
    for preset in &options.presets {
        if !presets.contains(preset) {
            presets.push(*preset);
        }
    }
    let mut all = Vec::new();
    for preset in presets {
        let parameters = Parameters { seed: options.seed, ..options.overrides.parameters(preset)? };
        if options.compare_refinement {
            all.extend([false, true].map(|refine| Parameters {
                refinement: RefinementParameters { refine, ..parameters.refinement },
                ..parameters.clone()
            }));
        } else {
            all.push(parameters);
        }
    }
    Ok(all)
}

/// Returns the tables with a sentence about their content.
fn text(report: &Report, ranks: bool) -> String {
    let plan = &report.parameters.plan;
    let search = search_table(report);
    let search = match (ranks, search.is_empty()) {
        (false, _) => String::new(),
        (true, true) => "\nNone of these methods ranks hypotheses.\n".to_owned(),
        (true, false) => {
            format!(
                "\nMedian error and rank of the best generated hypothesis, and rank of the true geometry.\n\n{search}"
            )
        }
    };
    format!(
        "Mean symmetric epipolar distance of all true matches, px. Protocol {}, click noise {} px, seed {}. \
         Seconds per trial on {} thread(s), {} at a time.\n\n{}{}{search}",
        plan.protocol.name(),
        plan.noise,
        plan.seed,
        plan.threads_per_trial,
        plan.trials_at_once,
        table(report),
        [verdict_sentences(report), vec![String::new()]].concat().join("\n"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_description_of_the_command_line_is_consistent() {
        <CommandLine as clap::CommandFactory>::command().debug_assert();
    }
}
