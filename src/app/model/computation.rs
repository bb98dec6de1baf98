//! Where the estimate stands: the latest result, whether it is still being improved, and what went wrong. Which thread
//! finds it is nobody's concern here.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::picture::Pictures;
use super::recording::Synchronised;
use super::revision;
use super::shared::Shared;
use crate::estimate::{ComparedPencils, Estimate, EstimateError, Parameters, Stage};
use crate::geometry::PointPair;

/// What is to be computed; a new estimate is made only when this changes.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateRequest {
    /// The two pictures.
    pub pictures: Pictures,
    /// The sequences, where lines are compared by what moves in them.
    pub recordings: Option<Synchronised>,
    /// The pairs to estimate from.
    pub pairs: Vec<PointPair>,
    /// Everything else.
    pub parameters: Parameters,
}

/// Why there is no result.
#[derive(Debug, Clone, PartialEq)]
pub enum EstimateFailure {
    /// The estimator said why.
    Estimate(EstimateError),
    /// The computation stopped unexpectedly: a fault of the program.
    Panic(String),
}

/// News of a request.
#[derive(Debug)]
pub enum EstimateNews {
    /// A stage has begun.
    Started(Stage),
    /// The pencils through the anchors have been compared.
    Pencils(Vec<Arc<ComparedPencils>>),
    /// A result good enough to draw; better ones follow.
    Preliminary(Box<Estimate>),
    /// The end.
    Finished(Result<Box<Estimate>, EstimateFailure>),
}

/// What a new request means for the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequestChange {
    /// The request is the same.
    None,
    /// The points have moved: what is under way may still give a geometry to follow them from.
    Moved,
    /// The request is another one altogether, or there is none.
    Other,
}

/// How the latest result relates to the points as they are now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freshness {
    /// Final, for the points as they are.
    Final,
    /// A result for the points as they are, still being refined.
    Preliminary,
    /// An earlier geometry of the same images, refitted to the points as they are or were a moment ago; the
    /// search for them goes on.
    Followed,
    /// A result for earlier points; a new one is being computed.
    Stale,
    /// A preliminary result that was stopped before it was refined.
    Stopped,
}

/// The result on the screen.
#[derive(Debug, Clone)]
struct ResultOnScreen {
    /// Which request it belongs to; a result of an earlier one never takes its place.
    generation: u64,
    estimate: Arc<Estimate>,
    freshness: Freshness,
}

/// The estimate of one pair of pictures.
#[derive(Debug, Clone, Default)]
pub struct Computation {
    input: Option<EstimateRequest>,
    /// Generation of the request that `input` is.
    generation: u64,
    running: bool,
    /// The stages of the latest computation that have begun, with when they did.
    begun: Vec<(Stage, Instant)>,
    /// The pencils compared last: of the clicks as they are, or of the ones just before.
    pencils: Vec<Arc<ComparedPencils>>,
    pencils_revision: u64,
    revision: u64,
    shown: Option<ResultOnScreen>,
    /// The latest result of a search through all stages that find the geometry, whichever points it was for.
    found: Option<Arc<Estimate>>,
    /// A first guess of a later search.
    guessed: Option<Arc<Estimate>>,
    failure: Option<EstimateFailure>,
    stopped: bool,
}

impl Computation {
    /// The latest result and how it relates to the points as they are now.
    pub fn result(&self) -> Option<(&Estimate, Freshness)> {
        self.shown.as_ref().map(|shown| (shown.estimate.as_ref(), shown.freshness))
    }

    /// The latest result for those who ask about it off the window's thread.
    pub fn shared_result(&self) -> Option<(Shared<Estimate>, Freshness)> {
        self.shown.as_ref().map(|shown| (Arc::clone(&shown.estimate).into(), shown.freshness))
    }

    /// Whether a computation is under way.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// The stage under way, once it is known.
    pub fn stage(&self) -> Option<Stage> {
        self.begun.last().map(|(stage, _)| *stage)
    }

