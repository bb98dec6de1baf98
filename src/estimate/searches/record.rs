//! What a search notes on its way: the stage it is in, times, counts, the pencils of the present clicks, the first geometry.

use std::sync::Arc;
use std::time::Instant;

use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::ComparedPencils;
use crate::estimate::evidence::patches::PatchLevels;
use crate::estimate::{
    Clicks, Estimate, EstimateError, Monitor, Parameters, Progress, SearchCounts, SearchTrace, Stage,
    StageTiming,
};

/// The notes of one search.
pub(in crate::estimate) struct SearchRecord<'a> {
    monitor: &'a Monitor<'a>,
    begun: Instant,
    stage: Stage,
    stage_begun: Instant,
    timings: Vec<StageTiming>,
    first_seconds: Option<f64>,
    /// Through the anchors of the present clicks; a search through other clicks has others.
    pencils: Vec<Arc<ComparedPencils>>,
    /// Lines that were compared without any point, and candidates among them.
    lines_alone: Option<([usize; 2], usize)>,
    /// How much was examined so far.
    pub counts: SearchCounts,
}

impl<'a> SearchRecord<'a> {
    /// A search that began then.
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
        }
    }

    /// Flag that stops the search.
    pub fn cancel(&self) -> &'a CancelFlag {
        self.monitor.cancel()
    }

    /// Ends the stage before and begins this one, unless a stop was asked for.
    pub fn enter(&mut self, stage: Stage) -> Result<(), EstimateError> {
        self.end_stage();
        self.stage = stage;
        self.monitor.report(Progress::Started(stage));
        Ok(self.monitor.cancel().check()?)
    }

    fn end_stage(&mut self) {
        let now = Instant::now();
        let seconds = (now - self.stage_begun).as_secs_f64();
        // A wider search comes to a stage again.
        match self.timings.iter_mut().find(|timing| timing.stage == self.stage) {
            Some(timing) => timing.seconds += seconds,
            None => self.timings.push(StageTiming { stage: self.stage, seconds }),
        }
        self.stage_begun = now;
    }

    /// Notes and reports the pencils through the anchors of these clicks, in place of those before; an error when there is
    /// nothing to go on with.
    pub fn pencils(
        &mut self,
        clicks: &Clicks,
        pencils: Vec<Arc<ComparedPencils>>,
    ) -> Result<(), EstimateError> {
        let without = pencils.iter().position(|compared| compared.candidates.is_empty());
        self.pencils = pencils;
        if let Some(anchor) = without {
            // Nobody can do anything about a match that stands in for a click.
            let number = clicks.anchor_numbers().get(anchor).copied().flatten();
            return Err(number.map_or(EstimateError::NoGeometry, |pair| EstimateError::NoCandidates { pair }));
        }
        self.monitor.report(Progress::Pencils(self.pencils.clone()));
        Ok(())
    }

    /// The pencils through the present anchors.
    pub fn present_pencils(&self) -> &[Arc<ComparedPencils>] {
        &self.pencils
    }

    /// Notes lines that were compared without any point.
    pub fn lines_alone(&mut self, lines: [usize; 2], candidates: usize) {
        self.lines_alone = Some((lines, candidates));
    }

    /// Reports a geometry that is good enough to draw.
    pub fn preliminary(
        &mut self,
        found: Estimate,
        patches: &PatchLevels,
        hypotheses: &[Estimate],
        clicks: &Clicks,
        parameters: &Parameters,
    ) {
        self.first_seconds.get_or_insert(self.begun.elapsed().as_secs_f64());
        let trace = self.trace(clicks, &self.pencils, patches, hypotheses.to_vec(), parameters);
        let trace = Some(Arc::new(trace));
        self.monitor.report(Progress::Preliminary(Box::new(Estimate { trace, ..found })));
    }

    /// Ends the last stage, unless a stop was asked for.
    pub fn finish(&mut self) -> Result<(), EstimateError> {
        self.end_stage();
        Ok(self.monitor.cancel().check()?)
    }

    /// The notes so far, with the hypotheses and the pencils that go with these clicks.
    pub fn trace(
        &self,
        clicks: &Clicks,
        pencils: &[Arc<ComparedPencils>],
        patches: &PatchLevels,
        hypotheses: Vec<Estimate>,
        parameters: &Parameters,
    ) -> SearchTrace {
        let seconds = self.begun.elapsed().as_secs_f64();
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
            method: parameters.method,
            preset: parameters.preset,
            seed: parameters.seed,
            pencils: pencils.to_vec(),
            hypotheses,
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
    use crate::estimate::verdict::assessment::little_texture;
    use crate::estimate::{ClickRole, PreparedPair, SearchPlan, Warning};
    use crate::features::FeatureViews;
    use crate::geometry::{Frame, PointPair};
    use crate::image::{GrayPlane, RelativeView};

    /// Far apart are the first and the last, so that pencils pass through these.
    fn clicks() -> Clicks {
        let at = |x: f64| PointPair::new(x, x, x, x);
        let clicks = Clicks::for_plan(&[at(10.0), at(12.0), at(90.0)], SearchPlan::Patches { clicks: 2 });
        assert_eq!(clicks.anchors(), [at(10.0), at(90.0)]);
        clicks
    }

    /// Pencils through the anchors, with so many lines that have texture.
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
        assert!(matches!(nothing, Err(EstimateError::NoCandidates { pair: 3 })));
        // Nobody placed a match that stands in for a click.
        let unclicked = Clicks::default().with_chosen([clicks.anchors()[0], clicks.anchors()[1]]);
        assert!(unclicked.iter().all(|click| click.role == ClickRole::Chosen));
        assert!(record.pencils(&unclicked, pencils(&unclicked, [30, 19])).is_ok());
        assert_eq!(little_texture(&unclicked, record.present_pencils()), []);
        let nothing = record.pencils(&unclicked, pencils(&unclicked, [0, 30]));
        assert!(matches!(nothing, Err(EstimateError::NoGeometry)));
    }

    #[test]
    fn pencils_are_those_of_the_clicks_they_are_shown_with() {
        let (first, monitor) = (clicks(), Monitor::silent());
        let [p, q] = [PointPair::new(40.0, 20.0, 41.0, 20.0), PointPair::new(5.0, 80.0, 6.0, 80.0)];
        let second = Clicks::default().with_chosen([p, q]);
        let mut record = SearchRecord::new(Instant::now(), &monitor);
        record.lines_alone([7, 8], 9);
        record.pencils(&first, pencils(&first, [30, 40])).unwrap();
        let of_first = record.present_pencils().to_vec();
        record.pencils(&second, pencils(&second, [50, 60])).unwrap();
        // The first search is the one that is chosen after all.
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
