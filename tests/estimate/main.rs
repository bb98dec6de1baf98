//! The estimator as a caller uses it: accuracy where truth is known, repeatability, stopping, and bad input.

mod changed;
mod degenerate;
mod following;
mod killed;
mod real;
mod rectified;
mod repeatable;
mod samples;
mod support;
mod watched;
mod wide;
