//! Execution of all trials of all contenders, several at a time.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use serde_json::json;

use super::ranking::RankingRecord;
use super::report::{Overall, Record, Report, Settings, TrialRecord};
use super::{Contender, Draws, EvaluateError, KnownScene, Outcome, Plan};
use super::{mean, median};
use epiline::estimate::CancelFlag;
use epiline::geometry::PointPair;

/// Progress message after a trial.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialDone {
    /// Number of finished trials, including this one.
    pub done: usize,
    /// Total number of trials.
    pub total: usize,
    /// Name of the pair.
    pub pair: String,
    /// Method and preset of the contender.
    pub contender: String,
    /// Error of the trial, px; infinite without an F.
    pub error: f64,
}

/// Trial of one contender on one scene.
#[derive(Debug, Clone)]
struct TrialJob {
    scene: usize,
    contender: usize,
    trial: usize,
    matches: Vec<usize>,
}

/// Runs all trials. Every finished trial calls `progress`, on any thread.
///
/// The first trial of every pair and contender precedes the second of any. Setting `stop` prevents
/// new trials; running ones finish. The report then holds about the same number of trials for each
/// pair and contender.
pub fn run(
    scenes: &[KnownScene],
    contenders: &[Box<dyn Contender>],
    plan: &Plan,
    progress: &(dyn Fn(&TrialDone) + Sync),
    stop: &CancelFlag,
) -> Result<Report, EvaluateError> {
    let draws: Vec<_> = scenes
        .iter()
        .map(|s| Draws::new(s.known(), plan.protocol, plan.trials, plan.noise, plan.seed))
        .collect();
    let (jobs, mut notes) = plan_jobs(scenes, contenders, plan, &draws);
    let finished = run_jobs(scenes, contenders, plan, &draws, &jobs, progress, stop)?;
    let trials_made = finished.len();
    if trials_made < jobs.len() {
        notes.push(format!("Stopped: {trials_made} of {} trials were made.", jobs.len()));
    }

    let mut trials: Vec<Vec<TrialRecord>> = vec![Vec::new(); scenes.len() * contenders.len()];
    for (index, record) in finished {
        let job = &jobs[index];
        trials[job.scene * contenders.len() + job.contender].push(record);
    }
    let mut trials = trials.into_iter();
    let mut records = Vec::new();
    for scene in scenes {
        for contender in contenders {
            let trials = trials.next().unwrap_or_default();
            records.push(Record::new(scene, contender.as_ref(), plan, trials));
        }
    }
    let overall = (0..contenders.len())
        .filter_map(|c| {
            let own: Vec<_> = records.iter().skip(c).step_by(contenders.len()).collect();
            Overall::new(&own, plan.seed)
        })
        .collect();
    let contenders = contenders
        .iter()
        .map(|c| json!({ "method": c.method(), "preset": c.preset(), "parameters": c.parameters() }))
        .collect();
    let parameters = Settings { plan: *plan, contenders };
    Ok(Report { parameters, trials_planned: jobs.len(), trials_made, notes, overall, records })
}

/// Returns the trials to run, in order, and notes on trials that are impossible.
fn plan_jobs(
    scenes: &[KnownScene],
    contenders: &[Box<dyn Contender>],
    plan: &Plan,
    draws: &[Draws],
) -> (Vec<TrialJob>, Vec<String>) {
    let mut jobs = Vec::new();
    let mut notes = Vec::new();
    for (scene, draws) in draws.iter().enumerate() {
        let name = &scenes[scene].name;
        if draws.trials() < plan.trials {
            notes.push(format!(
                "{name}: {} of {} trials. The {} protocol allows no more combinations of its {} matches.",
                draws.trials(),
                plan.trials,
                plan.protocol.name(),
                scenes[scene].matches.len(),
            ));
        }
        for (contender, who) in contenders.iter().enumerate() {
            let before = jobs.len();
            if who.clicks_needed() == 0 {
                // Without clicks all trials are equal, so one is enough.
                jobs.push(TrialJob { scene, contender, trial: 0, matches: Vec::new() });
                continue;
            }
            jobs.extend((0..draws.trials()).filter_map(|trial| {
                let matches = draws.matches(trial, who.clicks_needed())?;
                Some(TrialJob { scene, contender, trial, matches })
            }));
            let missing = draws.trials() - (jobs.len() - before);
            if missing > 0 {
                notes.push(format!(
                    "{name}: {missing} trials without {}. There no further match is far enough from the others.",
                    who.method()
                ));
            }
        }
    }
    jobs.sort_by_key(|job| (job.trial, job.scene, job.contender));
    (jobs, notes)
}

