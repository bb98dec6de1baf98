//! The result in words: a verdict with its reason, figures, further reasons, and the next action.

mod action;
mod imported;
#[cfg(test)]
mod tests;

use crate::app::model::computation::{Computation, EstimateFailure, Freshness};
use crate::app::model::document::{Document, GIVEN_FIT, Given, Role, pair_name};
use crate::estimate::{self, CLICK_DEVIATIONS, Estimate, PairNames, PairNumbers, Trust, Warning};
use crate::geometry::{FundamentalMatrix, sampson_distance, symmetric_epipolar_distance};
use crate::presentation::{
    self, NEAR_MATCHES, PARTLY_RELIABLE, ResultContext, facts, is_open_elsewhere, likely_in_words,
    mostly_misplaced, named_error_in_words, named_reason_in_words, named_warning_in_words, sentence,
    sorted_reasons,
};

pub use crate::presentation::{
    EpipolePlace, Fact, Glance, HypothesisFigure, Standing, Tone, corrected_fact, epipole_text,
    epipoles_at_a_glance, hypothesis_facts, lens_fact, line_score_text, lines_at_a_glance, pose_facts,
    short_epipole_text,
};
pub use action::{BENT, CardAction, LineLook, USE_LENS};
pub use imported::{import_facts, import_warning};

/// Description of the state of the estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct VerdictInWords {
    pub tone: Tone,
    pub word: &'static str,
    /// The main reason, or the next step.
    pub sentence: String,
    pub facts: Vec<Fact>,
    /// All reasons, the main one first.
    pub warnings: Vec<String>,
    /// How likely the lines are right, in a few words, and the sentence that explains it.
    pub likely: Option<[String; 2]>,
}

/// Returns whether the state of the estimate is good or bad news. Lines are drawn accordingly.
pub fn tone(document: &Document, computation: &Computation) -> Tone {
    let Some((estimate, freshness)) = computation.result() else {
        return match computation.failure() {
            _ if computation.is_running() => Tone::Busy,
            Some(_) => Tone::Bad,
            None => Tone::Idle,
        };
    };
    let assessment = &estimate.assessment;
    let trust = assessment.trust.as_ref();
    match freshness {
        Freshness::Stale | Freshness::Followed | Freshness::Preliminary => Tone::Busy,
        Freshness::Stopped => Tone::Caution,
        Freshness::Final if is_of_different_scenes(estimate) => Tone::Apart,
        Freshness::Final if trust.is_some_and(|trust| trust.verdict.is_unreliable()) => Tone::Bad,
        Freshness::Final => {
            let has_reasons = trust.is_some_and(|trust| !trust.reasons.is_empty());
            let contradicted = || contradicting_check(document, estimate.fundamental()).is_some();
            let is_doubtful = has_reasons || !warnings(estimate).is_empty() || contradicted();
            if is_doubtful { Tone::Caution } else { Tone::Good }
        }
    }
}

fn is_of_different_scenes(estimate: &Estimate) -> bool {
    let trust = estimate.assessment.trust.as_ref();
    trust.is_some_and(|trust| trust.verdict == estimate::Verdict::DifferentScenes)
}

/// Returns the warnings that count. Those about clicks say what clicks determine on their own, so they do not touch a
/// result that its matches make reliable.
fn warnings(estimate: &Estimate) -> Vec<&Warning> {
    let assessment = &estimate.assessment;
    let is_reliable =
        assessment.trust.as_ref().is_some_and(|trust| trust.verdict == estimate::Verdict::Reliable);
    let is_of_clicks = |warning: &Warning| !matches!(warning, Warning::CalibrationContradicted);
    assessment.warnings.iter().filter(|warning| !(is_reliable && is_of_clicks(warning))).collect()
}

