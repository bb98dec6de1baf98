//! Progress of each step of the algorithm, and what it does, in words.

use super::computation::{Computation, Freshness};
use super::ids::MethodStep;
use crate::estimate::{SearchPlan, Stage};

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
            Self::Motion | Self::Candidates | Self::Matches | Self::RoundTrip => &[],
            Self::Features => &[Stage::Features],
            Self::Epipoles => &[Stage::Hypotheses],
            Self::Validation => &[Stage::Validation],
            Self::Refinement => &[Stage::Refinement],
        }
    }
}

/// Returns the progress of a step: of its stage, or of the stage of the step before it, which has its time and
/// alone is shown as running.
pub fn progress_of(step: MethodStep, computation: &Computation) -> StepProgress {
    let (stage, has_time) = match step {
        // The silhouettes are known before the search.
        MethodStep::Motion => (Stage::Pyramid, false),
        MethodStep::Pencils | MethodStep::Barcodes => (Stage::Pencils, true),
        MethodStep::Candidates => (Stage::Pencils, false),
        MethodStep::Features => (Stage::Features, true),
        MethodStep::Matches => (Stage::Features, false),
        MethodStep::Epipoles => (Stage::Hypotheses, true),
        MethodStep::RoundTrip => (Stage::Hypotheses, false),
        MethodStep::Validation => (Stage::Validation, true),
        MethodStep::Refinement => (Stage::Refinement, true),
    };
    match progress(stage, computation) {
        StepProgress::Done(_) if !has_time => StepProgress::Done(None),
        StepProgress::Running if !has_time => StepProgress::Waiting,
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
            "As a test of the result, lines through two matches are compared: each with its most similar line on the right."
        }
        MethodStep::Pencils => {
            "A line turns about a clicked point on the left. Its best partner on the right is the line with the most similar \
             brightness."
        }
        MethodStep::Candidates => {
            "Candidates are line pairs of which each line is among the best partners of the other."
        }
        MethodStep::Features if plan == SearchPlan::Unclicked => {
            "Distinctive places are sought in both pictures. Dots mark those with a similar place in the other picture."
        }
        MethodStep::Matches => {
            "Similar places make matches, the most distinctive first. Matches that fit no common geometry fade."
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
            "Two candidates and a third line pair map all lines through the epipoles: H, if the third line is chosen on the \
             left, and G, if on the right. H takes l to H l, and G takes that back to G H l. The nearer to l, the better \
             they agree. Wrong hypotheses may come near, too."
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
    match seconds * 1000.0 {
        ..0.5 => "< 1 ms".to_owned(),
        ms @ ..999.5 => format!("{ms:.0} ms"),
        _ => format!("{seconds:.2} s"),
    }
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
        computation.take(1, began(Stage::Features));
        let of_step = |step| progress_of(step, &computation);
        assert_eq!(of_step(MethodStep::Features), StepProgress::Running);
        assert_eq!(of_step(MethodStep::Matches), StepProgress::Waiting, "one step runs at a time");
        computation.take(1, began(Stage::Validation));
        assert!(matches!(state(&computation, Stage::Features), StepProgress::Done(Some(_))));
        let first = computation.stages()[0];
        computation.take(1, began(Stage::Refinement));
        assert!(matches!(state(&computation, Stage::Validation), StepProgress::Done(Some(_))));
        let stages: Vec<Stage> = computation.stages().iter().map(|(stage, _)| *stage).collect();
        assert_eq!(stages, [Stage::Pencils, Stage::Validation, Stage::Features, Stage::Refinement]);
        assert_eq!(computation.stages()[0], first);
    }
}
