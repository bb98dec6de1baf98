//! `epiline evaluate`: accuracy of the estimators on pairs with ground truth.

mod progress;
mod report_folder;

use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::{Args, Subcommand};
use serde::Serialize;

use self::progress::ProgressLine;
use self::report_folder::ReportFolder;
use super::CliError;
use super::arguments::{count, pixels, threads};
use super::console::tell;
use super::error::INTERRUPTED;
use super::output::Output;
use super::overrides::Overrides;
use crate::estimate::{CancelFlag, Parameters, Preset, RefinementParameters};
use crate::evaluate::{
    Plan, Protocol, Report, ReportSubject, SceneSet, contenders, files_read, method_names, pair_scene_set,
    publication, run as run_plan, search_table, sequence_scene_set, table, verdict_sentences, vgg_scene_set,
};
use crate::io::refuse_clashes;
use crate::similarity::LineMeasure;

/// Measure estimators on image pairs with ground truth
#[derive(Debug, Args)]
pub(super) struct EvaluateArguments {
    #[command(subcommand)]
    source: PairSource,
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
    /// Write a report into this folder, which is created if missing: report.html is a single file,
    /// report.md has its figures beside it
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
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
pub(super) fn run(arguments: &EvaluateArguments) -> Result<(), CliError> {
    let (layout, folder, step, options) = arguments.source.parts();
    let output = Output::prepare(options.json.as_deref())?;
    let report_folder = options.report.as_deref().map(ReportFolder::prepare).transpose()?;
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
    let reports = report_folder.iter().flat_map(ReportFolder::files);
    refuse_clashes(&output.file().into_iter().chain(reports).collect::<Vec<_>>(), &inputs)?;
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
    if let Some(report_folder) = report_folder {
        let name = last_name(folder);
        let command = command(&arguments.source);
        let subject = ReportSubject {
            report: &report,
            scenes: &scenes,
            contenders: &contenders,
            name: &name,
            command: &command,
        };
        let document = publication(&subject, &|done, total| progress.hear_drawing(done, total));
        progress.finish();
        report_folder.write(&document)?;
    }
    let (made, planned) = (report.trials_made, report.trials_planned);
    if made < planned { Err(CliError::Stopped { made, planned }) } else { Ok(()) }
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

/// Returns the command that repeats the run on another machine: every option that changes a result,
/// and the folder without its parents.
fn command(source: &PairSource) -> String {
    let (kind, folder, step, options) = source.parts();
    let mut words = vec!["epiline evaluate".to_owned(), kind.to_owned(), quoted(&last_name(folder))];
    let mut option = |name: &str, value: String| words.push(format!("--{name} {value}"));
    if let Some(step) = step {
        option("step", step.to_string());
    }
    if !options.only.is_empty() {
        option("only", quoted(&options.only.join(",")));
    }
    option("protocol", options.protocol.name().to_owned());
    option("preset", options.presets.iter().map(|p| p.name()).collect::<Vec<_>>().join(","));
    option("methods", options.methods.join(","));
    option("trials", options.trials.to_string());
    option("noise", options.noise.to_string());
    option("seed", options.seed.to_string());
    if options.compare_refinement {
        words.push("--compare-refinement".to_owned());
    }
    words.extend(options.overrides.words().iter().map(|word| quoted(word)));
    words.join(" ")
}

/// Returns the last part of a path, resolved if the path ends in `.` or `..`.
fn last_name(path: &Path) -> String {
    let named =
        if path.file_name().is_some() { path.to_owned() } else { path.canonicalize().unwrap_or_default() };
    named.file_name().map_or_else(|| "folder".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// Quotes a word for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_=.,/+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
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
    fn words_of_the_command_are_quoted_for_a_shell() {
        assert_eq!(["house", "my set", "it's", ""].map(quoted), ["house", "'my set'", r"'it'\''s'", "''"]);
    }

    #[test]
    fn the_command_names_the_folder_without_the_way_to_it() {
        use clap::Parser;

        #[derive(Parser)]
        struct EvaluateLine {
            #[command(flatten)]
            arguments: EvaluateArguments,
        }
        let words = "x vgg /some/where/house --trials 3 --preset paper,robust --set mutual=2 --refine=false --report out";
        let told = command(&EvaluateLine::parse_from(words.split(' ')).arguments.source);
        assert_eq!(
            told,
            "epiline evaluate vgg house --step 1 --protocol well-posed --preset paper,robust --methods two-point \
             --trials 3 --noise 0 --seed 0 --refine=false --set mutual=2"
        );
    }
}
