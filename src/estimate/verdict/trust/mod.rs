//! How far to trust a result: a verdict with its reasons in words. What they follow from is in `evidence`.

mod rules;

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub(in crate::estimate) use rules::{
    BarcodeEvidence, CHANCE_DEVIATIONS, CLICK_DEVIATIONS_WRONG, Evidence, GUESS, PlaneEvidence, RefinedOn,
    ResidualPattern, Together, USUAL_SIDE, WRONG_TOGETHER,
};
pub use rules::{CLEAR_MARGIN, CLICK_DEVIATIONS, ENOUGH_MATCHES, FAR_TOO_FEW};

/// How far to trust a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Everything that was looked at speaks for the result.
    Reliable,
    /// Something speaks against the result.
    Doubtful,
    /// The result contradicts the images or the clicks.
    Unreliable,
}

impl Verdict {
    /// What the user reads.
    pub fn label(self) -> &'static str {
        match self {
            Self::Reliable => "reliable",
            Self::Doubtful => "doubtful",
            Self::Unreliable => "unreliable",
        }
    }
}

/// What the groups of matches beside a plane say of the epipoles.
fn beside_the_plane(agreeing: usize, groups: usize) -> String {
    match (agreeing, groups) {
        (_, 0) => "nothing that stands out from it tells".to_owned(),
        (0, 1) => "the one motion beside it does not agree with that".to_owned(),
        (0, _) => format!("none of the {groups} motions beside it agrees with that"),
        _ => format!("only {agreeing} of {groups} motions beside it agree on that, which chance may explain"),
    }
}

/// How much a rival has beside a geometry with this advantage over it.
fn beside(margin: f64) -> &'static str {
    if margin < 0.0 { "more" } else { "nearly as much" }
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
    /// The refinement was switched off.
    #[error("the result was not refined, as was asked, so no patches at full resolution speak for it")]
    RefinementOff,
    /// The geometry is that of the clicks alone, which what patches found contradicts.
    #[error(
        "the clicks agree with each other and contradict the matches that were found: this geometry follows from the clicks alone"
    )]
    ClicksAlone,
    /// Few matches carry the result.
    #[error("only {matches} patches match along the epipolar lines")]
    FewMatches {
        /// Matches found.
        matches: usize,
    },
    /// Barcodes agree no better than by chance.
    #[error(
        "the motion barcodes of corresponding lines agree by {correlation:.2}, and by up to {by_chance:.2} when one sequence is shifted in time: they may not have been recorded at the same time, or too little moves"
    )]
    BarcodesByChance {
        /// Agreement, 1 for equal ones.
        correlation: f64,
        /// Agreement by chance.
        by_chance: f64,
    },
    /// Few lines have barcodes of their own.
    #[error(
        "only about {lines} lines are crossed in ways of their own: more things have to move, or in more places, or more frames are needed"
    )]
    FewBarcodes {
        /// Independent lines.
        lines: usize,
    },
    /// The barcodes leave the epipolar lines loose.
    #[error("the motion barcodes leave the epipolar lines uncertain by {deviation:.1} px")]
    LooseBarcodes {
        /// Standard deviation across the lines, px.
        deviation: f64,
    },
    /// A click is off its epipolar line.
    #[error("point pair {pair} is {distance:.1} px off its epipolar line: {suspect}")]
    ClickOff {
        /// Number of the pair, from 1.
        pair: usize,
        /// Sampson distance, px.
        distance: f64,
        /// What is likelier to be wrong.
        suspect: Suspect,
    },
    /// Matches that stand out and move together contradict the geometry.
    #[error(
        "{contradicting} of {matches} matches that stand out and move together contradict the geometry: something moves by itself, or the images are bent, or the geometry is wrong"
    )]
    Contradicted {
        /// How many contradict it.
        contradicting: usize,
        /// All that stand out and move together.
        matches: usize,
    },
    /// Nearly all matches follow one homography and a lens.
    #[error(
        "{percent} % of the matches fit one plane or a turn of the camera seen through a lens that bends straight lines: remove the distortion first, or use views from places farther apart"
    )]
    Bent {
        /// Percent of the matches.
        percent: u32,
    },
    /// Neighbouring matches are off their lines alike.
    #[error(
        "over whole parts of the picture the matches are off their lines by the same {size:.1} px: the images are bent against each other, or something moves, or the geometry only comes near"
    )]
    Pattern {
        /// Size of the pattern, px.
        size: f64,
    },
    /// A clearly different geometry has nearly as much support, or more.
    #[error("a clearly different geometry has {} support (margin {margin:.2})", beside(*margin))]
    Ambiguous {
        /// Relative advantage over it.
        margin: f64,
    },
    /// Nearly all matches follow one homography.
    #[error(
        "{percent} % of the matches fit one plane or a turn of the camera: lines through these hold, but where they meet is not determined, as {}: use views from places farther apart, or a scene with more depth and nothing that moves",
        beside_the_plane(*agreeing, *groups)
    )]
    OnePlane {
        /// Percent of the matches.
        percent: u32,
        /// Groups of matches off it that move alike.
        groups: usize,
        /// How many of these agree with the epipoles.
        agreeing: usize,
    },
    /// The matches leave the epipolar lines loose.
    #[error("the matches leave the epipolar lines uncertain by {deviation:.1} px")]
    Loose {
        /// Standard deviation across the lines, px.
        deviation: f64,
    },
}

/// What is likelier to be wrong where a click and a geometry disagree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Suspect {
    /// The click: everything else speaks for the geometry.
    Click,
    /// The geometry: other things speak against it, too.
    Geometry,
}

impl std::fmt::Display for Suspect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Click => {
                "the images speak for the geometry, so check that the pair shows the same scene point"
            }
            Self::Geometry => {
                "more than this speaks against the geometry, so the pair may be right: add another pair"
            }
        })
    }
}

/// A verdict and what led to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trust {
    /// The verdict.
    pub verdict: Verdict,
    /// What speaks against the result; empty when it is called reliable.
    pub reasons: Vec<Reason>,
}

impl Trust {
    /// Whether one plane, or a turn of the camera, is all that the images show for certain.
    pub fn says_one_plane(&self) -> bool {
        self.reasons.iter().any(|reason| matches!(reason, Reason::OnePlane { .. }))
    }
}
