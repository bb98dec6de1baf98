//! The search for the geometry, and the refit to moved points meanwhile. Each has its own thread.

use std::sync::Arc;

use super::services::{EstimateFn, FollowFn};
use super::task::{Task, Waiting};
use super::waker::Waker;
use crate::app::model::computation::{
    Computation, EstimateFailure, EstimateNews, EstimateRequest, RequestChange,
};
use crate::estimate::{Estimate, Monitor, Progress};

/// Number of a search, its request, and the geometries to start from.
type FollowQuestion = (u64, EstimateRequest, Vec<Arc<Estimate>>);

pub struct Estimating {
    search: Task<EstimateRequest, EstimateNews>,
    follower: Task<FollowQuestion, (u64, Option<Estimate>)>,
}

impl Estimating {
    pub fn new(mut estimate: Box<EstimateFn>, mut follow: Box<FollowFn>, waker: &Waker) -> Self {
        let search = Task::new("estimate", waker.clone(), Waiting::Newest, move |request, turn| {
            let monitor = Monitor::new(turn.cancel.clone(), |progress| match progress {
                Progress::Happened(event) => turn.tell(EstimateNews::Happened(event)),
                Progress::Pencils(pencils) => turn.tell(EstimateNews::Pencils(pencils)),
                Progress::Preliminary(estimate) => {
                    turn.tell(EstimateNews::Preliminary(estimate));
                    // There is something to draw now.
                    turn.give_way();
                }
            });
            let result = estimate(&request, &monitor).map(Box::new).map_err(EstimateFailure::Estimate);
            Some(EstimateNews::Finished(result))
        });
        let follower = Task::answering("follow", waker.clone(), move |question: FollowQuestion| {
            let (generation, request, starts) = question;
            let starts: Vec<&Estimate> = starts.iter().map(AsRef::as_ref).collect();
            Some((generation, follow(&request, &starts)))
        });
        Self { search, follower }
    }

    /// Starts a new search if the request has changed.
    pub fn follow(&mut self, computation: &mut Computation, request: Option<EstimateRequest>) {
        match computation.adopt(request.as_ref()) {
            RequestChange::None => return,
            RequestChange::Moved => {}
            RequestChange::Other => self.forget(),
        }
        let Some(request) = request else { return };
        let generation = self.search.ask(request.clone());
        let starts = computation.starts();
        computation.begin(generation, !starts.is_empty());
        if !starts.is_empty() {
            self.follower.ask((generation, request, starts));
        }
    }

    /// Cancels search and refit.
    pub fn forget(&mut self) {
        self.search.forget();
        self.follower.forget();
    }

    /// Stops the search. A preliminary result stays.
    pub fn stop(&mut self, computation: &mut Computation) {
        if computation.is_running() {
            self.forget();
            computation.stop();
        }
    }

    /// Passes news from the threads to the computation.
    pub fn take(&mut self, computation: &mut Computation) {
        while let Some((generation, news)) = self.search.poll() {
            let failed = |panic| EstimateNews::Finished(Err(EstimateFailure::Panic(panic)));
            computation.take(generation, news.unwrap_or_else(failed));
        }
        if let Some((generation, followed)) = self.follower.latest() {
            computation.take_followed(generation, followed);
        }
    }
}

#[cfg(test)]
#[path = "estimating_tests.rs"]
mod tests;
