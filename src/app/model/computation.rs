//! State of the estimate: latest result, progress and failure. This module does not know the
//! threads.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::picture::Pictures;
use super::recording::Synchronised;
use super::revision;
use super::shared::Shared;
use crate::camera::ViewPair;
use crate::estimate::{ComparedPencils, Estimate, EstimateError, Event, EventKind, Match, Parameters, Stage};
use crate::geometry::PointPair;

/// Inputs of an estimate. A new estimate is made only when they change.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateRequest {
    pub pictures: Pictures,
    /// The sequences, if lines are compared by motion barcodes.
    pub recordings: Option<Synchronised>,
    /// Views of the pictures, if their cameras take part in the search.
    pub views: Option<ViewPair>,
    pub pairs: Vec<PointPair>,
    pub given: Option<Shared<Vec<Match>>>,
    pub parameters: Parameters,
}

/// Reason why there is no result.
#[derive(Debug, Clone, PartialEq)]
pub enum EstimateFailure {
    /// The estimator refused or failed.
    Estimate(EstimateError),
    /// The computation panicked: a bug in the program.
    Panic(String),
}

#[derive(Debug)]
pub enum EstimateNews {
    /// Something that the record of the search has now, too.
    Happened(Event),
    /// The pencils through the anchors have been compared.
    Pencils(Vec<Arc<ComparedPencils>>),
    /// A result good enough to draw; better ones follow.
    Preliminary(Box<Estimate>),
    Finished(Result<Box<Estimate>, EstimateFailure>),
}

/// Effect of a new request on the previous one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequestChange {
    None,
    /// Only the points moved. The running search may still give a geometry that can follow them.
    Moved,
    /// Parameters or sequences changed, or there is no request any more.
    Other,
}

/// Relation of the latest result to the current points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freshness {
    /// Final result for the current points.
    Final,
    /// Preliminary result for the current points. The refinement goes on.
    Preliminary,
    /// Earlier geometry, refitted to the current points or to the points of a moment ago. The
    /// search goes on.
    Followed,
    /// Result for earlier points. The search goes on.
    Stale,
    /// Preliminary result whose search was stopped before the refinement.
    Stopped,
}

impl Freshness {
    /// Returns whether the points moved since the result was searched.
    pub fn is_behind(self) -> bool {
        matches!(self, Self::Stale | Self::Followed)
    }
}

#[derive(Debug, Clone)]
struct ResultOnScreen {
    /// Number of the request. A result of an earlier request never replaces this one.
    generation: u64,
    estimate: Arc<Estimate>,
    freshness: Freshness,
}

/// The estimate of one pair of pictures.
#[derive(Debug, Clone, Default)]
pub struct Computation {
    input: Option<EstimateRequest>,
    /// Number of the request `input`.
    generation: u64,
    running: bool,
    /// Stages of the latest computation that have begun, with their start times.
    begun: Vec<(Stage, Instant)>,
    /// Events of the latest computation so far.
    events: Vec<Event>,
    /// Pencils compared last, for the current clicks or slightly earlier ones.
    pencils: Vec<Arc<ComparedPencils>>,
    pencils_revision: u64,
    revision: u64,
    shown: Option<ResultOnScreen>,
    /// Latest result of a search past its first guess, for any points.
    found: Option<Arc<Estimate>>,
    /// First guess of a later search.
    guessed: Option<Arc<Estimate>>,
    failure: Option<EstimateFailure>,
    stopped: bool,
}

impl Computation {
    /// Returns the latest result and its relation to the current points.
    pub fn result(&self) -> Option<(&Estimate, Freshness)> {
        self.shown.as_ref().map(|shown| (shown.estimate.as_ref(), shown.freshness))
    }

    /// Returns the latest result in a form for tasks on other threads.
    pub fn shared_result(&self) -> Option<(Shared<Estimate>, Freshness)> {
        self.shown.as_ref().map(|shown| (Arc::clone(&shown.estimate).into(), shown.freshness))
    }

    pub fn is_running(&self) -> bool {
        self.running
    }

    /// Returns whether the result is final for the current points. The same points would give it again.
    pub fn is_final(&self) -> bool {
        matches!(self.result(), Some((_, Freshness::Final)))
    }

    /// Returns the running stage, once known.
    pub fn stage(&self) -> Option<Stage> {
        self.begun.last().map(|(stage, _)| *stage)
    }

    /// Returns how long the running computation has taken, from its first stage.
    pub fn elapsed(&self) -> Option<Duration> {
        self.begun.first().filter(|_| self.running).map(|(_, begun)| begun.elapsed())
    }