/// Describes the state of the estimate.
pub fn verdict(document: &Document, computation: &Computation) -> VerdictInWords {
    let tone = tone(document, computation);
    let bare = |word, sentence: String| VerdictInWords {
        tone,
        word,
        sentence,
        facts: Vec::new(),
        warnings: Vec::new(),
        likely: None,
    };
    let stage = || computation.stage().map_or(String::new(), |stage| stage.label().to_owned());
    let Some((estimate, freshness)) = computation.result() else {
        return match computation.failure() {
            _ if computation.is_running() => bare("Estimating", stage()),
            Some(EstimateFailure::Estimate(error)) => {
                let names = WindowNames { document, fundamental: None };
                bare("No result", format!("{}.", sentence(&named_error_in_words(error, &names))))
            }
            Some(EstimateFailure::Panic(text)) => bare(
                "No result",
                format!(
                    "The computation stopped unexpectedly ({text}), by a fault of the program. \
                     Your points are kept. Move a point or press F5 to try again."
                ),
            ),
            None if computation.was_stopped() => bare("Stopped", "F5 computes again".into()),
            None => bare("No geometry yet", waiting(document)),
        };
    };
    let assessment = &estimate.assessment;
    let (reasons, misplaced) = assessment.trust.as_ref().map(sorted_reasons).unwrap_or_default();
    let mostly_misplaced = mostly_misplaced(misplaced, document.used().count());
    let names = WindowNames { document, fundamental: Some(estimate.fundamental()) };
    let reasons = reasons.into_iter().map(|reason| named_reason_in_words(reason, &names));
    // A preliminary geometry may still approach the checks, and a stale one belongs to other points.
    let is_final = freshness == Freshness::Final;
    let checked = is_final.then(|| contradicting_check(document, estimate.fundamental())).flatten();
    // The probability would contradict a doubt about a click. It knows nothing of pairs that are only checked, and
    // promises nothing of an unreliable result.
    let of_clicks = assessment.trust.as_ref().is_some_and(Trust::doubts_clicks_alone);
    let states = is_final && checked.is_none() && !of_clicks && matches!(tone, Tone::Good | Tone::Caution);
    let likely = document.frames().filter(|_| states).and_then(|frames| likely_in_words(estimate, frames));
    // Warnings about an unfinished result could be outdated a moment later.
    let finished = matches!(freshness, Freshness::Final | Freshness::Stopped);
    let warnings: Vec<_> = mostly_misplaced
        .into_iter()
        .chain(reasons)
        .chain(warnings(estimate).into_iter().map(|warning| named_warning_in_words(warning, &names)))
        .chain(checked)
        .filter(|_| finished)
        .collect();
    let (word, sentence) = match freshness {
        Freshness::Stale => ("Updating", "The lines are those of the previous result".to_owned()),
        Freshness::Followed => ("Updating", "The latest geometry, until the new search ends".into()),
        Freshness::Preliminary => ("First result", format!("Being refined: {}", stage())),
        Freshness::Stopped => ("First result", "The search was stopped before refinement".into()),
        Freshness::Final => {
            let is_open = document.frames().is_some_and(|frames| is_open_elsewhere(estimate, frames));
            let word = match tone {
                Tone::Good if assessment.trust.is_none() => "Estimated",
                Tone::Good if is_open => PARTLY_RELIABLE,
                Tone::Good => "Reliable",
                Tone::Apart => "Different scenes?",
                Tone::Bad => "Unreliable",
                _ => "Doubtful",
            };
            let checks = match assessment.trust {
                Some(_) if !is_open => ". All checks passed.",
                _ => "",
            };
            let sentence = warnings.first().cloned();
            let given = document.given.as_ref().map_or(String::new(), |given| {
                let (fit, all) = (given.fitting(estimate.fundamental()), given.matches.len());
                format!(" {fit} of {all} given matches fit to {GIVEN_FIT} px.")
            });
            let alone = assessment.of_given.then(|| "the given matches alone".to_owned());
            let from = alone.unwrap_or_else(|| used(document));
            let is_more = is_open || !given.is_empty();
            let stop = if checks.is_empty() && is_more { "." } else { checks };
            let open = if is_open { format!("{NEAR_MATCHES}. ") } else { String::new() };
            let sentence = sentence.unwrap_or_else(|| format!("{open}Found from {from}{stop}{given}"));
            (word, sentence)
        }
    };
    // The figures of a stale result belong to earlier points.
    let facts = if freshness.is_behind() {
        Vec::new()
    } else {
        facts(estimate, &context(document, estimate, is_final))
    };
    VerdictInWords { tone, word, sentence, facts, warnings, likely }
}

