//! Measurement of estimators on image pairs with ground truth.
//!
//! A [`KnownScene`] is an image pair with true matches and a true F. A [`Protocol`] selects the
//! true matches to click in a trial; a [`Contender`] turns the clicks into an F. [`run`] runs all
//! trials of all contenders and returns a [`Report`]. [`table`] formats the report as text.
//! [`main`] is the program: its command line writes the report as JSON, and `plot.py` draws it.
//!
//! The error of a trial is the mean symmetric epipolar distance of **all** true matches of the pair
//! under the estimated F, in pixels. Clicked matches are included, as in the published experiment.
//!
//! # Paired trials
//! The clicks of trial `t` of a pair depend only on the seed, the pair's name and `t`. The number
//! of trials, the order of work, the threads and the contenders have no influence. All contenders
//! therefore receive the same clicks and can be compared trial by trial.
//!
//! # Baselines
//! The seven-point and the eight-point method receive the clicks of the others, and further ones.
//! Seven pairs have up to three solutions; as in the published experiment the solution nearest to
//! **all** true matches is selected. That selection uses the ground truth, so seven pairs alone
//! could not reach the accuracy given for the seven-point method.
//!
//! # Pitfalls
//! - A trial without an F counts as an infinite error. Dropping it would favour a contender that
//!   gives up on hard trials.
//! - An interval of a median (see [`Interval`]) covers other clicks on the same pairs. It does not
//!   cover other image pairs.
//! - The published experiment prints one number per pair, without saying whether it is a mean or a
//!   median of its ten trials.
//! - Times are of one trial on [`Plan::threads_per_trial`] threads while other trials run in
//!   parallel.

mod bootstrap;
mod command;
mod contender;
mod error;
mod printed;
mod progress;
mod protocol;
mod ranking;
mod report;
mod run;
mod scene;
mod table;

pub use bootstrap::Interval;
pub use command::main;
pub use contender::{Choice, Contender, METHODS, MethodEntry, Outcome, contenders, method_names};
pub use epiline::internals::comparison::{KnownPair, mean, median, share_below};
pub use printed::PrintedErrors;
pub use protocol::{Draws, Plan, Protocol};
pub use ranking::RankingRecord;
pub use report::{Figures, Overall, Record, Report, Settings, Shares, TrialRecord, Verdicts};
pub use run::{TrialDone, run};
pub use scene::{
    EvaluateError, KnownScene, SceneSet, files_read, pair_scene_set, pair_scenes, sequence_scene_set,
    vgg_scene_set, vgg_scenes,
};
pub use table::{search_table, table, verdict_sentences};
