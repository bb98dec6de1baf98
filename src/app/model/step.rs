//! Progress and findings of each step of the algorithm, in words.

use super::computation::{Computation, Freshness};
use super::document::{Document, pair_name};
use super::ids::MethodStep;
use super::verdict::line_score_text;
use crate::estimate::{SearchPlan, Stage};
use crate::features::FeatureViews;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepProgress {
    Waiting,
    Running,
    /// Done, with the seconds if known.
    Done(Option<f64>),
    /// The user stopped the computation here.
    Stopped,
    /// The computation failed here.
    Failed,
}

pub fn progress(stage: Stage, computation: &Computation) -> StepProgress {
    if let Some((estimate, Freshness::Final)) = computation.result() {
        let mut timings = estimate.trace.iter().flat_map(|trace| &trace.timings);
        let timing = timings.find(|timing| timing.stage == stage);
        return StepProgress::Done(timing.map(|timing| timing.seconds));
    }
    // The first step is not announced. It runs from the start until the next step begins.
    let begun = computation.stages();
    let position = begun.iter().position(|(other, _)| *other == stage);
    let took = position.and_then(|k| begun[k].1);
    match (position, took) {
        (_, Some(took)) => StepProgress::Done(Some(took.as_secs_f64())),
        (None, None) if stage == Stage::Pyramid && !begun.is_empty() => StepProgress::Done(None),
        (None, None) if stage != Stage::Pyramid || !computation.has_begun() => StepProgress::Waiting,
        _ if computation.is_running() => StepProgress::Running,
        _ if computation.failure().is_some() => StepProgress::Failed,
        _ => StepProgress::Stopped,
    }
}

impl MethodStep {
    /// Returns the stages of the computation that belong to the step.
    pub fn stages(self) -> &'static [Stage] {
        match self {
            Self::Pencils | Self::Barcodes => &[Stage::Pyramid, Stage::Pencils],
            Self::Motion | Self::Candidates | Self::RoundTrip => &[],
            Self::Features => &[Stage::Features],
            Self::Epipoles => &[Stage::Hypotheses],
            Self::Validation => &[Stage::Validation],
            Self::Refinement => &[Stage::Refinement],
        }
    }
}

/// Returns the progress of a step: of its last stage that has begun, or of the step before it.
pub fn progress_of(step: MethodStep, computation: &Computation) -> StepProgress {
    // A stage repeated by the wider search is not shown as running twice.
    let of = |stages: &[Stage]| stages.iter().map(|stage| progress(*stage, computation)).reduce(later);
    match step {
        // The silhouettes are known before the search.
        MethodStep::Motion => without_time(progress(Stage::Pyramid, computation)),
        MethodStep::Candidates => without_time(progress(Stage::Pencils, computation)),
        MethodStep::RoundTrip => without_time(progress(Stage::Hypotheses, computation)),
        MethodStep::Pencils | MethodStep::Barcodes => progress(Stage::Pencils, computation),
        _ => of(step.stages()).unwrap_or(StepProgress::Waiting),
    }
}

/// Sums the times of two stages; a running or failed stage prevails.
fn later(first: StepProgress, second: StepProgress) -> StepProgress {
    use StepProgress::{Done, Failed, Running, Stopped, Waiting};
    match (first, second) {
        (Waiting, other) | (other, Waiting) => other,
        (Done(a), Done(b)) => Done(a.zip(b).map(|(a, b)| a + b).or(a).or(b)),
        (Running, _) | (_, Running) => Running,
        (Failed, _) | (_, Failed) => Failed,
        (Stopped, _) | (_, Stopped) => Stopped,
    }
}

fn without_time(progress: StepProgress) -> StepProgress {
    match progress {
        StepProgress::Done(_) => StepProgress::Done(None),
        other => other,
    }
}

/// Returns the title of a step in a search.
pub fn title(step: MethodStep, plan: SearchPlan) -> &'static str {
    match (step, plan) {
        // Lines through two matches test the result.
        (MethodStep::Pencils, SearchPlan::Unclicked) => "Lines",
        _ => step.title(),
    }
}

