//! The estimator as a caller uses it: accuracy on ground truth, repeatability, cancellation and
//! invalid input.

mod changed;
mod degenerate;
mod following;
mod killed;
mod real;
mod rectified;
mod repeatable;
mod samples;
#[path = "../../../tests/skipping/mod.rs"]
mod skipping;
mod suggested;
mod support;
mod watched;
mod wide;