    /// The stages of the latest computation that have begun, each with the time it took in all; of the one under way,
    /// none.
    pub fn stages(&self) -> Vec<(Stage, Option<Duration>)> {
        let mut stages: Vec<(Stage, Option<Duration>)> = Vec::new();
        for (k, (stage, begun)) in self.begun.iter().enumerate() {
            let took = self.begun.get(k + 1).map(|(_, next)| *next - *begun);
            match stages.iter_mut().find(|(known, _)| known == stage) {
                Some((_, before)) => *before = before.zip(took).map(|(before, took)| before + took),
                None => stages.push((*stage, took)),
            }
        }
        stages
    }

    /// Whether there is a computation at all, under way or over.
    pub fn has_begun(&self) -> bool {
        self.input.is_some()
    }

    /// The pencils compared last, also while newer ones are being compared.
    pub fn pencils(&self) -> Option<&[Arc<ComparedPencils>]> {
        (!self.pencils.is_empty()).then_some(&self.pencils)
    }

    /// The latest result of a search, also while the points have moved on from it.
    pub fn searched(&self) -> Option<&Estimate> {
        let shown = self.shown.as_ref().map(|shown| &shown.estimate);
        let shown = shown.filter(|estimate| estimate.trace.is_some());
        shown.or(self.guessed.as_ref()).or(self.found.as_ref()).map(AsRef::as_ref)
    }

    /// Whether what was searched is of other points than those of now.
    pub fn is_behind(&self) -> bool {
        self.result()
            .is_some_and(|(_, freshness)| matches!(freshness, Freshness::Stale | Freshness::Followed))
    }

    /// Another number for each pair of pencils, whatever pictures they are of.
    pub fn pencils_revision(&self) -> u64 {
        self.pencils_revision
    }

    /// Another number for each result, whatever pictures it is of: numbers of hypotheses belong to one of them.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Why the latest computation has no result.
    pub fn failure(&self) -> Option<&EstimateFailure> {
        self.failure.as_ref()
    }

    /// Whether the user stopped the latest computation before it had a result.
    pub fn was_stopped(&self) -> bool {
        self.stopped
    }

    /// Takes on what is to be computed, and drops the result when that is nothing. [`Computation::begin`] is to follow
    /// when there is something new to compute.
    pub fn adopt(&mut self, request: Option<&EstimateRequest>) -> RequestChange {
        if request == self.input.as_ref() {
            return RequestChange::None;
        }
        let moved =
            self.input.as_ref().zip(request).is_some_and(|(old, new)| {
                old.parameters == new.parameters && old.recordings == new.recordings
            });
        self.input = request.cloned();
        self.failure = None;
        self.stopped = false;
        self.begun.clear();
        if !moved {
            self.give_up();
        }
        if request.is_none() {
            self.pencils.clear();
            self.set_shown(None);
        }
        if moved { RequestChange::Moved } else { RequestChange::Other }
    }

    /// The geometries that may follow moved points.
    pub fn starts(&self) -> Vec<Arc<Estimate>> {
        self.found.iter().chain(&self.guessed).cloned().collect()
    }

    /// A search of this number has begun; what is shown follows the points meanwhile, or stays behind.
    pub fn begin(&mut self, generation: u64, follows: bool) {
        self.generation = generation;
        self.running = true;
        if let Some(shown) = &mut self.shown {
            shown.freshness = if follows { Freshness::Followed } else { Freshness::Stale };
        }
    }

    fn set_pencils(&mut self, pencils: &[Arc<ComparedPencils>]) {
        let same = |(old, new): (&Arc<_>, &Arc<_>)| Arc::ptr_eq(old, new);
        if self.pencils.len() != pencils.len() || !self.pencils.iter().zip(pencils).all(same) {
            self.pencils = pencils.to_vec();
            self.pencils_revision = revision::fresh();
        }
    }