fn context(document: &Document, estimate: &Estimate, is_final: bool) -> ResultContext {
    let given = |given: &Given| [given.fitting(estimate.fundamental()), given.matches.len()];
    ResultContext {
        frames: document.frames(),
        score: document.parameters.validation.line_score,
        given: document.given.as_ref().map(given),
        is_final,
    }
}

/// Returns the places of both epipoles of a geometry, with their intervals if it is that of `estimate`.
pub fn epipole_places(
    document: &Document,
    f: &FundamentalMatrix,
    estimate: Option<&Estimate>,
) -> Option<[EpipolePlace; 2]> {
    Some(presentation::epipole_places(f, document.frames()?, estimate))
}

fn waiting(document: &Document) -> String {
    let needed = document.pairs_needed();
    if document.pictures.is_none() {
        return "Open two pictures of the same scene.".into();
    }
    if let Some(hint) = document.too_small() {
        return hint;
    }
    let more = needed.saturating_sub(document.used().count());
    match more {
        1 => "Mark one more point pair to estimate the epipolar geometry.".into(),
        3 => "Mark three point pairs to estimate the epipolar geometry.".into(),
        _ => "Mark two point pairs to estimate the epipolar geometry.".into(),
    }
}

/// Maximum number of listed names. More pairs are only counted.
const MOST_NAMES: usize = 4;

/// Returns the used pairs in words: `p and q`, or `12 pairs`.
fn used(document: &Document) -> String {
    if document.is_unclicked() {
        return match document.used().count() {
            0 if document.given.is_some() => "the images and the given matches".into(),
            0 => "the images alone, without clicks".into(),
            _ => "the images and one pair".into(),
        };
    }
    let names: Vec<_> = document.used().map(pair_name).collect();
    match names.split_last() {
        _ if names.len() > MOST_NAMES => format!("{} pairs", names.len()),
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => "the pairs".into(),
    }
}

/// Returns a warning if a pair that is only a check lies visibly off its epipolar line.
fn contradicting_check(document: &Document, f: &FundamentalMatrix) -> Option<String> {
    let off = document.parameters.click_sigma * CLICK_DEVIATIONS;
    let checks = (0..document.pairs.len()).filter(|pair| document.role(*pair) == Role::Check);
    let contradicting: Vec<(usize, f64)> = checks
        .filter(|pair| sampson_distance(f, &document.pairs[*pair]) > off)
        .map(|pair| (pair, symmetric_epipolar_distance(f, &document.pairs[pair])))
        .collect();
    let (pair, distance) = contradicting.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let others = match contradicting.len() - 1 {
        0 => String::new(),
        1 => ", and one more is off, too".to_owned(),
        more => format!(", and {more} more are off, too"),
    };
    Some(format!(
        "Pair {}, which is only checked, is {distance:.1} px (symmetric distance) off its epipolar \
         line{others}. Use it in the estimate, or make sure that both points show the same scene \
         point.",
        pair_name(pair)
    ))
}

/// Names of the used pairs in the window, and their symmetric distances.
struct WindowNames<'a> {
    document: &'a Document,
    fundamental: Option<&'a FundamentalMatrix>,
}

impl WindowNames<'_> {
    /// Returns the place in the list of a pair that the estimator numbers from 1.
    fn place(&self, pair: usize) -> Option<usize> {
        self.document.used().nth(pair.checked_sub(1)?)
    }
}

impl PairNames for WindowNames<'_> {
    fn name(&self, pair: usize) -> String {
        self.place(pair).map_or_else(|| PairNumbers.name(pair), pair_name)
    }

    fn off_line(&self, pair: usize, distance: f64) -> String {
        let clicked = self.place(pair).and_then(|place| self.document.pairs.get(place));
        match (self.fundamental, clicked) {
            (Some(f), Some(clicked)) => {
                format!("{:.1} px (symmetric distance)", symmetric_epipolar_distance(f, clicked))
            }
            _ => PairNumbers.off_line(pair, distance),
        }
    }
}
