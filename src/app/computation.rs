//! Where the estimate stands: the latest result, whether it is still being improved, and what went wrong.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::background::Latest;
use super::services::FollowFn;
use super::waker::Waker;
use super::worker::{EstimateFn, Failure, News, Request, Worker};
use crate::estimate::{ComparedPencils, Estimate, EstimateError, Parameters, Stage};
use crate::geometry::PointPair;

/// How the latest result relates to the points as they are now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freshness {
    /// Final, for the points as they are.
    Final,
    /// For the points as they are, still being refined.
    Preliminary,
    /// An earlier geometry of the same images, refitted to the points as they are or were a moment ago; the
    /// search for them goes on.
    Followed,
    /// For earlier points; a new one is being computed.
    Stale,
    /// A preliminary result that was stopped before it was refined.
    Stopped,
}

/// What a request was made from; a new one is made only when this changes.
#[derive(Debug, Clone, PartialEq)]
struct Input {
    /// Counts the openings of pictures.
    opening: u64,
    pairs: Vec<PointPair>,
    parameters: Parameters,
}

/// The result on the screen.
struct Shown {
    /// Which request it belongs to; a result of an earlier one never takes its place.
    generation: u64,
    estimate: Arc<Estimate>,
    freshness: Freshness,
}

/// A request with the generation of its search and the geometries to start from.
type Question = (u64, Request, Vec<Arc<Estimate>>);
/// What became of it.
type Answer = (u64, Option<Estimate>);

/// The estimate and the threads that compute it.
pub struct Computation {
    worker: Worker,
    follower: Option<Latest<Question, Answer>>,
    input: Option<Input>,
    /// Of the request that `input` was made into.
    generation: u64,
    running: bool,
    /// The stages of the latest computation that have begun, with when they did.
    begun: Vec<(Stage, Instant)>,
    /// The pencils compared last: of the clicks as they are, or of the ones just before.
    pencils: Vec<Arc<ComparedPencils>>,
    /// Counts the pencils.
    pencils_revision: u64,
    /// Counts the results.
    revision: u64,
    shown: Option<Shown>,
    /// The latest result of a search through all stages that find the geometry, whichever points it was for.
    found: Option<Arc<Estimate>>,
    /// A first guess of a later search.
    guessed: Option<Arc<Estimate>>,
    failure: Option<Failure>,
    stopped: bool,
}

impl Computation {
    /// Nothing computed yet.
    pub fn new(estimate: Box<EstimateFn>, waker: Waker) -> Self {
        Self {
            worker: Worker::new(estimate, waker),
            follower: None,
            input: None,
            generation: 0,
            running: false,
            begun: Vec::new(),
            pencils: Vec::new(),
            pencils_revision: 0,
            revision: 0,
            shown: None,
            found: None,
            guessed: None,
            failure: None,
            stopped: false,
        }
    }

    /// Has geometries follow moved points while the search for them goes on.
    #[must_use]
    pub fn following(mut self, mut follow: Box<FollowFn>, waker: Waker) -> Self {
        self.follower = Some(Latest::new("follow", waker, move |(generation, request, starts): Question| {
            let starts: Vec<&Estimate> = starts.iter().map(AsRef::as_ref).collect();
            Some((generation, follow(&request, &starts)))
        }));
        self
    }

    /// The latest result and how it relates to the points as they are now.
    pub fn result(&self) -> Option<(&Estimate, Freshness)> {
        self.shown.as_ref().map(|shown| (shown.estimate.as_ref(), shown.freshness))
    }

    /// Whether a computation is under way.
    pub fn is_running(&self) -> bool {
        self.running
    }

    /// The stage under way, once it is known.
    pub fn stage(&self) -> Option<Stage> {
        self.begun.last().map(|(stage, _)| *stage)
    }

