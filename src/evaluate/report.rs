//! What came out of an evaluation, as written to files.

use serde::Serialize;
use serde_json::Value;

use super::bootstrap::{self, Interval, PairErrors};
use super::ranking::RankingRecord;
use super::statistics::{mean, median, share_below};
use super::{Contender, KnownScene, Plan};
use crate::estimate::Verdict;
use crate::geometry::FundamentalMatrix;

/// One trial of one contender. Infinite numbers are written as `null`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialRecord {
    /// Number of the trial, from 0.
    pub trial: usize,
    /// Numbers of the true matches that were clicked, from 0.
    pub matches: Vec<usize>,
    /// Where, as `x1 y1 x2 y2`, noise included, px.
    pub clicks: Vec<[f64; 4]>,
    /// The F found.
    pub fundamental: Option<FundamentalMatrix>,
    /// Mean symmetric epipolar distance of all true matches, px; infinite without an F.
    pub mean: f64,
    /// Median of the same distances, px.
    pub median: f64,
    /// Mean distance of its lines to the true ones all over the pictures, px, see [`KnownScene::off_everywhere`]; none
    /// where the true F was fitted to the matches.
    pub off_everywhere: Option<f64>,
    /// Seconds in all.
    pub seconds: f64,
    /// Seconds until the first F.
    pub first_seconds: Option<f64>,
    /// The contender's own score.
    pub score: Option<f64>,
    /// The contender's margin to the next best answer.
    pub margin: Option<f64>,
    /// The contender's own verdict.
    pub verdict: Option<Verdict>,
    /// What a user would have been told.
    pub warnings: Vec<String>,
    /// What it chose from, if it chooses.
    pub search: Option<RankingRecord>,
    /// Why there is no F.
    pub failure: Option<String>,
}

/// How often verdicts were true. A result is good when its error is below 1 % of the longer image side.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Verdicts {
    /// Results with a verdict.
    pub results: usize,
    /// Results called reliable.
    pub called_reliable: usize,
    /// Number of good ones among these.
    pub called_reliable_and_good: usize,
    /// Results that are not good.
    pub bad: usize,
    /// Number of these that were not called reliable.
    pub bad_and_not_called_reliable: usize,
    /// Good ones whose lines are as near to the true ones all over the pictures, where that is known.
    pub good_everywhere: usize,
    /// Number of these that were called reliable.
    pub good_everywhere_and_called_reliable: usize,
}

impl Verdicts {
    fn of(trials: &[TrialRecord], limit: f64) -> Self {
        let judged: Vec<_> = trials.iter().filter_map(|t| Some((t.verdict?, t.mean < limit))).collect();
        let count = |called_reliable: bool, good: bool| {
            judged.iter().filter(|(v, g)| (*v == Verdict::Reliable) == called_reliable && *g == good).count()
        };
        let (reliable_good, reliable_bad, bad_seen) =
            (count(true, true), count(true, false), count(false, false));
        let everywhere: Vec<Verdict> = trials
            .iter()
            .filter(|t| t.mean < limit && t.off_everywhere.is_some_and(|off| off < limit))
            .filter_map(|t| t.verdict)
            .collect();
        Self {
            results: judged.len(),
            called_reliable: reliable_good + reliable_bad,
            called_reliable_and_good: reliable_good,
            bad: reliable_bad + bad_seen,
            bad_and_not_called_reliable: bad_seen,
            good_everywhere: everywhere.len(),
            good_everywhere_and_called_reliable: everywhere
                .iter()
                .filter(|v| **v == Verdict::Reliable)
                .count(),
        }
    }

    fn sum(all: impl Iterator<Item = Self>) -> Self {
        all.fold(Self::default(), |sum, v| Self {
            results: sum.results + v.results,
            called_reliable: sum.called_reliable + v.called_reliable,
            called_reliable_and_good: sum.called_reliable_and_good + v.called_reliable_and_good,
            bad: sum.bad + v.bad,
            bad_and_not_called_reliable: sum.bad_and_not_called_reliable + v.bad_and_not_called_reliable,
            good_everywhere: sum.good_everywhere + v.good_everywhere,
            good_everywhere_and_called_reliable: sum.good_everywhere_and_called_reliable
                + v.good_everywhere_and_called_reliable,
        })
    }
}

/// Share of the trials, 0 to 1, that is better than a limit; failures are not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Shares {
    /// Error below 1 px.
    pub below_1_px: f64,
    /// Error below 3 px.
    pub below_3_px: f64,
    /// Error below 1 % of the longer image side.
    pub below_1_percent: f64,
}

/// All trials of one contender on one pair.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Record {
    /// The pair.
    pub pair: String,
    /// The method.
    pub method: String,
    /// The preset, if the method has presets, and refinement where it is not that of the preset.
    pub preset: Option<String>,
    /// Width and height of both images, px.
    pub image_sizes: [[usize; 2]; 2],
    /// How many true matches the error is measured on.
    pub matches: usize,
    /// Mean distance of the true matches to the true F, px.
    pub truth_error: f64,
    /// Trials asked for; fewer are made when the matches allow fewer.
    pub trials_asked: usize,
    /// Trials without an F.
    pub failures: usize,
    /// Median of the trials' mean distances, px.
    pub median: f64,
    /// 95 % interval of this median; `None` with fewer than six trials.
    pub median_interval: Option<Interval>,
    /// What the published experiment prints for this pair and method, px.
    pub printed: Option<f64>,
    /// Mean of the trials' mean distances, px.
    pub mean: f64,
    /// Trials within limits.
    pub shares: Shares,
    /// How often its verdicts were true.
    pub verdicts: Verdicts,
    /// Median seconds of a trial.
    pub median_seconds: f64,
    /// Median seconds until the first F, of the trials that found one.
    pub median_first_seconds: f64,
    /// The trials in their order.
    pub trials: Vec<TrialRecord>,
}