/// Runs jobs until the stop. Returns their records in order, with the index of the job.
fn run_jobs(
    scenes: &[KnownScene],
    contenders: &[Box<dyn Contender>],
    plan: &Plan,
    draws: &[Draws],
    jobs: &[TrialJob],
    progress: &(dyn Fn(&TrialDone) + Sync),
    stop: &CancelFlag,
) -> Result<Vec<(usize, TrialRecord)>, EvaluateError> {
    let workers = plan.trials_at_once.clamp(1, jobs.len().max(1));
    let threads = plan.threads_per_trial.max(1);
    let pools = (0..workers)
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(threads).build())
        .collect::<Result<Vec<_>, _>>()
        .map_err(|e| EvaluateError::Threads { threads: workers * threads, reason: e.to_string() })?;
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let work = |pool: &rayon::ThreadPool| {
        let mut made = Vec::new();
        loop {
            if stop.is_cancelled() {
                return made;
            }
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(index) else { return made };
            let (scene, contender) = (&scenes[job.scene], &contenders[job.contender]);
            let record = pool.install(|| run_trial(scene, contender.as_ref(), &draws[job.scene], job));
            progress(&TrialDone {
                done: done.fetch_add(1, Ordering::Relaxed) + 1,
                total: jobs.len(),
                pair: scene.name.clone(),
                contender: contender.label(),
                error: record.mean,
            });
            made.push((index, record));
        }
    };
    let mut made: Vec<_> = std::thread::scope(|scope| {
        let handles: Vec<_> = pools.iter().map(|pool| scope.spawn(|| work(pool))).collect();
        handles.into_iter().flat_map(|h| h.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    });
    made.sort_by_key(|(index, _)| *index);
    Ok(made)
}

