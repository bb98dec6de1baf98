//! The steps of a search on a time axis.

use super::record::Record;
use crate::app::model::ids::MethodStep;
use crate::estimate::SearchPlan;

/// A moment of the replay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    pub step: MethodStep,
    /// Time since the step began, s at the usual speed.
    pub seconds: f64,
}

/// Whether a step took part in the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepState {
    /// Before the search, or not yet in a running one.
    Waiting,
    Ran,
    /// The search had its result without the step.
    NotNeeded,
    /// The search ended before the step.
    NotReached,
}

impl StepState {
    /// Returns why the step has nothing to show.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::NotNeeded => "This search did not need it.",
            Self::NotReached => "The search ended before it.",
            Self::Waiting | Self::Ran => "",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimedStep {
    pub step: MethodStep,
    /// Length on the axis, s; also of steps that did not run.
    pub seconds: f64,
    pub state: StepState,
}

/// The steps of a search, in their order on the axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    pub steps: Vec<TimedStep>,
}

/// Returns the steps of a search with their lengths, s. All take ten seconds together.
fn planned(plan: SearchPlan) -> &'static [(MethodStep, f64)] {
    use MethodStep::{
        Barcodes, Candidates, Epipoles, Features, Matches, Motion, Pencils, Refinement, RoundTrip, Validation,
    };
    match plan {
        SearchPlan::Published { .. } | SearchPlan::Patches { .. } => &[
            (Pencils, 2.2),
            (Candidates, 1.2),
            (Features, 1.2),
            (Epipoles, 1.8),
            (RoundTrip, 1.6),
            (Validation, 1.0),
            (Refinement, 1.0),
        ],
        // The pencils pass through two matches. They come last, as a test.
        SearchPlan::Unclicked => &[
            (Features, 2.2),
            (Matches, 2.2),
            (Epipoles, 2.0),
            (Validation, 1.4),
            (Refinement, 1.2),
            (Pencils, 1.0),
        ],
        SearchPlan::Barcodes => &[
            (Motion, 1.6),
            (Barcodes, 2.2),
            (Candidates, 1.2),
            (Epipoles, 1.8),
            (Validation, 1.6),
            (Refinement, 1.6),
        ],
        SearchPlan::LinesAlone { .. } => {
            &[(Epipoles, 4.0), (RoundTrip, 2.0), (Validation, 2.0), (Refinement, 2.0)]
        }
    }
}

/// Returns the length of a step in a search with clicks, or else in one of sequences or without clicks, s. The drawings
/// of the steps are made for it.
fn usual(step: MethodStep) -> f64 {
    let plans = [SearchPlan::Patches { clicks: 2 }, SearchPlan::Barcodes, SearchPlan::Unclicked];
    let mut steps = plans.into_iter().flat_map(planned).copied();
    steps.find(|(own, _)| *own == step).map_or(1.0, |(_, seconds)| seconds)
}

impl Place {
    /// Returns the time at which the usual search shows the same of this step, s.
    pub(super) fn usual_seconds(self, plan: SearchPlan) -> f64 {
        let own = planned(plan).iter().find(|(step, _)| *step == self.step);
        own.map_or(self.seconds, |(_, length)| self.seconds / length * usual(self.step))
    }
}

impl Course {
    fn with(plan: SearchPlan, state: impl Fn(MethodStep) -> StepState) -> Self {
        let timed = |(step, seconds): &(MethodStep, f64)| TimedStep {
            step: *step,
            seconds: *seconds,
            state: state(*step),
        };
        Self { steps: planned(plan).iter().map(timed).collect() }
    }

    /// Returns the steps before a search.
    pub fn planned(plan: SearchPlan) -> Self {
        Self::with(plan, |_| StepState::Waiting)
    }

    pub fn of_running(plan: SearchPlan, record: &Record) -> Self {
        Self::with(plan, |step| if record.has(step) { StepState::Ran } else { StepState::Waiting })
    }

    pub fn of(plan: SearchPlan, record: &Record) -> Self {
        let missing = if record.has_result() { StepState::NotNeeded } else { StepState::NotReached };
        Self::with(plan, |step| if record.has(step) { StepState::Ran } else { missing })
    }

    /// Returns the steps that have something to show, with their beginnings, s.
    fn ran(&self) -> impl DoubleEndedIterator<Item = (f64, TimedStep)> {
        let ran = self.steps.iter().filter(|step| step.state == StepState::Ran);
        let begun = ran.scan(0.0, |end, step| {
            let begin = *end;
            *end += step.seconds;
            Some((begin, *step))
        });
        begun.collect::<Vec<_>>().into_iter()
    }

    /// Returns the length of the replay, s.
    pub fn length(&self) -> f64 {
        self.ran().map(|(_, step)| step.seconds).sum()
    }

    pub fn first(&self) -> Option<Place> {
        self.ran().next().map(|(_, step)| Place { step: step.step, seconds: 0.0 })
    }

    pub fn last(&self) -> Option<Place> {
        self.ran().next_back().map(|(_, step)| Place { step: step.step, seconds: step.seconds })
    }

    pub fn end_of(&self, step: MethodStep) -> Option<Place> {
        let found = self.steps.iter().find(|timed| timed.step == step)?;
        Some(Place { step, seconds: found.seconds })
    }

