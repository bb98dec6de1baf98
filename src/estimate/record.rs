//! What a search notes on its way: the stage it is in, times, counts, warnings, the first geometry.

use std::sync::Arc;
use std::time::Instant;

use super::lines::ComparedPencils;
use super::patches::PatchLevels;
use super::{
    Clicks, Estimate, EstimateError, Monitor, Parameters, Progress, SearchCounts, SearchTrace, Stage,
    StageTiming, Warning,
};

/// A pair has little texture where fewer than one in so many of its lines have some: then few lines can tell anything. A
/// round number.
const LITTLE_TEXTURE: usize = 3;

/// The notes of one search.
pub(super) struct SearchRecord<'a> {
    monitor: &'a Monitor<'a>,
    begun: Instant,
    stage: Stage,
    stage_begun: Instant,
    timings: Vec<StageTiming>,
    first_seconds: Option<f64>,
    pencils: Vec<Arc<ComparedPencils>>,
    /// How much was examined so far.
    pub counts: SearchCounts,
    /// What the user should know, whatever the result.
    pub warnings: Vec<Warning>,
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
            counts: SearchCounts::default(),
            warnings: Vec::new(),
        }
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

    /// Notes and reports the pencils; an error when there is nothing to go on with.
    pub fn pencils(&mut self, pencils: &[Arc<ComparedPencils>]) -> Result<(), EstimateError> {
        for (k, compared) in pencils.iter().enumerate() {
            let [lines1, lines2] = compared.lines_compared();
            self.counts.lines1.push(lines1);
            self.counts.lines2.push(lines2);
            self.counts.candidates.push(compared.candidates.len());
            if compared.candidates.is_empty() {
                return Err(EstimateError::NoCandidates { pair: k + 1 });
            }
            let before = [(lines1, compared.lines_before[0]), (lines2, compared.lines_before[1])];
            if let Some((textured, lines)) =
                before.into_iter().find(|(textured, lines)| LITTLE_TEXTURE * textured < *lines)
            {
                self.warnings.push(Warning::LittleTexture { pair: k + 1, textured, lines });
            }
        }
        self.pencils = pencils.to_vec();
        self.monitor.report(Progress::Pencils(self.pencils.clone()));
        Ok(())
    }

    /// Notes lines that were compared without any point.
    pub fn lines_alone(&mut self, lines: [usize; 2], candidates: usize) {
        self.counts.lines1.push(lines[0]);
        self.counts.lines2.push(lines[1]);
        self.counts.candidates.push(candidates);
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
        let trace = Some(Arc::new(self.trace(clicks, patches, hypotheses.to_vec(), parameters)));
        self.monitor.report(Progress::Preliminary(Box::new(Estimate { trace, ..found })));
    }

    /// Ends the last stage, unless a stop was asked for.
    pub fn finish(&mut self) -> Result<(), EstimateError> {
        self.end_stage();
        Ok(self.monitor.cancel().check()?)
    }

    /// The notes so far, with the hypotheses.
    pub fn trace(
        &self,
        clicks: &Clicks,
        patches: &PatchLevels,
        hypotheses: Vec<Estimate>,
        parameters: &Parameters,
    ) -> SearchTrace {
        let seconds = self.begun.elapsed().as_secs_f64();
        SearchTrace {
            clicks: clicks.clone(),
            view: patches.view(),
            features: patches.has_features(),
            method: parameters.method,
            preset: parameters.preset,
            seed: parameters.seed,
            pencils: self.pencils.clone(),
            hypotheses,
            counts: self.counts.clone(),
            timings: self.timings.clone(),
            first_seconds: self.first_seconds.unwrap_or(seconds),
            seconds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