/// Runs one trial. A panic counts as a failed trial, so that the other results survive.
fn run_trial(scene: &KnownScene, contender: &dyn Contender, draws: &Draws, job: &TrialJob) -> TrialRecord {
    let clicks = draws.clicks(job.trial, &job.matches);
    let started = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| contender.estimate(scene, &clicks)))
        .unwrap_or_else(|_| Err("internal error (a panic) in the estimator".to_owned()));
    let elapsed = started.elapsed().as_secs_f64();
    let failed = TrialRecord {
        trial: job.trial,
        matches: job.matches.clone(),
        clicks: clicks.iter().map(PointPair::numbers).collect(),
        mean: f64::INFINITY,
        median: f64::INFINITY,
        seconds: elapsed,
        ..TrialRecord::default()
    };
    match outcome {
        Err(failure) => TrialRecord { failure: Some(failure), ..failed },
        Ok(Outcome { fundamental, seconds, first_seconds, score, margin, verdict, warnings, choice }) => {
            let distances = scene.distances(&fundamental);
            TrialRecord {
                fundamental: Some(fundamental),
                mean: mean(&distances),
                median: median(&distances),
                off_everywhere: scene.off_everywhere(&fundamental),
                seconds,
                first_seconds: Some(first_seconds),
                score,
                margin,
                verdict,
                warnings,
                search: choice.and_then(|choice| RankingRecord::new(scene, &choice)),
                ..failed
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Protocol;
    use crate::scene::tests::example_scene;

    /// Contender that returns the truth, except where it fails deliberately.
    struct Oracle {
        clicks: usize,
        fails: fn(&[PointPair]) -> bool,
    }

    impl Contender for Oracle {
        fn method(&self) -> &'static str {
            "oracle"
        }

        fn clicks_needed(&self) -> usize {
            self.clicks
        }

        fn estimate(&self, scene: &KnownScene, clicks: &[PointPair]) -> Result<Outcome, String> {
            assert_eq!(clicks.len(), self.clicks);
            if (self.fails)(clicks) {
                return Err("no idea".into());
            }
            Ok(Outcome::unassessed(scene.truth, 0.5))
        }
    }

    fn oracle(clicks: usize, fails: fn(&[PointPair]) -> bool) -> Box<dyn Contender> {
        Box::new(Oracle { clicks, fails })
    }

    fn plan(trials_at_once: usize) -> Plan {
        Plan {
            protocol: Protocol::Paper,
            trials: 12,
            noise: 0.5,
            seed: 4,
            trials_at_once,
            threads_per_trial: 1,
        }
    }

    #[test]
    fn contenders_see_the_same_clicks_whatever_the_threads() {
        let scenes = [example_scene("one", 30), example_scene("two", 30)];
        let all = [oracle(2, |_| false), oracle(3, |_| false)];
        let report = run(&scenes, &all, &plan(3), &|_| (), &CancelFlag::default()).unwrap();
        let again = run(&scenes, &all, &plan(1), &|_| (), &CancelFlag::default()).unwrap();
        assert_eq!(report.records.len(), 4);
        for (record, other) in report.records.iter().zip(&again.records) {
            let clicks = |r: &Record| r.trials.iter().map(|t| t.clicks.clone()).collect::<Vec<_>>();
            assert_eq!(clicks(record), clicks(other));
            assert!(record.median < 1e-8 && record.failures == 0);
        }
        for (two, three) in report.records[0].trials.iter().zip(&report.records[1].trials) {
            assert_eq!((two.trial, &two.clicks[..]), (three.trial, &three.clicks[..2]));
        }
        let one_alone = run(&scenes[1..], &all[..1], &plan(2), &|_| (), &CancelFlag::default()).unwrap();
        assert_eq!(one_alone.records[0].trials[7].clicks, report.records[2].trials[7].clicks);
    }

    #[test]
    fn failures_and_panics_are_kept_and_counted() {
        let scenes = [example_scene("one", 30)];
        let all = [
            oracle(2, |clicks| clicks[0].point1.x < 384.0),
            oracle(2, |clicks| {
                assert!(clicks[0].point1.x >= 384.0, "left half, on purpose");
                false
            }),
        ];
        let report = run(&scenes, &all, &plan(2), &|_| (), &CancelFlag::default()).unwrap();
        let [failing, panicking] = &report.records[..] else { panic!("two records") };
        assert!(failing.failures > 0 && failing.failures < 12);
        assert_eq!(failing.failures, panicking.failures);
        assert_eq!(failing.trials.len(), 12);
        assert!(failing.figures.mean.is_infinite());
        let trial = failing.trials.iter().find(|t| t.failure.is_some()).unwrap();
        assert_eq!(trial.failure.as_deref(), Some("no idea"));
        let json = serde_json::to_value(&report).unwrap();
        assert!(json["records"][0]["mean"].is_null());
        assert!(json["records"][0]["trials"][trial.trial]["fundamental"].is_null());
        assert_eq!(json["parameters"]["protocol"], "paper");
    }

    #[test]
    fn every_trial_is_reported_and_too_few_are_said() {
        let mut scene = example_scene("small", 30);
        scene.matches.truncate(3);
        let heard = std::sync::Mutex::new(Vec::new());
        let hear = |news: &TrialDone| heard.lock().unwrap().push(news.done);
        let all = [oracle(2, |_| false), oracle(4, |_| false)];
        let report = run(&[scene], &all, &plan(2), &hear, &CancelFlag::default()).unwrap();
        let made = report.records[0].trials.len();
        assert!((1..=3).contains(&made));
        let mut heard = heard.into_inner().unwrap();
        heard.sort_unstable();
        assert_eq!(heard, (1..=made).collect::<Vec<_>>());
        assert!(report.notes[0].starts_with("small: "), "{:?}", report.notes);
        assert!(report.notes[1].contains("no further match"), "{:?}", report.notes);
        assert_eq!(report.overall[0].trials, made);
        assert_eq!((report.overall[1].pairs, report.overall[1].trials), (0, 0));
        assert!(report.overall[1].median_of_medians.is_nan());
    }

    #[test]
    fn a_stopped_run_reports_what_was_made_evenly_over_pairs_and_contenders() {
        let scenes = [example_scene("one", 30), example_scene("two", 30)];
        let all = [oracle(2, |_| false), oracle(3, |_| true)];
        let stop = CancelFlag::default();
        let after_ten = |news: &TrialDone| {
            if news.done == 10 {
                stop.cancel();
            }
        };
        let partial = run(&scenes, &all, &plan(1), &after_ten, &stop).unwrap();
        let whole = run(&scenes, &all, &plan(2), &|_| (), &CancelFlag::default()).unwrap();
        assert_eq!((partial.trials_made, partial.trials_planned), (10, 48));
        assert_eq!((whole.trials_made, whole.trials_planned), (48, 48));
        let counts: Vec<_> = partial.records.iter().map(|r| r.trials.len()).collect();
        assert_eq!(counts, [3, 3, 2, 2]);
        for (part, all) in partial.records.iter().zip(&whole.records) {
            let clicks = |r: &Record| r.trials.iter().map(|t| t.clicks.clone()).collect::<Vec<_>>();
            assert_eq!(clicks(part), clicks(all)[..part.trials.len()]);
        }
        assert_eq!(partial.overall[1].failures, 5);
        assert_eq!(partial.notes, ["Stopped: 10 of 48 trials were made."]);
        assert!(whole.notes.is_empty());

        let before_the_first = run(&scenes, &all, &plan(2), &|_| (), &stop).unwrap();
        assert_eq!(before_the_first.trials_made, 0);
        let text = crate::table(&before_the_first);
        assert!(text.contains("0 of 48") && !text.contains("NaN"), "{text}");
    }
}
