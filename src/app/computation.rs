//! Where the estimate stands: the latest result, whether it is still being improved, and what went wrong.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::worker::{EstimateFn, Failure, News, Request, Waker, Worker};
use crate::estimate::{ComparedPencils, Estimate, EstimateError, Parameters, Stage};
use crate::geometry::PointPair;

/// How the latest result relates to the points as they are now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freshness {
    /// Final, for the points as they are.
    Final,
    /// For the points as they are, still being refined.
    Preliminary,
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

/// The estimate and the thread that computes it.
pub struct Computation {
    worker: Worker,
    input: Option<Input>,
    running: bool,
    /// The stages of the latest computation that have begun, with when they did.
    begun: Vec<(Stage, Instant)>,
    /// The pencils compared last: of the clicks as they are, or of the ones just before.
    pencils: Option<Arc<[ComparedPencils; 2]>>,
    /// Counts the pencils.
    pencils_revision: u64,
    /// Counts the results.
    revision: u64,
    result: Option<(Box<Estimate>, Freshness)>,
    failure: Option<Failure>,
    stopped: bool,
}

impl Computation {
    /// Nothing computed yet.
    pub fn new(estimate: Box<EstimateFn>, waker: Waker) -> Self {
        Self {
            worker: Worker::new(estimate, waker),
            input: None,
            running: false,
            begun: Vec::new(),
            pencils: None,
            pencils_revision: 0,
            revision: 0,
            result: None,
            failure: None,
            stopped: false,
        }
    }

    /// The latest result and how it relates to the points as they are now.
    pub fn result(&self) -> Option<(&Estimate, Freshness)> {
        self.result.as_ref().map(|(estimate, freshness)| (estimate.as_ref(), *freshness))
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
    pub fn pencils(&self) -> Option<&[ComparedPencils; 2]> {
        self.pencils.as_deref()
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
        let other_pictures = self.input.as_ref().is_some_and(|old| old.opening != opening);
        self.input = input;
        self.failure = None;
        self.stopped = false;
        if let Some(request) = request {
            self.worker.submit(request);
            self.running = true;
            self.begun.clear();
            if other_pictures {
                self.pencils = None;
                self.set_result(None);
            } else if let Some((_, freshness)) = &mut self.result {
                *freshness = Freshness::Stale;
            }
        } else {
            self.worker.cancel();
            self.running = false;
            self.pencils = None;
            self.set_result(None);
        }
    }

    fn set_pencils(&mut self, pencils: Arc<[ComparedPencils; 2]>) {
        if self.pencils.as_ref().is_none_or(|old| !Arc::ptr_eq(old, &pencils)) {
            self.pencils = Some(pencils);
            self.pencils_revision += 1;
        }
    }

    fn set_result(&mut self, result: Option<(Box<Estimate>, Freshness)>) {
        if let Some(pencils) = result.as_ref().and_then(|(estimate, _)| estimate.pencils.as_ref()) {
            let pencils = Arc::clone(pencils);
            self.set_pencils(pencils);
        }
        self.result = result;
        self.revision += 1;
    }

    /// Stops the computation; a preliminary result stays.
    pub fn stop(&mut self) {
        if !std::mem::take(&mut self.running) {
            return;
        }
        self.worker.cancel();
        if let Some((_, freshness @ Freshness::Preliminary)) = &mut self.result {
            *freshness = Freshness::Stopped;
        } else {
            self.set_result(None);
            self.stopped = true;
        }
    }

    /// Computes again, from the same input.
    pub fn restart(&mut self) {
        self.input = None;
    }

    /// Takes in what the thread has reported.
    pub fn take_news(&mut self) {
        while let Some(news) = self.worker.poll() {
            match news {
                News::Started(stage) => self.begun.push((stage, Instant::now())),
                News::Pencils(pencils) => self.set_pencils(pencils),
                News::Preliminary(estimate) => {
                    self.set_result(Some((estimate, Freshness::Preliminary)));
                }
                News::Finished(Ok(estimate)) => {
                    self.running = false;
                    self.set_result(Some((estimate, Freshness::Final)));
                }
                News::Finished(Err(failure)) => {
                    self.running = false;
                    // Lines of earlier points would contradict the message.
                    self.set_result(None);
                    self.stopped = failure == Failure::Estimate(EstimateError::Cancelled);
                    self.failure = (!self.stopped).then_some(failure);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::fake;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::{Duration, Instant};

    fn wait(computation: &mut Computation, until: impl Fn(&Computation) -> bool) {
        let start = Instant::now();
        while !until(computation) {
            computation.take_news();
            assert!(start.elapsed() < Duration::from_secs(20), "never happened");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn freshness(computation: &Computation) -> Option<Freshness> {
        computation.result().map(|(_, freshness)| freshness)
    }

    /// A computation that pauses after its preliminary result until the gate opens or it is cancelled.
    fn gated(gate: &Arc<AtomicBool>) -> Computation {
        let gate = Arc::clone(gate);
        Computation::new(
            Box::new(move |request, monitor| {
                let result = fake::estimate(request, monitor)?;
                while !gate.load(Ordering::Relaxed) {
                    monitor.check()?;
                    std::thread::sleep(Duration::from_millis(1));
                }
                Ok(result)
            }),
            Waker::default(),
        )
    }

    #[test]
    fn results_go_from_preliminary_to_final_to_stale() {
        let gate = Arc::new(AtomicBool::new(false));
        let mut computation = gated(&gate);
        computation.follow(1, Some(fake::request(1.0)));
        assert!(computation.is_running());
        wait(&mut computation, |c| freshness(c) == Some(Freshness::Preliminary));
        assert!(computation.stage().is_some());
        gate.store(true, Ordering::Relaxed);
        wait(&mut computation, |c| !c.is_running());
        assert_eq!(freshness(&computation), Some(Freshness::Final));
        computation.follow(1, Some(fake::request(1.0)));
        assert!(!computation.is_running(), "nothing changed");
        computation.follow(1, Some(fake::request(2.0)));
        assert_eq!(freshness(&computation), Some(Freshness::Stale));
        computation.follow(2, Some(fake::request(3.0)));
        assert_eq!(freshness(&computation), None, "a result of other pictures must not be drawn");
        computation.follow(2, None);
        assert!(!computation.is_running());
    }

    #[test]
    fn stopping_keeps_the_preliminary_result() {
        let gate = Arc::new(AtomicBool::new(false));
        let mut computation = gated(&gate);
        computation.follow(1, Some(fake::request(1.0)));
        wait(&mut computation, |c| freshness(c).is_some());
        computation.stop();
        assert!(!computation.is_running());
        assert_eq!(freshness(&computation), Some(Freshness::Stopped));
        computation.restart();
        computation.follow(1, Some(fake::request(1.0)));
        assert!(computation.is_running());
    }

    #[test]
    fn a_failure_removes_the_lines_it_contradicts() {
        let mut computation = Computation::new(Box::new(fake::estimate), Waker::default());
        computation.follow(1, Some(fake::request(1.0)));
        wait(&mut computation, |c| !c.is_running());
        let mut request = fake::request(1.0);
        request.pairs.truncate(1);
        computation.follow(1, Some(request));
        wait(&mut computation, |c| !c.is_running());
        assert!(computation.result().is_none());
        assert_eq!(computation.failure(), Some(&Failure::Estimate(EstimateError::NoGeometry)));
    }
}
