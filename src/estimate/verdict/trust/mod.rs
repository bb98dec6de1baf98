//! Verdict on a result, with its reasons. `evidence` has the figures and tests each by itself;
//! `rules` combines the tests into the verdict.

mod evidence;
mod rules;

use serde::{Deserialize, Serialize};

pub use evidence::BarcodeFigures;
pub(in crate::estimate) use evidence::{
    ALONG, ANY_EPIPOLE, Evidence, HALF_PLANE, Mirror, OffPlane, PlaneEvidence, RefinedOn, Relief,
    ResidualPattern, Together, USUAL_SIDE, WRONG_TOGETHER, Witnesses,
};
pub(in crate::estimate) use rules::CHANCE_DEVIATIONS;
pub use rules::{
    CLEAR_MARGIN, CLICK_DEVIATIONS, CLICK_DEVIATIONS_WRONG, ENOUGH_MATCHES, FAR_TOO_FEW, GUESS_MARGIN,
};

named! {
    fn label;
    /// Reliability of a result.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Verdict {
        /// No test speaks against the result.
        Reliable = "reliable",
        /// At least one test speaks against the result.
        Doubtful = "doubtful",
        /// The result contradicts the images or the clicks, or rests on far too few matches.
        Unreliable = "unreliable",
    }
}

/// Failed test of a result. `presentation::reasons` has the sentences, `docs/verdicts.md` explains
/// them.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Reason {
    /// No patches were compared, so only lines support the result.
    NotChecked,
    /// The refinement did not find enough matches.
    NotRefined,
    /// The refinement was off.
    RefinementOff,
    /// The geometry follows from the clicks alone, which contradict the matches of the images.
    ClicksAlone,
    /// The result rests on few matches.
    FewMatches {
        /// Number of matches.
        matches: usize,
    },
    /// The barcodes of corresponding lines agree no better than by chance.
    BarcodesByChance {
        /// Agreement, 1 for equal barcodes.
        correlation: f64,
        /// Largest agreement by chance.
        by_chance: f64,
    },
    /// Few lines have other barcodes than their neighbours.
    FewBarcodes {
        /// Number of independent lines.
        lines: usize,
    },
    /// The barcodes leave the epipolar lines uncertain.
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
        /// The part that is more likely wrong.
        suspect: Suspect,
    },
    /// More distinctive matches contradict the geometry than are wrong by chance. Only matches that
    /// move like their neighbours count.
    Contradicted {
        /// Number of matches that contradict it.
        contradicting: usize,
        /// Number of all distinctive matches that move like their neighbours.
        matches: usize,
    },
    /// Most matches follow one homography with radial distortion.
    Bent {
        /// Percent of the matches.
        percent: u32,
    },
    /// Neighbouring matches are off their lines by the same distance.
    Pattern {
        /// Size of the pattern, px.
        size: f64,
    },
    /// A clearly different geometry has nearly as much support as the result, or more.
    Ambiguous {
        /// Relative advantage of the result, negative if it has less support.
        margin: f64,
    },
    /// Most matches follow one homography, and the others do not determine the epipoles.
    OnePlane {
        /// Percent of the matches.
        percent: u32,
        /// Number of groups of matches off the plane that move alike.
        groups: usize,
        /// Number of these groups that agree with the epipoles.
        agreeing: usize,
        /// Whether these matches are at the same place in both images, as if the camera stood still.
        is_still: bool,
    },
    /// The parallax beside one smooth warp, as of a camera that turns behind a lens, does not show
    /// the epipole. Counts matches that were found without the geometry.
    NoRelief {
        /// Number of matches beside the warp along their epipolar lines.
        along: usize,
        /// Number of matches beside the warp across their epipolar lines.
        across: usize,
        /// Number of matches on the warp.
        on_warp: usize,
    },
    /// One image is a mirror image of the other.
    Mirrored {
        /// Number of distinctive matches if image 2 is flipped.
        matches: usize,
    },
    /// The matches leave the epipolar lines uncertain.
    Loose {
        /// Standard deviation across the lines, px.
        deviation: f64,
    },
}

/// The part that is more likely wrong if a click and a geometry disagree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Suspect {
    /// The click: all other tests support the geometry.
    Click,
    /// The geometry: another test speaks against it, too.
    Geometry,
}

/// Verdict with its reasons.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trust {
    /// The verdict.
    pub verdict: Verdict,
    /// Failed tests. Empty for a reliable result.
    pub reasons: Vec<Reason>,
}

impl Trust {
    /// Returns whether the only doubts are about clicked pairs.
    pub fn doubts_clicks_alone(&self) -> bool {
        let of_a_click = |reason: &Reason| matches!(reason, Reason::ClickOff { .. });
        !self.reasons.is_empty() && self.reasons.iter().all(of_a_click)
    }

    /// Returns whether only one plane or a rotation of the camera is certain.
    pub fn says_one_plane(&self) -> bool {
        self.reasons.iter().any(|reason| matches!(reason, Reason::OnePlane { .. } | Reason::NoRelief { .. }))
    }
}
