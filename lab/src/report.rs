//! Results of an evaluation, as written to files.

use serde::Serialize;
use serde_json::Value;

use super::bootstrap::{self, Interval, PairErrors};
use super::ranking::RankingRecord;
use super::{Contender, KnownScene, Plan};
use super::{mean, median, share_below};
use epiline::estimate::Verdict;
use epiline::geometry::FundamentalMatrix;

/// Trial of one contender. Infinite numbers are serialised as `null`.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TrialRecord {
    /// Index of the trial, from 0.
    pub trial: usize,
    /// Indices of the clicked true matches, from 0.
    pub matches: Vec<usize>,
    /// Clicks as `x1 y1 x2 y2`, with noise, px.
    pub clicks: Vec<[f64; 4]>,
    /// Estimated F.
    pub fundamental: Option<FundamentalMatrix>,
    /// Mean symmetric epipolar distance of all true matches, px; infinite without an F.
    pub mean: f64,
    /// Median symmetric epipolar distance of all true matches, px.
    pub median: f64,
    /// Mean distance of the estimated to the true epipolar lines over the whole images, px, see
    /// [`KnownScene::off_everywhere`]. `None` if the true F was fitted to the matches.
    pub off_everywhere: Option<f64>,
    /// Total time, s.
    pub seconds: f64,
    /// Time until the first F, s.
    pub first_seconds: Option<f64>,
    /// Score computed by the contender.
    pub score: Option<f64>,
    /// Margin to the next best geometry.
    pub margin: Option<f64>,
    /// Verdict of the contender.
    pub verdict: Option<Verdict>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Ranking of the hypotheses, if there was a search.
    pub search: Option<RankingRecord>,
    /// Reason why there is no F.
    pub failure: Option<String>,
}

/// Accuracy of verdicts. A result is good if its error is below 1 % of the longer image side.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Verdicts {
    /// Number of results with a verdict.
    pub results: usize,
    /// Number of results called reliable.
    pub called_reliable: usize,
    /// Number of good results among `called_reliable`.
    pub called_reliable_and_good: usize,
    /// Number of results that are not good.
    pub bad: usize,
    /// Number of `bad` results that were not called reliable.
    pub bad_and_not_called_reliable: usize,
    /// Number of good results whose lines are also within the limit over the whole images, if
    /// known.
    pub good_everywhere: usize,
    /// Number of `good_everywhere` results that were called reliable.
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

/// Fractions of the trials below a limit, 0 to 1; failures count as above.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Shares {
    /// Fraction with an error below 1 px.
    pub below_1_px: f64,
    /// Fraction with an error below 3 px.
    pub below_3_px: f64,
    /// Fraction with an error below 1 % of the longer image side.
    pub below_1_percent: f64,
}

/// Statistics of some trials.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figures {
    /// Error printed by the published experiment, px.
    pub printed: Option<f64>,
    /// Mean of the trials' mean distances, px.
    pub mean: f64,
    /// Fractions of the trials below the limits.
    pub shares: Shares,
    /// Accuracy of the verdicts.
    pub verdicts: Verdicts,
    /// Median time of a trial, s.
    pub median_seconds: f64,
    /// Median time until the first F, over the trials with an F, s.
    pub median_first_seconds: f64,
}

impl Figures {
    fn of(trials: &[&TrialRecord], printed: Option<f64>, shares: Shares, verdicts: Verdicts) -> Self {
        let seconds: Vec<f64> = trials.iter().map(|t| t.seconds).collect();
        let first: Vec<f64> = trials.iter().filter_map(|t| t.first_seconds).collect();
        let errors: Vec<f64> = trials.iter().map(|t| t.mean).collect();
        let [median_seconds, median_first_seconds] = [seconds, first].map(|times| median(&times));
        Self { printed, mean: mean(&errors), shares, verdicts, median_seconds, median_first_seconds }
    }
}