/// Explains a step of a search in one or two sentences.
pub fn sentence(step: MethodStep, plan: SearchPlan) -> &'static str {
    let (compares_all, by_barcodes) =
        (matches!(plan, SearchPlan::Barcodes | SearchPlan::LinesAlone { .. }), plan == SearchPlan::Barcodes);
    match step {
        MethodStep::Motion => {
            "Neither camera moves. What differs from the background moves: its silhouettes pile up, frame by frame."
        }
        MethodStep::Barcodes => {
            "The barcode of a line marks the frames in which something crosses it. A line sweeps on the left. Its best \
             partner on the right is crossed in the same frames."
        }
        MethodStep::Pencils if plan == SearchPlan::Unclicked => {
            "As a test, lines through two matches are compared: each with its most similar line on the right."
        }
        MethodStep::Pencils => {
            "A line turns about a clicked point on the left. Its best partner on the right is the line with the most similar \
             brightness."
        }
        MethodStep::Candidates => {
            "Candidates are line pairs of which each line is among the best partners of the other."
        }
        MethodStep::Features => {
            "Distinctive places are matched by their surroundings, anywhere in the pictures. Matches that fit no \
             common geometry fade."
        }
        MethodStep::Epipoles if plan == SearchPlan::Unclicked => {
            "Small samples of the matches give hypotheses. Each has an epipole in either picture: where the other \
             camera might be."
        }
        MethodStep::Epipoles if by_barcodes => {
            "Two or three candidates at a time give a hypothesis. Where they cross, the other camera might be."
        }
        MethodStep::Epipoles if compares_all => {
            "Three line pairs at a time give a hypothesis. Each has an epipole in either picture: where the other \
             camera might be."
        }
        MethodStep::Epipoles => {
            "A candidate of p and one of q cross. Where they cross, the other camera might be: a hypothesis."
        }
        MethodStep::RoundTrip => {
            "Two candidates fix two maps: H takes lines through the left epipole to the right picture, G takes them back. \
             The area between l and G H l tells how well both agree. Wrong hypotheses may have a small one, too."
        }
        MethodStep::Validation if by_barcodes => {
            "The best hypotheses race: each is fitted to the barcodes of lines all over both pictures. The best fit wins."
        }
        MethodStep::Validation => {
            "The best hypotheses race: each place of the picture supports those along whose lines it finds a match."
        }
        MethodStep::Refinement if by_barcodes => {
            "The lines swing from the winning hypothesis to its fit, in full size at last. Fits without some frames give \
             its uncertainty."
        }
        MethodStep::Refinement => {
            "The best hypothesis is fitted to matches along its lines, again and again."
        }
    }
}

/// Writes a duration with a suitable unit.
pub fn duration(seconds: f64) -> String {
    let ms = seconds * 1000.0;
    if ms < 0.095 {
        "< 0.1 ms".to_owned()
    } else if ms < 9.95 {
        format!("{ms:.1} ms")
    } else if ms < 999.5 {
        format!("{ms:.0} ms")
    } else {
        format!("{seconds:.2} s")
    }
}

/// Describes the findings of a step in one line; `None` without any.
pub fn result_text(stage: Stage, document: &Document, computation: &Computation) -> Option<String> {
    // Findings about earlier points do not apply to the current ones.
    let result = computation.result().filter(|(_, freshness)| !freshness.is_behind());
    let estimate = result.map(|(estimate, _)| estimate);
    match stage {
        Stage::Pyramid => None,
        Stage::Pencils => {
            let pencils = computation.pencils()?;
            let name = |k: usize| {
                let pair = document.pair_of_pencils(k, &pencils[k].click);
                pair.map_or_else(|| format!("match {}", k + 1), pair_name)
            };
            let of = |k: usize| {
                let own = &pencils[k];
                format!(
                    "{}: {} × {} lines, {} candidates",
                    name(k),
                    own.angles1.len(),
                    own.angles2.len(),
                    own.candidates.len()
                )
            };
            Some(format!("{}; {}", of(0), of(1)))
        }
        Stage::Hypotheses => {
            let tried = estimate?.trace.as_ref()?.counts.hypotheses;
            (tried > 0).then(|| format!("{} tried", grouped(tried)))
        }
        Stage::Validation => {
            let (score, trace) = (estimate?.line_score()?, estimate?.trace.as_ref()?);
            let score = line_score_text(document.parameters.validation.line_score, score);
            // Without a validation, the result was the only hypothesis.
            Some(match trace.counts.validated {
                0 => format!("line cost {score}"),
                validated => format!("{validated} compared, line cost of the result {score}"),
            })
        }
        Stage::Refinement => {
            estimate.filter(|_| matches!(result, Some((_, Freshness::Final)))).map(|estimate| {
                if let Some(barcodes) = &estimate.assessment.barcodes {
                    format!("fitted to the barcodes of {} frames", barcodes.frames)
                } else if estimate.is_refined() {
                    format!("fitted to {} matches", estimate.matches().len())
                } else {
                    "not refined on patches".to_owned()
                }
            })
        }
        Stage::Features => {
            let trace = estimate?.trace.as_ref()?;
            trace.timings.iter().find(|timing| timing.stage == stage)?;
            let degrees = trace.view.rotation.to_degrees().round();
            let turned = (degrees != 0.0).then(|| format!("turned by {degrees:.0}°"));
            let scale = trace.view.scale.map(|scale| format!("scaled by {scale:.2}"));
            let changes: Vec<String> = turned.into_iter().chain(scale).collect();
            let view = match changes.join(", ") {
                none if none.is_empty() => "right image upright".to_owned(),
                changes => format!("right image {changes}"),
            };
            Some(match trace.features {
                Some(FeatureViews::Frontal) => view,
                Some(FeatureViews::Slanted) => format!("{view}, with slanted features"),
                None => "the upright view remains the best".to_owned(),
            })
        }
    }
}

