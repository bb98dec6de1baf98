//! `epiline estimate`: F from point pairs, or from the images alone.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::CliError;
use super::arguments::on_threads;
use super::calibration::{settled, views};
use super::console::tell;
use super::estimate_arguments::EstimateArguments;
use super::geometry_file::{read_matches, tell_outside};
use super::points;
use super::result_output::Beside;
use crate::estimate::{
    CancelFlag, Estimate, EstimateError, Event, EventKind, Match, Method, Monitor, Progress, Reason,
};
use crate::geometry::PointPair;
use crate::image::Picture;
use crate::io::CalibratedCamera;
use crate::presentation::lens_in_words;
use crate::study::{Question, Study, clicks_in, matches_in};

/// Message for images without a clear distortion.
const NO_LENS: &str = "no lens distortion fits the matches clearly better. The images are used as they are";

/// Estimates F, writes the JSON file and prints the summary.
pub(super) fn run(arguments: &EstimateArguments) -> Result<(), CliError> {
    if let Some(matches) = arguments.matches.as_deref().filter(|_| arguments.images.is_absent()) {
        return points::run(arguments, matches);
    }
    let files = arguments
        .images
        .files()
        .chain(arguments.cameras.calibration.files())
        .chain(arguments.matches.as_deref());
    let files = files.collect::<Vec<_>>();
    let output = arguments.result.prepare(&files)?.with_undistorted(
        arguments.undistorted.as_deref(),
        arguments.cameras.is_given(),
        &files,
    )?;
    let mut parameters = arguments.overrides.parameters(arguments.preset)?;
    parameters.seed = arguments.seed.unwrap_or(parameters.seed);
    let pairs =
        if arguments.images.is_sample() { arguments.pairs.len().max(2) } else { arguments.pairs.len() };
    parameters.method = arguments.method.unwrap_or_else(|| Method::usual(pairs, parameters.search));

    let calibrated = arguments.cameras.calibration.read()?;
    let mut given = arguments.matches.as_deref().map(read_matches).transpose()?;
    let (pictures, mut pairs) = input(arguments, parameters.pairs_needed(), parameters.method)?;
    let mut study = Study::of_pictures(pictures);
    if let Some(given) = &given {
        tell_outside(given, study.frames());
    }
    let solve = |study: &Study, pairs: &[PointPair], given: Option<&[Match]>| {
        let question = Question { clicks: pairs, given, parameters: &parameters };
        on_threads(arguments.threads, || {
            if let Err(error) = study.check_given(&question) {
                tell(format_args!("warning: the matches are not used: {error}"));
            }
            watched(|monitor| study.solve(&question, monitor))
        })
    };
    let (mut first, mut lambdas) = (None, None);
    if arguments.cameras.fits_lens() {
        let found = solve(&study, &pairs, given.as_deref())??;
        let lens = on_threads(arguments.threads, || study.find_lens(&found))?;
        match &lens {
            Some(lens) => tell(lens_in_words(lens, study.frames())),
            None => tell(NO_LENS),
        }
        (first, lambdas) = (Some(found), lens.map(|lens| lens.lambdas));
    }
    let calibrated = arguments.cameras.of_pictures(calibrated, study.pictures(), lambdas)?;
    let calibrated = calibrated.map(|cameras| settled(cameras, &study, given.as_deref())).transpose()?;
    let notes = calibrated.as_ref().map(CalibratedCamera::notes_of).unwrap_or_default();
    let baseline = calibrated.as_ref().and_then(CalibratedCamera::baseline);
    if let Some(cameras) = calibrated {
        let views = views(&cameras, study.frames())?;
        pairs = clicks_in(&views, &pairs)?;
        given = given.map(|given| matches_in(&views, &given)).transpose()?;
        study = study.with_views(views);
    }
    let found = match first.filter(|_| study.views().is_none()) {
        Some(found) => found,
        None => solve(&study, &pairs, given.as_deref())??,
    };
    let reasons = found.assessment.trust.iter().flat_map(|trust| &trust.reasons);
    let may_be_bent = |reason: &Reason| matches!(reason, Reason::Pattern { .. });
    if !arguments.cameras.is_given() && reasons.clone().any(may_be_bent) {
        tell("a lens may bend the images. Try --division auto");
    }
    let given: Vec<PointPair> = given.iter().flatten().map(|found| found.pair).collect();
    let beside =
        Beside { views: study.views(), baseline, given: &given, calibration: &notes, ..Beside::default() };
    output.write(&found, &pairs, study.pictures(), &parameters, beside)
}

/// Returns the pictures and the point pairs. Their number is checked before the pictures are read. A
/// built-in pair has points of its own.
fn input(
    arguments: &EstimateArguments,
    needed: usize,
    method: Method,
) -> Result<([Picture; 2], Vec<PointPair>), CliError> {
    let EstimateArguments { images, pairs, .. } = arguments;
    if let Some(sample) = images.sample()? {
        let own = sample.show_me.into_iter().chain([sample.third]).take(method.pairs_needed());
        return Ok((sample.pictures, if pairs.is_empty() { own.collect() } else { pairs.clone() }));
    }
    let found = pairs.len();
    if found < needed {
        return Err(EstimateError::TooFewPairs { found, needed }.into());
    }
    Ok((images.load()?.0, pairs.clone()))
}

/// Runs an estimate with its progress on standard error.
pub(super) fn watched(
    work: impl FnOnce(&Monitor) -> Result<Estimate, EstimateError>,
) -> Result<Estimate, EstimateError> {
    let started = Instant::now();
    let is_first = AtomicBool::new(true);
    let monitor = Monitor::new(CancelFlag::default(), |news| {
        let seconds = started.elapsed().as_secs_f64();
        match news {
            Progress::Happened(Event { kind: EventKind::Began(stage), .. }) => {
                tell(format_args!("{seconds:7.2} s  {}", stage.label()));
            }
            Progress::Preliminary(first) if is_first.swap(false, Ordering::Relaxed) => {
                let numbers = first.fundamental().rows().concat();
                let numbers = numbers.iter().map(|v| format!("{v:.4e}"));
                tell(format_args!("{seconds:7.2} s  First F: {}", numbers.collect::<Vec<_>>().join(" ")));
            }
            Progress::Happened(_) | Progress::Pencils(_) | Progress::Preliminary(_) => {}
        }
    });
    work(&monitor)
}
