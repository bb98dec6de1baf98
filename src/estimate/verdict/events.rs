//! Events of a search: what happened, in order, for a replay.
//!
//! A search writes them between its stages, never within a parallel loop. So they are the same on any number of
//! threads, except for their times, and writing them costs next to nothing.

use crate::estimate::{Origin, Proposed, RefinementStep, Stage, Verdict};
use crate::geometry::{AnchoredLine, FundamentalMatrix, PointPair};

/// Something that happened in a search. All coordinates are full-size pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Seconds since the search began.
    pub seconds: f64,
    /// Kind of the event, with its figures.
    pub kind: EventKind,
}

/// Kinds of events.
#[derive(Debug, Clone, PartialEq)]
pub enum EventKind {
    /// A stage began.
    Began(Stage),
    /// All lines through these pairs were compared. The trace has the pencils of the result.
    Pencils {
        /// Clicks, or matches in their place.
        anchors: Vec<PointPair>,
        /// Number of candidate line pairs through each.
        candidates: Vec<usize>,
    },
    /// All lines of both images were compared.
    Lines {
        /// Number of compared lines of each image.
        compared: [usize; 2],
        /// Some lines of image 1 near the middle, in the order of their directions, with their best partners.
        swept: Vec<LinePairNote>,
        /// The best candidates, as hypotheses are drawn from them, best first.
        candidates: Vec<LinePairNote>,
    },
    /// Features were matched, without a geometry.
    Matched {
        /// Number of all matches.
        all: usize,
        /// The most distinctive ones, best first.
        best: Vec<DistinctMatch>,
    },
    /// Geometries were proposed.
    Proposed {
        /// Number of combinations or samples that were examined.
        examined: usize,
        /// The best proposals, and some of the others, best first.
        hypotheses: Vec<HypothesisNote>,
    },
    /// The hypotheses were ranked by their support in both images, after local optimisation. The best different ones.
    Ranked(Vec<RankedHypothesis>),
    /// The leading hypotheses were fitted to matches at full size, and one was selected.
    Refined {
        /// The selected geometry, with the origin of its start.
        selected: HypothesisNote,
        /// Number of matches along its lines; 0 if it was fitted to motion barcodes.
        matches: usize,
        /// The fits from its start to the selected geometry, in order. Empty if it was not refined from a start.
        steps: Vec<RefinementStep>,
    },
    /// A geometry was judged.
    Judged {
        /// Word of the verdict.
        verdict: Option<Verdict>,
        /// Whether another search might change the result, so that the search went on if it could.
        is_open: bool,
    },
    /// The search ended with this geometry, one of the judged ones.
    Selected(HypothesisNote),
}

/// Two compared lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePairNote {
    /// The line of each image.
    pub lines: [AnchoredLine; 2],
    /// Cost of the pair; lower is more similar.
    pub cost: f64,
}

/// Match of two features, found by appearance alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistinctMatch {
    /// Positions of the two features.
    pub pair: PointPair,
    /// Descriptor distance over the distance to the next neighbour at another place, 0 to 1.
    pub ratio: f64,
}

/// Geometry in an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HypothesisNote {
    /// Fundamental matrix, `x2ᵀ F x1 = 0`.
    pub fundamental: FundamentalMatrix,
    /// Data from which it was proposed.
    pub origin: Origin,
    /// Support by patches, if it was measured.
    pub support: Option<f64>,
}

/// Hypothesis in a ranking.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedHypothesis {
    /// The hypothesis, after local optimisation.
    pub hypothesis: HypothesisNote,
    /// Support counted so far after each of [`CHECKPOINTS`](crate::estimate::CHECKPOINTS) equal parts of the
    /// evidence: the corners of image 1 and the matches of features. With motion barcodes, the logarithm of its
    /// likelihood before and after each round of its fit. Empty if its support was not measured.
    pub course: Vec<f64>,
}

impl From<Proposed> for HypothesisNote {
    fn from(Proposed { fundamental, origin }: Proposed) -> Self {
        Self { fundamental, origin, support: None }
    }
}
