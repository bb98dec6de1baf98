//! Figures that a verdict rests on, and the limits beyond which they speak against a geometry.
//!
//! Limits of chance are probabilities. The others are shares and sizes, with their reasons.

use crate::estimate::verdict::poisson::fewer_than;

/// Share of the matches on one plane beyond which only a handful of matches would determine the
/// epipoles.
pub(super) const ONE_PLANE: f64 = 0.95;
/// Share of the matches on one plane beyond which the matches off it must determine the epipoles by
/// themselves: the majority.
pub(super) const MOSTLY_PLANE: f64 = 0.5;
/// Share of the matches on one plane beyond which the agreeing matches must have more than
/// [`ANY_EPIPOLE`] motions: if two motions divide a picture, one has nearly half.
pub(super) const HALF_PLANE: f64 = 0.4;
/// Share of the matches off the plane explained by a lens, beyond which a lens is the likelier
/// cause: the majority. In a scene with depth, the one additional unknown explains few matches.
const BENT: f64 = 0.5;
/// Largest expected number of epipoles that do as well by chance: one in a thousand results without
/// parallax passes.
pub(super) const BY_CHANCE: f64 = 1e-3;
/// Largest expected number of epipoles that do as well by chance if each motion counts once. It is
/// looser, as static surfaces at different places can have equal parallax.
pub(super) const MOTIONS_BY_CHANCE: f64 = 1.0;
/// Number of motions off the plane that any epipole fits: two lines always meet.
pub(super) const ANY_EPIPOLE: usize = 2;
/// Largest probability that chance explains the contradicting matches: one in a thousand right
/// results fails.
const WRONG_BY_CHANCE: f64 = 1e-3;
/// Expected fraction of distinctive matches that agree on a wrong motion (repeated structure). Of
/// 200 matches five may contradict the geometry; with half and twice the fraction, four and eight.
/// Never varied.
pub(in crate::estimate) const WRONG_TOGETHER: f64 = 0.005;
/// Share of the variance of the residuals that neighbours have in common, beyond which the
/// residuals are more pattern than noise: one half.
pub(super) const PATTERN: f64 = 0.5;
/// Size of a pattern that the lens of a good camera leaves, px in images of up to [`USUAL_SIDE`]
/// px. It grows with larger images.
pub(super) const PATTERN_SIZE: f64 = 0.3;
/// Longer side of an image, px, up to which positions are found equally precisely. In larger images
/// errors grow in proportion.
pub(in crate::estimate) const USUAL_SIDE: f64 = 800.0;

/// Share of the matches that one homography explains, and the evidence of the other matches for the
/// epipoles.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct PlaneEvidence {
    /// Share of the matches explained by the homography, 0 to 1.
    pub share: f64,
    /// Share explained by a homography with radial distortion, 0 to 1.
    pub bent_share: f64,
    /// Share that is beside a smooth warp and moves like its neighbours, 0 to 1. `None` if unknown.
    pub relief: Option<f64>,
    /// Number of groups of matches off the plane that move alike.
    pub groups: usize,
    /// Number of groups that agree with `F`.
    pub agreeing: usize,
    /// Number of different motions among the agreeing groups.
    pub motions: usize,
    /// Expected number of epipoles that do as well by chance.
    pub by_chance: f64,
    /// The same number if all groups of one motion count once.
    pub motions_by_chance: f64,
}

impl PlaneEvidence {
    /// Returns whether the matches off the plane determine the epipoles by themselves.
    fn holds_the_epipoles(&self) -> bool {
        self.by_chance <= BY_CHANCE
            && self.motions_by_chance <= MOTIONS_BY_CHANCE
            && self.motions > ANY_EPIPOLE
    }

    /// Returns the evidence that determines the epipoles. If both kinds or neither do, returns the
    /// kind that is less likely by chance.
    pub fn or_stronger(self, other: Self) -> Self {
        let rank = |one: &Self| (!one.holds_the_epipoles(), one.by_chance);
        if rank(&other) < rank(&self) { other } else { self }
    }

    /// Returns whether the matches leave the epipoles undetermined.
    pub(super) fn leaves_the_epipoles_open(&self) -> bool {
        self.share > ONE_PLANE
            || self.share > MOSTLY_PLANE && !self.holds_the_epipoles()
            || self.share > HALF_PLANE && self.motions <= ANY_EPIPOLE
    }

    /// Returns whether a lens explains most of the matches off the plane.
    pub(super) fn is_bent(&self) -> bool {
        self.bent_share > MOSTLY_PLANE && self.bent_share - self.share > BENT * (1.0 - self.share)
    }
}

/// Counts of distinctive matches, found without `F`, that move like their neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::estimate) struct Together {
    /// Number of these matches.
    pub matches: usize,
    /// Number of these matches that contradict `F`.
    pub contradicting: usize,
}

impl Together {
    /// Returns whether more matches contradict `F` than are wrong by chance, by the Poisson
    /// distribution.
    pub(super) fn contradict(self) -> bool {
        let expected = WRONG_TOGETHER * self.matches as f64;
        1.0 - fewer_than(self.contradicting, expected) < WRONG_BY_CHANCE
    }
}

/// Part of the residuals that neighbouring matches have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct ResidualPattern {
    /// Share of the variance that is common to neighbours, 0 to 1.
    pub share: f64,
    /// Root mean square of the common part, px.
    pub size: f64,
}

impl ResidualPattern {
    /// Returns whether the common part is significant in images whose longer side is `side` px.
    pub(super) fn is_bent(self, side: f64) -> bool {
        self.share > PATTERN && self.size > PATTERN_SIZE * (side / USUAL_SIDE).max(1.0)
    }
}

/// Evidence of motion barcodes for a geometry.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct BarcodeEvidence {
    /// Agreement of the barcodes of corresponding lines.
    pub correlation: f64,
    /// Best agreement with one sequence shifted in time.
    pub by_chance: f64,
    /// Number of independent lines.
    pub lines: f64,
}

/// Data that a result was refined on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate) enum RefinedOn {
    /// None: refinement was off, or the search has no patches.
    Nothing,
    /// The clicks alone.
    Clicks,
    /// None: too few patches matched along the epipolar lines.
    TooFewMatches,
    /// This number of matches.
    Matches(usize),
}

/// Figures that a verdict rests on.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct Evidence<'a> {
    /// Whether patches were compared.
    pub patches: bool,
    /// Evidence of barcodes, for sequences.
    pub barcodes: Option<BarcodeEvidence>,
    /// Data that the result was refined on.
    pub refined_on: RefinedOn,
    /// Sampson distances of the clicks, px.
    pub clicks: &'a [f64],
    /// Standard deviation of a click, px.
    pub click_sigma: f64,
    /// Relative advantage over the best clearly different geometry.
    pub margin: Option<f64>,
    /// Median standard deviation of the epipolar lines at the matches, px.
    pub deviation: Option<f64>,
    /// Evidence of the largest plane. `None` without matches.
    pub plane: Option<PlaneEvidence>,
    /// Distinctive matches, found without the geometry.
    pub together: Together,
    /// Pattern of the residuals. `None` without neighbouring matches.
    pub pattern: Option<ResidualPattern>,
    /// Longer side of image 1, px.
    pub side: f64,
}
