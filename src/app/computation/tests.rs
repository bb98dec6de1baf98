use super::*;
use crate::app::fake;
use crate::estimate::Monitor;
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

/// A follower that marks what it gives with the first point's x.
fn following(computation: Computation) -> Computation {
    let follow = |request: &Request, starts: &[&Estimate]| {
        let start = starts.last()?;
        let mut assessment = start.assessment.clone();
        assessment.margin = Some(request.pairs[0].point1.x);
        Some(Estimate { assessment, trace: None, ..(*start).clone() })
    };
    computation.following(Box::new(follow), Waker::default())
}

#[test]
fn geometries_follow_moved_points_until_the_search_has_its_own() {
    let gate = Arc::new(AtomicBool::new(true));
    let held_up = Arc::clone(&gate);
    let search = move |request: &Request, monitor: &Monitor| {
        while !held_up.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
        fake::estimate(request, monitor)
    };
    let mut computation = following(Computation::new(Box::new(search), Waker::default()));
    computation.follow(1, Some(fake::request(1.0)));
    wait(&mut computation, |c| !c.is_running());
    gate.store(false, Ordering::Relaxed);
    for x in [2.0, 3.0, 4.0] {
        computation.follow(1, Some(fake::request(x)));
        assert_eq!(freshness(&computation), Some(Freshness::Followed), "no flicker while it is asked");
    }
    wait(&mut computation, |c| {
        c.result().is_some_and(|(estimate, _)| estimate.assessment.margin == Some(4.0))
    });
    assert_eq!(freshness(&computation), Some(Freshness::Followed));
    gate.store(true, Ordering::Relaxed);
    wait(&mut computation, |c| !c.is_running());
    assert_eq!(freshness(&computation), Some(Freshness::Final));
}

#[test]
fn other_parameters_and_pictures_are_not_followed() {
    let mut computation = following(Computation::new(Box::new(fake::estimate), Waker::default()));
    computation.follow(1, Some(fake::request(1.0)));
    wait(&mut computation, |c| !c.is_running());
    let mut request = fake::request(2.0);
    request.parameters.seed += 1;
    computation.follow(1, Some(request));
    assert_eq!(freshness(&computation), Some(Freshness::Stale));
    wait(&mut computation, |c| !c.is_running());
    computation.follow(2, Some(fake::request(3.0)));
    assert_eq!(freshness(&computation), None);
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
