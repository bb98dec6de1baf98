//! Record of a running search: stage, times, counts, pencils of the present clicks, and the time of
//! the first geometry.

use std::sync::Arc;
use std::time::Instant;

use super::event_log::EventLog;
use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::{ComparedPencils, LineCandidate};
use crate::estimate::evidence::patches::{PatchLevels, SupportLevel};
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::{
    Clicks, DistinctMatch, Estimate, EstimateError, EventKind, HypothesisNote, Monitor, Parameters, Progress,
    RankedHypothesis, SearchCounts, SearchTrace, Stage, StageTiming,
};
use crate::features::FeatureMatch;

/// Record of one search.
pub(in crate::estimate) struct SearchRecord<'a> {
    monitor: &'a Monitor<'a>,
    begun: Instant,
    stage: Stage,
    stage_begun: Instant,
    timings: Vec<StageTiming>,
    first_seconds: Option<f64>,
    /// Pencils through the anchors of the present clicks. They change with the clicks.
    pencils: Vec<Arc<ComparedPencils>>,
    /// Numbers of lines and candidates in the search with all lines.
    pub lines_alone: Option<([usize; 2], usize)>,
    /// Numbers of examined lines and hypotheses so far.
    pub counts: SearchCounts,
    events: EventLog,
}

impl<'a> SearchRecord<'a> {
    /// Returns the record of a search that began at `begun`.
    pub fn new(begun: Instant, monitor: &'a Monitor<'a>) -> Self {
        Self {
            monitor,
            begun,
            stage: Stage::Pyramid,
            stage_begun: begun,
            timings: Vec::new(),
            first_seconds: None,
            pencils: Vec::new(),
            lines_alone: None,
            counts: SearchCounts::default(),
            events: EventLog::default(),
        }
    }

    fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    /// Writes an event, and reports it.
    pub fn note(&mut self, kind: EventKind) {
        self.events.push(self.seconds(), kind);
        self.report();
    }

    /// Reports the last event.
    fn report(&self) {
        if let Some(event) = self.events.events().last() {
            self.monitor.report(Progress::Happened(event.clone()));
        }
    }

    /// Writes that features were matched.
    pub fn note_matches(&mut self, matches: &[FeatureMatch]) {
        let found = matches.iter().map(|m| DistinctMatch { pair: m.pair, ratio: m.ratio });
        self.events.matched(self.seconds(), found);
        self.report();
    }

    /// Writes that all lines were compared: the number of lines, lines with their best partners, and candidates, best
    /// first. `scales` leads from full size to the pixels of these lines.
    pub fn note_lines(
        &mut self,
        compared: [usize; 2],
        swept: &[LineCandidate],
        candidates: &[LineCandidate],
        scales: [f64; 2],
    ) {
        self.events.lines(self.seconds(), compared, [swept, candidates], scales);
        self.report();
    }

    /// Writes proposals, best first, and the number of combinations or samples that were examined.
    pub fn note_proposals(&mut self, examined: usize, proposals: &[HypothesisNote]) {
        self.events.proposed(self.seconds(), examined, proposals);
        self.report();
    }

    /// Writes the best different hypotheses, best first, with the course of their support at this size, if they
    /// have one.
    pub fn note_ranking(&mut self, hypotheses: &[Estimate], level: Option<&SupportLevel>) {
        let ranked = |one: &Estimate| {
            let hypothesis = one.noted()?;
            let at_level = level.and_then(|level| Some((level, one.fundamental().rescaled(level.scales)?)));
            let course = at_level.map_or_else(Vec::new, |(level, f)| level.support.course(&f));
            Some(RankedHypothesis { hypothesis, course })
        };
        self.note_race(hypotheses.iter().filter_map(ranked));
    }

    /// Writes hypotheses with the course of their support, best first.
    pub fn note_race(&mut self, ranked: impl Iterator<Item = RankedHypothesis>) {
        self.events.ranked(self.seconds(), ranked);
        self.report();
    }