    /// The stages of the latest computation that have begun, each with the time it took; of the last one, none.
    pub fn stages(&self) -> impl Iterator<Item = (Stage, Option<Duration>)> + '_ {
        self.begun
            .iter()
            .enumerate()
            .map(|(k, (stage, begun))| (*stage, self.begun.get(k + 1).map(|(_, next)| *next - *begun)))
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
        let shown =
            self.shown.as_ref().map(|shown| &shown.estimate).filter(|estimate| estimate.trace.is_some());
        shown.or(self.guessed.as_ref()).or(self.found.as_ref()).map(AsRef::as_ref)
    }

    /// Another number for each pair of pencils.
    pub fn pencils_revision(&self) -> u64 {
        self.pencils_revision
    }

    /// Another number for each result: numbers of hypotheses belong to one of them.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Why the latest computation has no result.
    pub fn failure(&self) -> Option<&Failure> {
        self.failure.as_ref()
    }

    /// Whether the user stopped the latest computation before it had a result.
    pub fn was_stopped(&self) -> bool {
        self.stopped
    }

    /// Brings the computation in line with the document: starts it anew when anything it depends on has
    /// changed since, and drops the result when there is nothing to compute from (`request` is `None`).
    pub fn follow(&mut self, opening: u64, request: Option<Request>) {
        let input = request.as_ref().map(|request| Input {
            opening,
            pairs: request.pairs.clone(),
            parameters: request.parameters.clone(),
        });
        if input == self.input {
            return;
        }
        let only_points_moved = self
            .input
            .as_ref()
            .zip(input.as_ref())
            .is_some_and(|(old, new)| old.opening == new.opening && old.parameters == new.parameters);
        let other_pictures = self.input.as_ref().is_some_and(|old| old.opening != opening);
        self.input = input;
        self.failure = None;
        self.stopped = false;
        if !only_points_moved {
            self.give_up();
        }
        let Some(request) = request else {
            self.pencils.clear();
            self.begun.clear();
            self.set_shown(None);
            return;
        };
        self.generation = self.worker.submit(request.clone());
        self.running = true;
        self.begun.clear();
        let starts: Vec<_> = self.found.iter().chain(&self.guessed).cloned().collect();
        let mut freshness = Freshness::Stale;
        if let Some(follower) = self.follower.as_mut().filter(|_| !starts.is_empty()) {
            follower.ask((self.generation, request, starts));
            freshness = Freshness::Followed;
        }
        if other_pictures {
            self.pencils.clear();
            self.set_shown(None);
        } else if let Some(shown) = &mut self.shown {
            shown.freshness = freshness;
        }
    }

    fn set_pencils(&mut self, pencils: &[Arc<ComparedPencils>]) {
        let same = |(old, new): (&Arc<_>, &Arc<_>)| Arc::ptr_eq(old, new);
        if self.pencils.len() != pencils.len() || !self.pencils.iter().zip(pencils).all(same) {
            self.pencils = pencils.to_vec();
            self.pencils_revision += 1;
        }
    }

    /// Stops the threads and forgets what they found, all but what is shown.
    fn give_up(&mut self) {
        self.worker.cancel();
        if let Some(follower) = &mut self.follower {
            follower.forget();
        }
        self.running = false;
        (self.found, self.guessed) = (None, None);
    }

    fn set_shown(&mut self, shown: Option<Shown>) {
        self.shown = shown;
        self.revision += 1;
    }

    /// Stops the computation; a preliminary result stays.
    pub fn stop(&mut self) {
        if !self.running {
            return;
        }
        self.give_up();
        if let Some(Shown { freshness: freshness @ (Freshness::Preliminary | Freshness::Followed), .. }) =
            &mut self.shown
        {
            *freshness = Freshness::Stopped;
        } else {
            self.set_shown(None);
            self.stopped = true;
        }
    }

    /// Computes again, from the same input.
    pub fn restart(&mut self) {
        self.input = None;
    }

    /// Takes in what the threads have reported.
    pub fn take_news(&mut self) {
        while let Some((generation, news)) = self.worker.poll() {
            let current = generation == self.generation;
            match news {
                News::Started(stage) if current => self.begun.push((stage, Instant::now())),
                News::Pencils(pencils) => self.set_pencils(&pencils),
                News::Preliminary(estimate) => {
                    self.take_result(generation, estimate, Freshness::Preliminary);
                }
                News::Finished(Ok(estimate)) => {
                    self.running &= !current;
                    self.take_result(generation, estimate, Freshness::Final);
                }
                News::Finished(Err(failure)) if current => {
                    self.running = false;
                    // Lines of earlier points would contradict the message.
                    self.set_shown(None);
                    self.stopped = failure == Failure::Estimate(EstimateError::Cancelled);
                    self.failure = (!self.stopped).then_some(failure);
                }
                // How a search that was overtaken went on or ended is nobody's concern.
                News::Started(_) | News::Finished(Err(_)) => {}
            }
        }
        let Some((generation, answer)) = self.follower.as_mut().and_then(Latest::poll) else { return };
        match answer {
            // The search's own result for the same points is better.
            Some(estimate) if self.running && self.is_news(generation.saturating_sub(1)) => {
                let (estimate, freshness) = (Arc::new(estimate), Freshness::Followed);
                self.set_shown(Some(Shown { generation, estimate, freshness }));
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
            self.set_shown(Some(Shown { generation, estimate, freshness }));
        }
    }

    /// Whether nothing newer than a result of this generation is shown.
    fn is_news(&self, generation: u64) -> bool {
        self.shown.as_ref().is_none_or(|shown| shown.generation <= generation)
    }
}

#[cfg(test)]
mod tests;