    /// Returns whether a step has something to show.
    pub fn lasts(&self, step: MethodStep) -> bool {
        self.ran().any(|(_, timed)| timed.step == step)
    }

    /// Returns the time of a moment on the axis, s.
    pub fn at(&self, place: Place) -> f64 {
        let before = self.steps.iter().take_while(|timed| timed.step != place.step);
        let begin: f64 =
            before.filter(|timed| timed.state == StepState::Ran).map(|timed| timed.seconds).sum();
        begin + if self.lasts(place.step) { place.seconds } else { 0.0 }
    }

    /// Returns the moment at a time of the axis; `None` after its end.
    pub fn place(&self, at: f64) -> Option<Place> {
        let (begin, timed) = self.ran().find(|(begin, timed)| at < begin + timed.seconds)?;
        Some(Place { step: timed.step, seconds: (at - begin).max(0.0) })
    }

    /// Returns the moment some seconds later, and whether the replay ends there. A step that is played alone ends
    /// with its last moment.
    pub fn after(&self, place: Place, seconds: f64, alone: bool) -> (Option<Place>, bool) {
        if alone {
            let end = self.end_of(place.step).map_or(0.0, |end| end.seconds);
            let seconds = (place.seconds + seconds).min(end);
            return (Some(Place { seconds, ..place }), seconds >= end);
        }
        let next = self.place(self.at(place) + seconds);
        (next, next.is_none())
    }

    /// Returns the step beside another, or beside the result. All steps can be shown, also those that did not run.
    pub fn neighbour(&self, step: Option<MethodStep>, forward: bool) -> Option<MethodStep> {
        let place = step.and_then(|step| self.steps.iter().position(|timed| timed.step == step));
        let next = match (place, forward) {
            (None, true) => Some(0),
            (None, false) => self.steps.len().checked_sub(1),
            (Some(at), true) => Some(at + 1),
            (Some(at), false) => at.checked_sub(1),
        };
        Some(self.steps.get(next?)?.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Search;

    const CLICKED: SearchPlan = SearchPlan::Patches { clicks: 2 };

    fn ran(plan: SearchPlan, without: &[MethodStep]) -> Course {
        Course::with(plan, |step| if without.contains(&step) { StepState::NotNeeded } else { StepState::Ran })
    }

    #[test]
    fn every_search_takes_ten_seconds() {
        let alone = SearchPlan::LinesAlone { ranked_by: Search::Lines };
        for plan in
            [CLICKED, SearchPlan::Published { clicks: 3 }, SearchPlan::Unclicked, SearchPlan::Barcodes, alone]
        {
            assert!((ran(plan, &[]).length() - 10.0).abs() < 1e-9, "{plan:?}");
        }
    }

    #[test]
    fn a_step_that_did_not_run_takes_no_time() {
        let course = ran(CLICKED, &[MethodStep::Features]);
        assert!((course.length() - 8.8).abs() < 1e-9);
        let place = course.place(3.5).unwrap();
        assert_eq!(place.step, MethodStep::Epipoles);
        assert!((place.seconds - 0.1).abs() < 1e-9 && (course.at(place) - 3.5).abs() < 1e-9);
        assert_eq!(course.place(8.9), None);
        assert!(!course.lasts(MethodStep::Features));
        assert!((course.at(Place { step: MethodStep::Features, seconds: 1.2 }) - 3.4).abs() < 1e-9);
        assert_eq!(Course::planned(CLICKED).first(), None);
        // Steps of other searches are no part of the course.
        let of_sequences = Course::planned(SearchPlan::Barcodes).steps;
        assert!(of_sequences.iter().all(|timed| {
            !matches!(timed.step, MethodStep::Pencils | MethodStep::Features | MethodStep::RoundTrip)
        }));
        let of_clicks = Course::planned(CLICKED).steps;
        assert!(
            of_clicks.iter().all(|timed| !matches!(timed.step, MethodStep::Motion | MethodStep::Barcodes))
        );
    }

    #[test]
    fn a_step_that_is_played_alone_ends_with_its_last_moment() {
        let course = ran(CLICKED, &[]);
        let begin = Place { step: MethodStep::Candidates, seconds: 1.0 };
        let (inside, is_over) = course.after(begin, 0.1, true);
        assert!(!is_over && inside.unwrap().step == MethodStep::Candidates);
        assert_eq!(course.after(begin, 5.0, true), (course.end_of(MethodStep::Candidates), true));
        let (next, is_over) = course.after(begin, 0.3, false);
        assert!(!is_over && next.unwrap().step == MethodStep::Features);
        assert_eq!(course.after(begin, 50.0, false), (None, true));
    }

    #[test]
    fn steps_have_neighbours_and_so_has_the_result() {
        let course = Course::planned(CLICKED);
        let steps: Vec<MethodStep> = course.steps.iter().map(|timed| timed.step).collect();
        let (mut forward, mut now) = (Vec::new(), None);
        while let Some(step) = course.neighbour(now, true) {
            forward.push(step);
            now = Some(step);
        }
        assert_eq!(forward, steps);
        assert_eq!(course.neighbour(None, false), steps.last().copied());
        assert_eq!(course.neighbour(Some(steps[0]), false), None);
    }
}