    /// Returns the flag that stops the search.
    pub fn cancel(&self) -> &'a CancelFlag {
        self.monitor.cancel()
    }

    /// Ends the previous stage and begins `stage`. Fails if the search is cancelled.
    pub fn enter(&mut self, stage: Stage) -> Result<(), EstimateError> {
        self.end_stage();
        self.stage = stage;
        self.note(EventKind::Began(stage));
        Ok(self.monitor.cancel().check()?)
    }

    fn end_stage(&mut self) {
        let now = Instant::now();
        let seconds = (now - self.stage_begun).as_secs_f64();
        // A search may enter a stage several times.
        match self.timings.iter_mut().find(|timing| timing.stage == self.stage) {
            Some(timing) => timing.seconds += seconds,
            None => self.timings.push(StageTiming { stage: self.stage, seconds }),
        }
        self.stage_begun = now;
    }

    /// Records and reports the pencils through the anchors of these clicks. Replaces the previous
    /// pencils. Fails if a pencil has no candidates.
    pub fn pencils(
        &mut self,
        clicks: &Clicks,
        pencils: Vec<Arc<ComparedPencils>>,
    ) -> Result<(), EstimateError> {
        let candidates = pencils.iter().map(|compared| compared.candidates.len()).collect();
        self.note(EventKind::Pencils { anchors: clicks.anchors(), candidates });
        let without = pencils.iter().position(|compared| compared.candidates.is_empty());
        self.pencils = pencils;
        if let Some(anchor) = without {
            // The user cannot move a match that stands in for a click.
            let number = clicks.anchor_numbers().get(anchor).copied().flatten();
            return Err(number.map_or(EstimateError::NoGeometry, EstimateError::NoCandidates));
        }
        self.monitor.report(Progress::Pencils(self.pencils.clone()));
        Ok(())
    }

    /// Returns the pencils through the present anchors.
    pub fn present_pencils(&self) -> &[Arc<ComparedPencils>] {
        &self.pencils
    }

    /// Reports a geometry good enough to draw.
    pub fn preliminary(&mut self, found: Estimate, hypotheses: &[Estimate], viewed: &ViewedPair) {
        let SearchInput { clicks, parameters, .. } = viewed.input;
        self.first_seconds.get_or_insert(self.begun.elapsed().as_secs_f64());
        let trace = self.trace(clicks, &self.pencils, &viewed.patches, hypotheses.to_vec(), parameters);
        let trace = Some(Arc::new(trace));
        self.monitor.report(Progress::Preliminary(Box::new(Estimate { trace, ..found })));
    }

    /// Ends the last stage. Fails if the search is cancelled.
    pub fn finish(&mut self) -> Result<(), EstimateError> {
        self.end_stage();
        Ok(self.monitor.cancel().check()?)
    }

    /// Returns the trace so far, with the hypotheses and pencils of these clicks.
    pub fn trace(
        &self,
        clicks: &Clicks,
        pencils: &[Arc<ComparedPencils>],
        patches: &PatchLevels,
        hypotheses: Vec<Estimate>,
        parameters: &Parameters,
    ) -> SearchTrace {
        let seconds = self.seconds();
        let mut counts = self.counts.clone();
        let through_clicks = pencils.iter().map(|one| (one.lines_compared(), one.candidates.len()));
        for ([lines1, lines2], candidates) in through_clicks.chain(self.lines_alone) {
            counts.lines1.push(lines1);
            counts.lines2.push(lines2);
            counts.candidates.push(candidates);
        }
        SearchTrace {
            clicks: clicks.clone(),
            view: patches.view(),
            features: patches.features(),
            preset: parameters.preset,
            seed: parameters.seed,
            pencils: pencils.to_vec(),
            hypotheses,
            events: self.events.events().to_vec(),
            counts,
            timings: self.timings.clone(),
            first_seconds: self.first_seconds.unwrap_or(seconds),
            seconds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::checks::little_texture;
    use crate::estimate::{ClickRole, PreparedPair, SearchPlan, Warning};
    use crate::features::FeatureViews;
    use crate::geometry::{Frame, PointPair};
    use crate::image::{GrayPlane, RelativeView};

    /// Returns clicks of which the first and the last are far apart, so they are the anchors.
    fn clicks() -> Clicks {
        let at = |x: f64| PointPair::new(x, x, x, x);
        let clicks = Clicks::for_plan(&[at(10.0), at(12.0), at(90.0)], SearchPlan::Patches { clicks: 2 });
        assert_eq!(clicks.anchors(), [at(10.0), at(90.0)]);
        clicks
    }

    /// Returns pencils through the anchors with these numbers of textured lines.
    fn pencils(clicks: &Clicks, textured: [usize; 2]) -> Vec<Arc<ComparedPencils>> {
        let one = |(click, textured)| Arc::new(ComparedPencils::of_so_many(click, textured, 60));
        clicks.anchors().into_iter().zip(textured).map(one).collect()
    }

    #[test]
    fn a_pair_without_texture_is_named_by_the_number_of_its_click() {
        let (clicks, monitor) = (clicks(), Monitor::silent());
        let mut record = SearchRecord::new(Instant::now(), &monitor);
        assert!(record.pencils(&clicks, pencils(&clicks, [30, 19])).is_ok());
        let warnings = little_texture(&clicks, record.present_pencils());
        assert_eq!(warnings, [Warning::LittleTexture { pair: 3, textured: 19, lines: 60 }]);
        let nothing = record.pencils(&clicks, pencils(&clicks, [30, 0]));
        assert!(matches!(nothing, Err(EstimateError::NoCandidates(3))));
        // Matches that stand in for clicks have no number.
        let unclicked = Clicks::default().with_chosen([clicks.anchors()[0], clicks.anchors()[1]]);
        assert!(unclicked.iter().all(|click| click.role == ClickRole::Chosen));
        assert!(record.pencils(&unclicked, pencils(&unclicked, [30, 19])).is_ok());
        assert_eq!(little_texture(&unclicked, record.present_pencils()), []);
        let nothing = record.pencils(&unclicked, pencils(&unclicked, [0, 30]));
        assert!(matches!(nothing, Err(EstimateError::NoGeometry)));
    }

    #[test]
    fn a_trace_has_the_pencils_of_its_own_clicks() {
        let (first, monitor) = (clicks(), Monitor::silent());
        let [p, q] = [PointPair::new(40.0, 20.0, 41.0, 20.0), PointPair::new(5.0, 80.0, 6.0, 80.0)];
        let second = Clicks::default().with_chosen([p, q]);
        let mut record = SearchRecord::new(Instant::now(), &monitor);
        record.lines_alone = Some(([7, 8], 9));
        record.pencils(&first, pencils(&first, [30, 40])).unwrap();
        let of_first = record.present_pencils().to_vec();
        record.pencils(&second, pencils(&second, [50, 60])).unwrap();
        // The result of the first search is selected.
        let plane = GrayPlane::from_fn(Frame::new(64, 64), |x, y| ((x * y) % 251) as f32);
        let patches = PreparedPair::new(&plane, &plane)
            .patches_with_features(RelativeView::UPRIGHT, FeatureViews::Frontal);
        let trace = record.trace(&first, &of_first, &patches, Vec::new(), &Parameters::default());
        let shown: Vec<PointPair> = trace.pencils.iter().map(|pencils| pencils.click).collect();
        assert_eq!(shown, trace.clicks.anchors());
        assert_eq!((trace.counts.lines1, trace.counts.lines2), (vec![30, 40, 7], vec![30, 40, 8]));
        assert_eq!(trace.counts.candidates, [30, 40, 9]);
    }

    #[test]
    fn a_stage_that_is_entered_again_is_timed_as_one() {
        let monitor = Monitor::silent();
        let mut record = SearchRecord::new(Instant::now(), &monitor);
        for stage in [Stage::Pencils, Stage::Validation, Stage::Features, Stage::Validation] {
            record.enter(stage).unwrap();
        }
        record.finish().unwrap();
        let stages: Vec<Stage> = record.timings.iter().map(|timing| timing.stage).collect();
        assert_eq!(stages, [Stage::Pyramid, Stage::Pencils, Stage::Validation, Stage::Features]);
        let total: f64 = record.timings.iter().map(|timing| timing.seconds).sum();
        assert!((total - (record.stage_begun - record.begun).as_secs_f64()).abs() < 1e-6);
    }
}