/// Returns a number with separated thousands.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::fake;
    use crate::app::model::computation::{EstimateFailure, EstimateNews};
    use crate::estimate::{EstimateError, Event, EventKind};

    fn began(stage: Stage) -> EstimateNews {
        EstimateNews::Happened(Event { seconds: 0.0, kind: EventKind::Began(stage) })
    }

    fn after(stages: &[Stage], error: Option<EstimateError>) -> Computation {
        let mut computation = Computation::default();
        let request = fake::request(1.0);
        computation.adopt(Some(&request));
        computation.begin(1, false);
        for stage in stages {
            computation.take(1, began(*stage));
        }
        let estimate = || Box::new(fake::result(&request.pairs, &request.parameters).unwrap());
        let result = error.map_or_else(|| Ok(estimate()), |error| Err(EstimateFailure::Estimate(error)));
        computation.take(1, EstimateNews::Finished(result));
        computation
    }

    #[test]
    fn a_failure_is_shown_at_its_step() {
        let of = |computation: &Computation| Stage::ALL.map(|stage| progress(stage, computation));
        let idle = Computation::default();
        assert_eq!(of(&idle), [StepProgress::Waiting; 6]);
        let refused = of(&after(&[], Some(EstimateError::NoGeometry)));
        assert_eq!((refused[0], refused[1]), (StepProgress::Failed, StepProgress::Waiting));
        let failed = of(&after(&[Stage::Pencils, Stage::Hypotheses], Some(EstimateError::NoGeometry)));
        assert!(matches!(failed[1], StepProgress::Done(Some(_))));
        assert_eq!(
            [failed[0], failed[2], failed[3]],
            [StepProgress::Done(None), StepProgress::Failed, StepProgress::Waiting]
        );
        assert_eq!(of(&after(&[Stage::Pencils], None)), [StepProgress::Done(None); 6]);
    }

    #[test]
    fn a_step_repeated_by_a_wider_search_runs_again() {
        let mut computation = Computation::default();
        computation.adopt(Some(&fake::request(1.0)));
        computation.begin(1, false);
        for stage in [Stage::Pencils, Stage::Validation, Stage::Features, Stage::Validation] {
            computation.take(1, began(stage));
        }
        let state = |computation: &Computation, stage| progress(stage, computation);
        assert_eq!(state(&computation, Stage::Validation), StepProgress::Running);
        assert!(matches!(state(&computation, Stage::Features), StepProgress::Done(Some(_))));
        let first = computation.stages()[0];
        computation.take(1, began(Stage::Refinement));
        assert!(matches!(state(&computation, Stage::Validation), StepProgress::Done(Some(_))));
        let stages: Vec<Stage> = computation.stages().iter().map(|(stage, _)| *stage).collect();
        assert_eq!(stages, [Stage::Pencils, Stage::Validation, Stage::Features, Stage::Refinement]);
        assert_eq!(computation.stages()[0], first);
    }

    #[test]
    fn thousands_are_separated() {
        assert_eq!([1, 999, 12_000, 1_234_567].map(grouped), ["1", "999", "12,000", "1,234,567"]);
    }
}