impl Record {
    pub(super) fn new(
        scene: &KnownScene,
        contender: &dyn Contender,
        plan: &Plan,
        trials: Vec<TrialRecord>,
    ) -> Self {
        let errors = errors(&trials);
        let sample = PairErrors { pair: &scene.name, errors: errors.clone() };
        let seconds: Vec<f64> = trials.iter().map(|t| t.seconds).collect();
        let first: Vec<f64> = trials.iter().filter_map(|t| t.first_seconds).collect();
        let size = |k: usize| [scene.images[k].frame().width, scene.images[k].frame().height];
        Self {
            pair: scene.name.clone(),
            method: contender.method().to_owned(),
            preset: contender.preset().map(str::to_owned),
            image_sizes: [size(0), size(1)],
            matches: scene.matches.len(),
            truth_error: scene.truth_error(),
            trials_asked: plan.trials,
            failures: trials.iter().filter(|t| t.fundamental.is_none()).count(),
            median: median(&errors),
            median_interval: bootstrap::interval(&[sample], plan.seed),
            printed: scene.printed.and_then(|p| p.of_method(contender.method())),
            mean: mean(&errors),
            shares: Shares {
                below_1_px: share_below(&errors, 1.0),
                below_3_px: share_below(&errors, 3.0),
                below_1_percent: share_below(&errors, scene.good_error()),
            },
            verdicts: Verdicts::of(&trials, scene.good_error()),
            median_seconds: median(&seconds),
            median_first_seconds: median(&first),
            trials,
        }
    }
}

/// The error of each trial, px.
fn errors(trials: &[TrialRecord]) -> Vec<f64> {
    trials.iter().map(|t| t.mean).collect()
}

/// One contender over all pairs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overall {
    /// The method.
    pub method: String,
    /// The preset, if the method has presets, and refinement where it is not that of the preset.
    pub preset: Option<String>,
    /// Pairs with at least one trial.
    pub pairs: usize,
    /// Trials made.
    pub trials: usize,
    /// Trials without an F.
    pub failures: usize,
    /// Median of the pairs' medians, px.
    pub median_of_medians: f64,
    /// 95 % interval of it over the draws of clicks, the pairs being what they are; `None` where a pair has fewer
    /// than six trials.
    pub median_of_medians_interval: Option<Interval>,
    /// Median of what the published experiment prints for the same pairs, px; `None` unless it prints all.
    pub printed: Option<f64>,
    /// Mean of all trials' errors, px.
    pub mean: f64,
    /// All trials within limits.
    pub shares: Shares,
    /// How often its verdicts were true.
    pub verdicts: Verdicts,
    /// Median seconds of all trials.
    pub median_seconds: f64,
    /// Median seconds until the first F, of the trials that found one.
    pub median_first_seconds: f64,
}

impl Overall {
    /// Sums up the records of one contender.
    pub(super) fn new(records: &[&Record], seed: u64) -> Option<Self> {
        let first = records.first()?;
        let made: Vec<_> = records.iter().filter(|r| !r.trials.is_empty()).collect();
        let trials = || made.iter().flat_map(|r| r.trials.iter());
        let samples: Vec<_> =
            made.iter().map(|r| PairErrors { pair: &r.pair, errors: errors(&r.trials) }).collect();
        let printed: Option<Vec<f64>> = made.iter().map(|r| r.printed).collect();
        let errors: Vec<f64> = trials().map(|t| t.mean).collect();
        let medians: Vec<f64> = made.iter().map(|r| r.median).collect();
        let count = errors.len() as f64;
        // The limit differs between pairs, so shares are summed weighted by the number of trials.
        let share = |of: fn(&Shares) -> f64| {
            made.iter().map(|r| of(&r.shares) * r.trials.len() as f64).sum::<f64>() / count
        };
        Some(Self {
            method: first.method.clone(),
            preset: first.preset.clone(),
            pairs: made.len(),
            trials: errors.len(),
            failures: made.iter().map(|r| r.failures).sum(),
            median_of_medians: median(&medians),
            median_of_medians_interval: bootstrap::interval(&samples, seed),
            printed: printed.filter(|p| !p.is_empty()).map(|p| median(&p)),
            mean: mean(&errors),
            shares: Shares {
                below_1_px: share(|s| s.below_1_px),
                below_3_px: share(|s| s.below_3_px),
                below_1_percent: share(|s| s.below_1_percent),
            },
            verdicts: Verdicts::sum(made.iter().map(|r| r.verdicts)),
            median_seconds: median(&trials().map(|t| t.seconds).collect::<Vec<_>>()),
            median_first_seconds: median(&trials().filter_map(|t| t.first_seconds).collect::<Vec<_>>()),
        })
    }
}

/// What was asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// How the trials were drawn and run.
    #[serde(flatten)]
    pub plan: Plan,
    /// The parameters of every contender, in the order of the records of one pair.
    pub contenders: Vec<Value>,
}

/// Everything that came out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// What was asked for.
    pub parameters: Settings,
    /// Trials that were to be made.
    pub trials_planned: usize,
    /// Trials that were made; fewer when the run was stopped.
    pub trials_made: usize,
    /// What the reader should know, one sentence each.
    pub notes: Vec<String>,
    /// One per contender, over all pairs.
    pub overall: Vec<Overall>,
    /// One per pair and contender, pairs outermost.
    pub records: Vec<Record>,
}
