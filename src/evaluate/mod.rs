//! Measuring estimators on image pairs whose geometry is known.
//!
//! A [`Scene`] is an image pair with true matches and a true F. A [`Protocol`] says which of the true matches
//! are clicked in a trial; a [`Contender`] turns the clicks into an F; [`run`] lets all contenders make all
//! trials and [`Report`] holds what came out.
//!
//! The error of a trial is the mean symmetric epipolar distance of **all** true matches of the pair to the
//! estimated F, in pixels, clicked matches included, as the published experiment has it.
//!
//! # Paired trials
//! The clicks of trial `t` of a pair depend on the seed, the pair's name and `t` alone: not on the number of
//! trials, the order of the work, the threads, or the contenders. All contenders therefore see the same clicks
//! and can be compared trial by trial.
//!
//! # Pitfalls
//! - A trial without an F stays in the statistics with an infinite error; dropping it would flatter a
//!   contender that gives up on hard trials.
//! - Times are those of one trial on [`Plan::threads_per_trial`] threads while other trials run beside it.

mod contender;
mod protocol;
mod ranking;
mod report;
mod run;
mod scene;
mod statistics;
mod table;

pub use contender::{Choice, Contender, METHODS, MethodEntry, Outcome, contenders, method_names};
pub use protocol::{Draws, Protocol};
pub use ranking::SearchRecord;
pub use report::{Overall, Record, Report, Settings, Shares, TrialRecord, Verdicts};
pub use run::{Plan, TrialDone, run};
pub use scene::{EvaluateError, Scene, pair_scenes, vgg_scenes};
pub use statistics::{mean, median, share_below};
pub use table::{search_table, table, verdict_sentences};