    /// Returns the stages of the latest computation with their total times; `None` for the running
    /// stage.
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

    /// Returns the events of the running search so far.
    pub fn events_so_far(&self) -> Option<&[Event]> {
        self.running.then_some(self.events.as_slice())
    }

    /// Returns whether there is a computation, running or finished.
    pub fn has_begun(&self) -> bool {
        self.input.is_some()
    }

    /// Returns the pencils compared last, even while newer ones are being compared.
    pub fn pencils(&self) -> Option<&[Arc<ComparedPencils>]> {
        (!self.pencils.is_empty()).then_some(&self.pencils)
    }

    /// Returns the latest result of a search, even when the points have moved since.
    pub fn searched(&self) -> Option<&Estimate> {
        let shown = self.shown.as_ref().map(|shown| &shown.estimate);
        let shown = shown.filter(|estimate| estimate.trace.is_some());
        shown.or(self.guessed.as_ref()).or(self.found.as_ref()).map(AsRef::as_ref)
    }

    /// Returns whether the points moved since the shown result was searched.
    pub fn is_behind(&self) -> bool {
        self.result().is_some_and(|(_, freshness)| freshness.is_behind())
    }

    /// Returns a unique number of the shown pencils.
    pub fn pencils_revision(&self) -> u64 {
        self.pencils_revision
    }

    /// Returns a unique number of the shown result. Numbers of hypotheses belong to one result.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Returns the number of the latest search. Preliminary and final results of a search have the same number.
    pub fn run(&self) -> u64 {
        self.generation
    }

    /// Returns the reason why the latest computation has no result.
    pub fn failure(&self) -> Option<&EstimateFailure> {
        self.failure.as_ref()
    }

    /// Returns whether the user stopped the latest computation before it had a result.
    pub fn was_stopped(&self) -> bool {
        self.stopped
    }

    /// Sets the request, and drops the result if there is none. If there is a new request,
    /// [`Computation::begin`] must follow.
    pub fn adopt(&mut self, request: Option<&EstimateRequest>) -> RequestChange {
        if request == self.input.as_ref() {
            return RequestChange::None;
        }
        let moved = self.input.as_ref().zip(request).is_some_and(|(old, new)| {
            old.parameters == new.parameters
                && old.recordings == new.recordings
                && old.views == new.views
                && old.given == new.given
        });
        self.input = request.cloned();
        self.failure = None;
        self.stopped = false;
        self.begun.clear();
        self.events.clear();
        if !moved {
            self.give_up();
        }
        if request.is_none() {
            self.pencils.clear();
            self.set_shown(None);
        }
        if moved { RequestChange::Moved } else { RequestChange::Other }
    }

    /// Returns the geometries from which moved points can be followed.
    pub fn starts(&self) -> Vec<Arc<Estimate>> {
        self.found.iter().chain(&self.guessed).cloned().collect()
    }

    /// Marks a search as begun. The shown result follows the points meanwhile, or becomes stale.
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

    /// Forgets all results except the shown one.
    fn give_up(&mut self) {
        self.running = false;
        (self.found, self.guessed) = (None, None);
    }

    fn set_shown(&mut self, shown: Option<ResultOnScreen>) {
        self.shown = shown;
        self.revision = revision::fresh();
    }

    /// Marks the search as stopped by the user. A preliminary result stays.
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

    /// Forgets the request, so that the same request counts as new.
    pub fn restart(&mut self) {
        self.input = None;
    }

    pub fn take(&mut self, generation: u64, news: EstimateNews) {
        let current = generation == self.generation;
        match news {
            EstimateNews::Happened(event) if current => {
                if let EventKind::Began(stage) = event.kind {
                    self.begun.push((stage, Instant::now()));
                }
                self.events.push(event);
            }
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
            // Progress and failure of an outdated search do not matter.
            EstimateNews::Happened(_) | EstimateNews::Finished(Err(_)) => {}
        }
    }

    /// Sets the geometry that followed the points of a search, or marks the shown one as stale.
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

    /// Keeps a result of a search to start from, and shows it unless a newer one is shown.
    fn take_result(&mut self, generation: u64, estimate: Box<Estimate>, freshness: Freshness) {
        let estimate: Arc<Estimate> = estimate.into();
        if let Some(trace) = estimate.trace.as_ref().filter(|trace| !trace.pencils.is_empty()) {
            self.set_pencils(&trace.pencils);
        }
        // A first guess has no line score yet.
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

    /// Returns whether nothing newer than this generation is shown.
    fn is_news(&self, generation: u64) -> bool {
        self.shown.as_ref().is_none_or(|shown| shown.generation <= generation)
    }
}
