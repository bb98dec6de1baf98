//! How far to trust a result: a verdict with its reasons. `rules` has the rules they follow from.

mod rules;

use serde::{Deserialize, Serialize};

pub(in crate::estimate) use rules::{
    BarcodeEvidence, CHANCE_DEVIATIONS, Evidence, PlaneEvidence, RefinedOn, ResidualPattern, Together,
    USUAL_SIDE, WRONG_TOGETHER,
};
pub use rules::{
    CLEAR_MARGIN, CLICK_DEVIATIONS, CLICK_DEVIATIONS_WRONG, ENOUGH_MATCHES, FAR_TOO_FEW, GUESS_MARGIN,
};

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

/// Something that speaks against a result. `presentation::reasons` has the sentences.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Reason {
    /// Patches were not looked at, so only the lines speak for it.
    NotChecked,
    /// The refinement did not find enough matches.
    NotRefined,
    /// The refinement was switched off.
    RefinementOff,
    /// The geometry is that of the clicks alone, which what patches found contradicts.
    ClicksAlone,
    /// Few matches carry the result.
    FewMatches {
        /// Matches found.
        matches: usize,
    },
    /// Barcodes agree no better than by chance.
    BarcodesByChance {
        /// Agreement, 1 for equal ones.
        correlation: f64,
        /// Agreement by chance.
        by_chance: f64,
    },
    /// Few lines have barcodes of their own.
    FewBarcodes {
        /// Independent lines.
        lines: usize,
    },
    /// The barcodes leave the epipolar lines loose.
    LooseBarcodes {
        /// Standard deviation across the lines, px.
        deviation: f64,
    },
    /// A click is off its epipolar line.
    ClickOff {
        /// Number of the pair, from 1.
        pair: usize,
        /// Sampson distance, px.
        distance: f64,
        /// What is likelier to be wrong.
        suspect: Suspect,
    },
    /// Matches that stand out and move together contradict the geometry.
    Contradicted {
        /// How many contradict it.
        contradicting: usize,
        /// All that stand out and move together.
        matches: usize,
    },
    /// Nearly all matches follow one homography and a lens.
    Bent {
        /// Percent of the matches.
        percent: u32,
    },
    /// Neighbouring matches are off their lines alike.
    Pattern {
        /// Size of the pattern, px.
        size: f64,
    },
    /// A clearly different geometry has nearly as much support, or more.
    Ambiguous {
        /// Relative advantage over it.
        margin: f64,
    },
    /// Nearly all matches follow one homography.
    OnePlane {
        /// Percent of the matches.
        percent: u32,
        /// Groups of matches off it that move alike.
        groups: usize,
        /// How many of these agree with the epipoles.
        agreeing: usize,
    },
    /// The matches leave the epipolar lines loose.
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
