//! Progress and cancellation of a running estimate.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use epiline::estimate::{
    CancelFlag, EstimateError, Event, EventKind, Monitor, Parameters, Progress, Stage, estimate,
    estimate_prepared,
};

use crate::support::{COURTYARD, mean_distance, paper};

/// Time limit against a hang, not a measure of speed. Cancellation takes effect at the end of a
/// step, some hundredths of a second in a release build. This test may run unoptimised on busy
/// cores.
const QUICKLY: Duration = Duration::from_secs(10);

/// Stages announced to a caller. The pyramids exist before the first message.
const ANNOUNCED: [Stage; 4] = [Stage::Pencils, Stage::Hypotheses, Stage::Validation, Stage::Refinement];

/// Cancels `delay` after a stage has begun. Returns the time until the estimate stopped, or `None`
/// if it had finished.
fn time_to_stop(parameters: &Parameters, stage: Stage, delay: Duration) -> Option<Duration> {
    let cancel = CancelFlag::default();
    let asked = Mutex::new(None);
    let outcome = std::thread::scope(|scope| {
        let (cancel_later, asked) = (cancel.clone(), &asked);
        let (begun, hear) = std::sync::mpsc::channel::<()>();
        scope.spawn(move || {
            // If the stage never comes, the sender is dropped without a message.
            if hear.recv().is_ok() {
                std::thread::sleep(delay);
                *asked.lock().unwrap() = Some(Instant::now());
                cancel_later.cancel();
            }
        });
        let monitor = Monitor::new(cancel, move |news| {
            if matches!(news, Progress::Happened(Event { kind: EventKind::Began(s), .. }) if s == stage) {
                begun.send(()).unwrap();
                if delay.is_zero() {
                    // Cancelled from within the callback.
                    while asked.lock().unwrap().is_none() {
                        std::thread::yield_now();
                    }
                }
            }
        });
        let outcome = estimate_prepared(&COURTYARD.prepared, &COURTYARD.show_me, parameters, &monitor);
        (outcome, Instant::now())
    });
    let asked = asked.into_inner().unwrap().unwrap_or_else(|| panic!("{stage:?} was not announced"));
    match outcome {
        (Err(EstimateError::Cancelled), end) => Some(end - asked),
        (Ok(_), end) if asked > end || delay > Duration::ZERO => None,
        (other, _) => panic!("{stage:?}: {other:?}"),
    }
}

#[test]
fn stops_at_the_beginning_of_every_stage() {
    for parameters in [Parameters::default(), paper()] {
        for stage in ANNOUNCED {
            let waited = time_to_stop(&parameters, stage, Duration::ZERO);
            let waited = waited.unwrap_or_else(|| panic!("{stage:?}: not stopped"));
            println!("{:?} {stage:?}: {waited:?}", parameters.preset);
            assert!(waited < QUICKLY, "{:?} {stage:?}: {waited:?}", parameters.preset);
        }
    }
}

#[test]
fn stops_in_the_middle_of_every_stage() {
    for parameters in [Parameters::default(), paper()] {
        let mut stopped = 0;
        for stage in ANNOUNCED {
            let waited = time_to_stop(&parameters, stage, Duration::from_millis(15));
            println!("{:?} {stage:?}: {waited:?}", parameters.preset);
            stopped += usize::from(waited.is_some());
            assert!(waited.is_none_or(|w| w < QUICKLY), "{:?} {stage:?}: {waited:?}", parameters.preset);
        }
        // A stage may finish earlier, but not all of them.
        assert!(stopped >= 2, "{:?}: only {stopped} stages were stopped", parameters.preset);
    }
}

#[test]
fn does_not_begin_when_already_cancelled() {
    let cancel = CancelFlag::default();
    cancel.cancel();
    let monitor = Monitor::new(cancel, |news| {
        assert!(!matches!(news, Progress::Preliminary(_)), "a result after the stop");
    });
    let [a, b] = &COURTYARD.scene.images;
    let outcome = estimate(a, b, &COURTYARD.show_me, &Parameters::default(), &monitor);
    assert_eq!(outcome.map(|_| ()), Err(EstimateError::Cancelled));
}