    /// Forgets what was found, all but what is shown.
    fn give_up(&mut self) {
        self.running = false;
        (self.found, self.guessed) = (None, None);
    }

    fn set_shown(&mut self, shown: Option<ResultOnScreen>) {
        self.shown = shown;
        self.revision = revision::fresh();
    }

    /// The search was stopped; a preliminary result stays.
    pub fn stop(&mut self) {
        self.give_up();
        if let Some(ResultOnScreen {
            freshness: freshness @ (Freshness::Preliminary | Freshness::Followed),
            ..
        }) = &mut self.shown
        {
            *freshness = Freshness::Stopped;
        } else {
            self.set_shown(None);
            self.stopped = true;
        }
    }

    /// Has the same request count as a new one.
    pub fn restart(&mut self) {
        self.input = None;
    }

    /// Takes in what a search has reported.
    pub fn take(&mut self, generation: u64, news: EstimateNews) {
        let current = generation == self.generation;
        match news {
            EstimateNews::Started(stage) if current => self.begun.push((stage, Instant::now())),
            EstimateNews::Pencils(pencils) => self.set_pencils(&pencils),
            EstimateNews::Preliminary(estimate) => {
                self.take_result(generation, estimate, Freshness::Preliminary);
            }
            EstimateNews::Finished(Ok(estimate)) => {
                self.running &= !current;
                self.take_result(generation, estimate, Freshness::Final);
            }
            EstimateNews::Finished(Err(failure)) if current => {
                self.running = false;
                // Lines of earlier points would contradict the message.
                self.set_shown(None);
                self.stopped = failure == EstimateFailure::Estimate(EstimateError::Cancelled);
                self.failure = (!self.stopped).then_some(failure);
            }
            // How a search that was overtaken went on or ended is nobody's concern.
            EstimateNews::Started(_) | EstimateNews::Finished(Err(_)) => {}
        }
    }

    /// Takes in the geometry that follows the points of a search, or that none does.
    pub fn take_followed(&mut self, generation: u64, followed: Option<Estimate>) {
        match followed {
            // The search's own result for the same points is better.
            Some(estimate) if self.running && self.is_news(generation.saturating_sub(1)) => {
                let (estimate, freshness) = (Arc::new(estimate), Freshness::Followed);
                self.set_shown(Some(ResultOnScreen { generation, estimate, freshness }));
            }
            None => {
                if let Some(shown) = &mut self.shown
                    && shown.freshness == Freshness::Followed
                {
                    shown.freshness = Freshness::Stale;
                }
            }
            Some(_) => {}
        }
    }

    /// A result of a search: kept to start from, and shown unless something newer is.
    fn take_result(&mut self, generation: u64, estimate: Box<Estimate>, freshness: Freshness) {
        let estimate: Arc<Estimate> = estimate.into();
        if let Some(trace) = estimate.trace.as_ref().filter(|trace| !trace.pencils.is_empty()) {
            self.set_pencils(&trace.pencils);
        }
        // The first guess comes before lines are compared.
        let guess = freshness == Freshness::Preliminary && estimate.line_score().is_none();
        if guess {
            self.guessed = Some(Arc::clone(&estimate));
        } else {
            (self.found, self.guessed) = (Some(Arc::clone(&estimate)), None);
        }
        let better_shown = guess
            && self.shown.as_ref().is_some_and(|shown| {
                shown.generation == generation && shown.freshness == Freshness::Followed
            });
        if self.is_news(generation) && !better_shown {
            let freshness = if generation == self.generation { freshness } else { Freshness::Stale };
            self.set_shown(Some(ResultOnScreen { generation, estimate, freshness }));
        }
    }

    /// Whether nothing newer than a result of this generation is shown.
    fn is_news(&self, generation: u64) -> bool {
        self.shown.as_ref().is_none_or(|shown| shown.generation <= generation)
    }
}
