use super::*;
use crate::app::fake;
use crate::app::model::computation::Freshness;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

struct Computing {
    tasks: Estimating,
    state: Computation,
}

impl Computing {
    fn new(estimate: Box<EstimateFn>) -> Self {
        Self::following(estimate, Box::new(|_, _| None))
    }

    fn following(estimate: Box<EstimateFn>, follow: Box<FollowFn>) -> Self {
        Self { tasks: Estimating::new(estimate, follow, &Waker::default()), state: Computation::default() }
    }

    fn follow(&mut self, request: EstimateRequest) {
        self.tasks.follow(&mut self.state, Some(request));
    }
}

fn wait(computing: &mut Computing, until: impl Fn(&Computation) -> bool) {
    let start = Instant::now();
    while !until(&computing.state) {
        computing.tasks.take(&mut computing.state);
        assert!(start.elapsed() < Duration::from_secs(20), "never happened");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn freshness(computation: &Computation) -> Option<Freshness> {
    computation.result().map(|(_, freshness)| freshness)
}

/// Returns a computation that pauses after its preliminary result until the gate opens or it is
/// cancelled.
fn gated(gate: &Arc<AtomicBool>) -> Computing {
    let gate = Arc::clone(gate);
    Computing::new(Box::new(move |request, monitor| {
        let result = fake::estimate(request, monitor)?;
        while !gate.load(Ordering::Relaxed) {
            monitor.cancel().check()?;
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(result)
    }))
}

#[test]
fn results_go_from_preliminary_to_final_to_stale() {
    let gate = Arc::new(AtomicBool::new(false));
    let mut computing = gated(&gate);
    computing.follow(fake::request(1.0));
    assert!(computing.state.is_running());
    wait(&mut computing, |c| freshness(c) == Some(Freshness::Preliminary));
    assert!(computing.state.stage().is_some());
    gate.store(true, Ordering::Relaxed);
    wait(&mut computing, |c| !c.is_running());
    assert_eq!(freshness(&computing.state), Some(Freshness::Final));
    computing.follow(fake::request(1.0));
    assert!(!computing.state.is_running(), "nothing changed");
    computing.follow(fake::request(2.0));
    assert_eq!(freshness(&computing.state), Some(Freshness::Followed));
    // The news that no geometry can follow.
    computing.state.take_followed(2, None);
    assert_eq!(freshness(&computing.state), Some(Freshness::Stale));
    computing.tasks.follow(&mut computing.state, None);
    assert!(!computing.state.is_running() && freshness(&computing.state).is_none());
}

/// Follows with a geometry whose margin is the x of the first point.
fn mark(request: &EstimateRequest, starts: &[&Estimate]) -> Option<Estimate> {
    let start = starts.last()?;
    let mut assessment = start.assessment.clone();
    assessment.margin = Some(request.pairs[0].point1.x);
    Some(Estimate { assessment, trace: None, ..(*start).clone() })
}

#[test]
fn other_parameters_are_not_followed() {
    let mut computing = Computing::following(Box::new(fake::estimate), Box::new(mark));
    computing.follow(fake::request(1.0));
    wait(&mut computing, |c| !c.is_running());
    let mut request = fake::request(2.0);
    request.parameters.seed += 1;
    computing.follow(request);
    assert_eq!(freshness(&computing.state), Some(Freshness::Stale));
    wait(&mut computing, |c| !c.is_running());
}

#[test]
fn stopping_keeps_the_preliminary_result() {
    let gate = Arc::new(AtomicBool::new(false));
    let mut computing = gated(&gate);
    computing.follow(fake::request(1.0));
    wait(&mut computing, |c| freshness(c).is_some());
    computing.tasks.stop(&mut computing.state);
    assert!(!computing.state.is_running());
    assert_eq!(freshness(&computing.state), Some(Freshness::Stopped));
    computing.state.restart();
    computing.follow(fake::request(1.0));
    assert!(computing.state.is_running());
}
