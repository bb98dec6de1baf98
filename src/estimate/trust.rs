//! How far to trust a result: a verdict with its reasons in words.

use serde::Serialize;
use thiserror::Error;

/// How far to trust a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Everything that was looked at speaks for it.
    Right,
    /// Something speaks against it.
    Doubtful,
    /// It contradicts the images or the clicks.
    Wrong,
}

/// Something that speaks against a result. Each message is one sentence.
#[derive(Debug, Clone, PartialEq, Error, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Reason {
    /// Patches were not looked at, so only the lines speak for it.
    #[error("patches were not compared, so nothing but the lines speaks for this geometry")]
    NotChecked,
    /// The refinement did not find enough matches.
    #[error("too few patches match along the epipolar lines at full resolution")]
    NotRefined,
    /// Few matches carry the result.
    #[error("only {matches} patches match along the epipolar lines")]
    FewMatches {
        /// Matches found.
        matches: usize,
    },
    /// Few of the corners with a look-alike find it on their epipolar line.
    #[error("only {percent} % of the distinct patches find their match on their epipolar line")]
    LowShare {
        /// Percent of the corners.
        percent: u32,
    },
    /// A click is off its epipolar line.
    #[error(
        "point pair {pair} is {distance:.1} px off its epipolar line: check that it shows the same scene point"
    )]
    ClickOff {
        /// Number of the pair, from 1.
        pair: usize,
        /// Sampson distance, px.
        distance: f64,
    },
    /// A clearly different geometry has nearly as much support.
    #[error("a clearly different geometry has nearly as much support (margin {margin:.2})")]
    Ambiguous {
        /// Relative advantage over it.
        margin: f64,
    },
    /// The matches leave the epipolar lines loose.
    #[error("the matches leave the epipolar lines uncertain by {deviation:.1} px")]
    Loose {
        /// Standard deviation across the lines, px.
        deviation: f64,
    },
}

/// A verdict and what led to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trust {
    /// The verdict.
    pub verdict: Verdict,
    /// What speaks against the result; empty when it is called right.
    pub reasons: Vec<Reason>,
}
