//! Measuring estimators on image pairs whose geometry is known.
//!
//! A [`KnownScene`] is an image pair with true matches and a true F. A [`Protocol`] says which of the true matches
//! are clicked in a trial; a [`Contender`] turns the clicks into an F; [`run`] lets all contenders make all
//! trials and [`Report`] holds what came out. [`table`] shows it as text, [`publication`] as a document with plots and
//! pictures.
//!
//! The error of a trial is the mean symmetric epipolar distance of **all** true matches of the pair to the
//! estimated F, in pixels, clicked matches included, as the published experiment has it.
//!
//! # Paired trials
//! The clicks of trial `t` of a pair depend on the seed, the pair's name and `t` alone: not on the number of
//! trials, the order of the work, the threads, or the contenders. All contenders therefore see the same clicks
//! and can be compared trial by trial.
//!
//! # Baselines
//! The seven-point and the eight-point method get the clicks of the others and the further ones they need. Seven
//! pairs have up to three solutions; as in the published experiment the one nearest to **all** true matches
//! counts. That choice is given the truth, so the figures of the seven-point method are better than anybody could
//! reach with seven pairs alone.
//!
//! # Pitfalls
//! - A trial without an F stays in the statistics with an infinite error; dropping it would flatter a
//!   contender that gives up on hard trials.
//! - An interval of a median (see [`Interval`]) says what other clicks on the same pairs might have given. It says
//!   nothing about other image pairs.
//! - The published experiment prints one number a pair without saying whether it is a mean or a median of its
//!   ten trials.
//! - Times are those of one trial on [`Plan::threads_per_trial`] threads while other trials run beside it.

mod bootstrap;
mod comparison;
mod contender;
mod printed;
mod protocol;
mod publication;
mod random;
mod ranking;
mod report;
mod run;
mod scene;
mod statistics;
mod table;

pub use bootstrap::Interval;
pub use comparison::{Distances, FitError, PointFit, Spread, fit_eight, fit_seven};
pub use contender::{Choice, Contender, Detail, METHODS, MethodEntry, Outcome, contenders, method_names};
pub use printed::PrintedErrors;
pub use protocol::{Draws, KnownPair, Plan, Protocol};
pub use publication::{ReportSubject, publication};
pub use ranking::RankingRecord;
pub use report::{Overall, Record, Report, Settings, Shares, TrialRecord, Verdicts};
pub use run::{TrialDone, run};
pub use scene::{
    EvaluateError, KnownScene, SceneSet, files_read, pair_scene_set, pair_scenes, sequence_scene_set,
    vgg_scene_set, vgg_scenes,
};
pub use statistics::{mean, median, quantile, share_below};
pub use table::{search_table, table, verdict_sentences};