#[test]
fn tells_stages_in_order_and_a_first_geometry_before_the_result() {
    #[derive(Debug, PartialEq, Clone, Copy)]
    enum Heard {
        Stage(Stage),
        Pencils,
        Preliminary(f64),
    }
    for parameters in [Parameters::default(), paper()] {
        let (heard, events) = (Mutex::new(Vec::new()), Mutex::new(Vec::new()));
        let monitor = Monitor::new(CancelFlag::default(), |news| {
            if let Progress::Happened(event) = &news {
                events.lock().unwrap().push(event.clone());
            }
            heard.lock().unwrap().push(match news {
                Progress::Happened(Event { kind: EventKind::Began(stage), .. }) => Heard::Stage(stage),
                Progress::Happened(_) => return,
                Progress::Pencils(pencils) => {
                    for (pencils, click) in pencils.iter().zip(&COURTYARD.show_me) {
                        assert_eq!(&pencils.click, click);
                        let best = &pencils.candidates[0];
                        let [row, column] = pencils.cell(best).unwrap();
                        assert_eq!(pencils.costs.at(row, column).to_bits(), best.cost.to_bits());
                        let [line1, line2] = pencils.lines(row, column).unwrap();
                        assert!(line1.line().distance(click.point1) < 1e-9);
                        assert!(line2.line().distance(click.point2) < 1e-9);
                    }
                    Heard::Pencils
                }
                Progress::Preliminary(first) => {
                    Heard::Preliminary(mean_distance(first.fundamental(), &COURTYARD.scene.matches))
                }
            });
        });
        let found =
            estimate_prepared(&COURTYARD.prepared, &COURTYARD.show_me, &parameters, &monitor).unwrap();
        drop(monitor);
        let heard = heard.into_inner().unwrap();
        println!("{:?}: {heard:.2?}", parameters.preset);
        let stages: Vec<_> =
            heard.iter().filter_map(|h| if let Heard::Stage(s) = h { Some(*s) } else { None }).collect();
        assert_eq!(stages, ANNOUNCED, "each once, in order");
        let found = found.trace.expect("a search leaves a trace");
        assert_eq!(events.into_inner().unwrap(), found.events, "the record, as it grew");
        let timed: Vec<_> = found.timings.iter().map(|t| t.stage).collect();
        let upright = &Stage::ALL[..Stage::ALL.len() - 1];
        assert_eq!(timed, upright, "each stage has its time, and features were not needed");

        let at = |stage| heard.iter().position(|h| *h == Heard::Stage(stage)).unwrap();
        assert_eq!(heard[at(Stage::Pencils) + 1..at(Stage::Hypotheses)], [Heard::Pencils]);
        assert_eq!(found.pencils.len(), 2);
        let preliminary: Vec<(usize, f64)> = heard
            .iter()
            .enumerate()
            .filter_map(|(k, h)| if let Heard::Preliminary(e) = h { Some((k, *e)) } else { None })
            .collect();
        let (first, _) = preliminary.first().expect("a preliminary geometry");
        let (last, error) = preliminary[preliminary.len() - 1];
        assert!(*first > at(Stage::Pencils) && last < at(Stage::Refinement), "{heard:?}");
        // The geometry before refinement: 0.26 px with the preset robust, 1.33 px with paper.
        assert!(error < 2.0, "{heard:?}");
        assert!(found.first_seconds > 0.0 && found.first_seconds < found.seconds);
        let sum: f64 = found.timings.iter().map(|t| t.seconds).sum();
        // Nothing slow happens outside the timed stages.
        assert!((sum - found.seconds).abs() < 0.1 * found.seconds.max(0.1), "{sum} of {}", found.seconds);
    }
}