/// All trials of one contender on one pair.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Record {
    /// Name of the pair.
    pub pair: String,
    /// Name of the method.
    pub method: String,
    /// Preset, if the method has presets, with a suffix if refinement differs from the preset.
    pub preset: Option<String>,
    /// Width and height of both images, px.
    pub image_sizes: [[usize; 2]; 2],
    /// Number of true matches.
    pub matches: usize,
    /// Mean symmetric epipolar distance of the true matches under the true F, px.
    pub truth_error: f64,
    /// Number of trials requested. The matches may allow fewer.
    pub trials_asked: usize,
    /// Number of trials without an F.
    pub failures: usize,
    /// Median of the trials' mean distances, px.
    pub median: f64,
    /// 95 % interval of this median; `None` with fewer than six trials.
    pub median_interval: Option<Interval>,
    /// Statistics of all trials. `printed` is the error of the published experiment for this pair
    /// and method.
    #[serde(flatten)]
    pub figures: Figures,
    /// Trials in their order.
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
        let shares = Shares {
            below_1_px: share_below(&errors, 1.0),
            below_3_px: share_below(&errors, 3.0),
            below_1_percent: share_below(&errors, scene.good_error()),
        };
        let printed = scene.printed.and_then(|p| p.of_method(contender.method()));
        let verdicts = Verdicts::of(&trials, scene.good_error());
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
            figures: Figures::of(&trials.iter().collect::<Vec<_>>(), printed, shares, verdicts),
            trials,
        }
    }
}

/// Returns the error of each trial, px.
fn errors(trials: &[TrialRecord]) -> Vec<f64> {
    trials.iter().map(|t| t.mean).collect()
}

/// Summary of one contender over all pairs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overall {
    /// Name of the method.
    pub method: String,
    /// Preset, if the method has presets, with a suffix if refinement differs from the preset.
    pub preset: Option<String>,
    /// Number of pairs with at least one trial.
    pub pairs: usize,
    /// Number of trials.
    pub trials: usize,
    /// Number of trials without an F.
    pub failures: usize,
    /// Median of the pairs' medians, px.
    pub median_of_medians: f64,
    /// 95 % interval of this median over the draws of clicks, with the pairs fixed; `None` if a
    /// pair has fewer than six trials.
    pub median_of_medians_interval: Option<Interval>,
    /// Statistics of all trials. `printed` is the median of the printed errors of the same pairs;
    /// `None` unless all are printed.
    #[serde(flatten)]
    pub figures: Figures,
}

impl Overall {
    /// Summarises the records of one contender.
    pub(super) fn new(records: &[&Record], seed: u64) -> Option<Self> {
        let first = records.first()?;
        let made: Vec<_> = records.iter().filter(|r| !r.trials.is_empty()).collect();
        let trials: Vec<&TrialRecord> = made.iter().flat_map(|r| &r.trials).collect();
        let samples: Vec<_> =
            made.iter().map(|r| PairErrors { pair: &r.pair, errors: errors(&r.trials) }).collect();
        let printed: Option<Vec<f64>> = made.iter().map(|r| r.figures.printed).collect();
        let medians: Vec<f64> = made.iter().map(|r| r.median).collect();
        // The relative limit differs between pairs, so fractions are weighted by the number of
        // trials.
        let share = |of: fn(&Shares) -> f64| {
            made.iter().map(|r| of(&r.figures.shares) * r.trials.len() as f64).sum::<f64>()
                / trials.len() as f64
        };
        let shares = Shares {
            below_1_px: share(|s| s.below_1_px),
            below_3_px: share(|s| s.below_3_px),
            below_1_percent: share(|s| s.below_1_percent),
        };
        let printed = printed.filter(|p| !p.is_empty()).map(|p| median(&p));
        let verdicts = Verdicts::sum(made.iter().map(|r| r.figures.verdicts));
        Some(Self {
            method: first.method.clone(),
            preset: first.preset.clone(),
            pairs: made.len(),
            trials: trials.len(),
            failures: made.iter().map(|r| r.failures).sum(),
            median_of_medians: median(&medians),
            median_of_medians_interval: bootstrap::interval(&samples, seed),
            figures: Figures::of(&trials, printed, shares, verdicts),
        })
    }
}

/// Settings of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Plan of the trials.
    #[serde(flatten)]
    pub plan: Plan,
    /// Parameters of every contender, in the order of the records of one pair.
    pub contenders: Vec<Value>,
}

/// Report of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Settings of the run.
    pub parameters: Settings,
    /// Number of planned trials.
    pub trials_planned: usize,
    /// Number of trials made; smaller if the run was stopped.
    pub trials_made: usize,
    /// Notes for the reader, one sentence each.
    pub notes: Vec<String>,
    /// Summaries over all pairs, one per contender.
    pub overall: Vec<Overall>,
    /// Records, one per pair and contender, pairs outermost.
    pub records: Vec<Record>,
}
