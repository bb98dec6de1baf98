//! Figures that a verdict rests on, and the limits beyond which they speak against a geometry.
//!
//! Limits of chance are probabilities. The others are shares and sizes, with their reasons.

use std::iter::repeat_n;

use serde::Serialize;

use super::lines::LineEvidence;
use crate::estimate::evidence::patches::MirrorMatches;
use crate::estimate::fit::false_alarms::{Agreement, BY_CHANCE, OF_A_PLANE};
use crate::estimate::verdict::poisson::fewer_than;

/// Share of the matches on one plane beyond which only a handful of matches would determine the
/// epipoles.
pub(super) const ONE_PLANE: f64 = 0.95;
/// Share of the matches on one plane beyond which the matches off it must determine the epipoles by
/// themselves: the majority.
pub(super) const MOSTLY_PLANE: f64 = 0.5;
/// Share of the matches on one plane beyond which the agreeing matches must have more than
/// [`ANY_EPIPOLE`] motions: if two motions divide a picture, one has nearly half. Corners are matched
/// near their place on such a plane.
pub(in crate::estimate) const HALF_PLANE: f64 = 0.4;
/// Share of the matches off the plane explained by a lens, beyond which a lens is the likelier
/// cause: the majority. In a scene with depth, the one additional unknown explains few matches.
const BENT: f64 = 0.5;
/// Largest expected number of epipoles that do as well by chance if each motion counts once. It is
/// looser, as static surfaces at different places can have equal parallax.
pub(super) const MOTIONS_BY_CHANCE: f64 = 1.0;
/// Number of motions off the plane that any epipole fits: two lines always meet.
pub(in crate::estimate) const ANY_EPIPOLE: usize = 2;
/// Least share of the matches that are beside the smooth warp along their lines. In flat scenes and
/// with turned cameras it is below. Chosen on pairs with and without parallax; not yet tested on
/// other pairs.
pub(super) const LEAST_ALONG: f64 = 0.05;
/// Least share along the lines among the matches along and across, at the lower end of its interval:
/// three quarters. By chance, half are along and half across. The same share of the scene points of known cameras has
/// to be in front of them; by chance, half are.
const MOSTLY_ALONG: f64 = 0.75;
/// Least share along the lines among the matches along and off, at the lower end of its interval: the majority.
/// By chance, [`ALONG_BY_CHANCE`] are along.
const MAJORITY_ALONG: f64 = 0.5;
/// Largest ratio of the parts across and along a line of a displacement along the line.
pub(in crate::estimate) const ALONG: f64 = 1.0 / 3.0;
/// Probability that a displacement in any direction is along a line: `2 / π · atan(1 / 3)`.
const ALONG_BY_CHANCE: f64 = 0.204_832_76;
/// Largest probability that chance explains the contradicting matches: one in a thousand right
/// results fails.
const WRONG_BY_CHANCE: f64 = 1e-3;
/// Least share of the corners that match if one image is flipped. Mirror images have 20 to 43 %, a
/// facade seen from its left and from its right 3 %.
const MIRRORED: f64 = 0.1;
/// Largest probability that half of all distinctive matches are wrong and chance does the rest. It
/// is looser than [`WRONG_BY_CHANCE`], since on any right result far fewer than half are wrong.
const HALF_WRONG_BY_CHANCE: f64 = 1e-2;
/// Expected fraction of distinctive matches that agree on a wrong motion (repeated structure). Of
/// 200 matches five may contradict the geometry; with half and twice the fraction, four and eight.
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

/// Matches off the largest plane, as evidence for the epipoles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct OffPlane {
    /// Number of groups of matches that move alike.
    pub groups: usize,
    /// Number of groups that agree with `F`.
    pub agreeing: usize,
    /// Number of motions among the agreeing groups. Each has more matches than are expected to be
    /// wrong.
    pub motions: usize,
    /// Expected number of epipoles that do as well by chance.
    pub by_chance: f64,
    /// The same number if all groups of one motion count once.
    pub motions_by_chance: f64,
}

impl OffPlane {
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
}

/// Share of the matches that one homography explains, and the evidence of the other matches for the
/// epipoles.
#[derive(Debug, Clone, Copy)]
pub(in crate::estimate) struct PlaneEvidence {
    /// Share of the matches explained by the homography, 0 to 1.
    pub share: f64,
    /// Share explained by a homography with radial distortion, 0 to 1.
    pub bent_share: f64,
    pub off: OffPlane,
    /// Whether the homography leaves the matches in their places, as if the camera stood still.
    pub is_still: bool,
}

impl PlaneEvidence {
    /// Returns whether the matches leave the epipoles undetermined. Relief beside
    /// [`ANY_EPIPOLE`] further planes shows the epipoles whatever the number of motions, since some
    /// epipole fits the planes but not the rest. If the camera stood still, everything that moved did
    /// so by itself.
    pub(super) fn leaves_the_epipoles_open(&self, relief: Option<Relief>) -> bool {
        let is_undecided = || !relief.is_some_and(|relief| relief.further.show_the_epipole());
        self.share > ONE_PLANE
            || self.share > HALF_PLANE && self.is_still
            || self.share > MOSTLY_PLANE && !self.off.holds_the_epipoles() && is_undecided()
            || self.share > HALF_PLANE && self.off.motions <= ANY_EPIPOLE && is_undecided()
    }

    /// Returns whether a lens explains most of the matches off the plane.
    pub(super) fn is_bent(&self) -> bool {
        self.bent_share > MOSTLY_PLANE && self.bent_share - self.share > BENT * (1.0 - self.share)
    }
}

/// Matches found without `F`, beside the smooth warp that most matches follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::estimate) struct Witnesses {
    pub on_warp: usize,
    /// Number of matches beside the warp, along their epipolar lines.
    pub along: usize,
    /// Number of matches beside the warp, across their epipolar lines. `off` counts them too.
    pub across: usize,
    /// Number of matches beside the warp that are clearly off their epipolar lines and not along
    /// them.
    pub off: usize,
}

impl Witnesses {
    /// Returns whether parallax that no smooth warp, or no turn of known cameras, explains shows the epipole.
    pub fn show_the_epipole(self) -> bool {
        self.is_no_chance()
            && self.share_along() >= LEAST_ALONG
            && at_least(self.along, self.along + self.across) >= MOSTLY_ALONG
            && self.are_mostly_along()
    }

    /// Returns whether more matches lie along their lines than clearly off them.
    pub fn are_mostly_along(self) -> bool {
        at_least(self.along, self.along + self.off) >= MAJORITY_ALONG
    }

    /// Returns whether chance seldom does as well. A wrong match lies in any direction from the warp.
    /// Some epipole fits any two matches, so there are as many epipoles as pairs of matches. The
    /// binomial tail says how likely each explains as many by chance.
    fn is_no_chance(self) -> bool {
        let n = self.along + self.off;
        let pairs = (n * n.saturating_sub(1) / 2) as f64;
        pairs * tail(self.off, n, ALONG_BY_CHANCE) <= BY_CHANCE
    }

    /// Returns the share of the matches that are beside the warp along their lines, 0 to 1.
    pub fn share_along(self) -> f64 {
        self.along as f64 / (self.on_warp + self.along + self.off).max(1) as f64
    }
}

/// Matches found without `F` beside a smooth warp, counted in three ways.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::estimate) struct Relief {
    /// Beside the warp.
    pub beside: Witnesses,
    /// The same, with [`ANY_EPIPOLE`] more planes counted as the warp.
    pub further: Witnesses,
    /// Beside a warp that follows the rows more closely.
    pub finer: Witnesses,
    /// Beside the warp, matches alone that are clearly likelier than all similar places together.
    pub clear: Witnesses,
}

impl Relief {
    /// Returns the matches that leave the epipoles undetermined. `None` if parallax shows them. Beside the
    /// finer warp it must not vanish among wrong matches: a rolling shutter may swing faster than the coarser
    /// warp follows. Nor may it rest on matches that are equalled elsewhere, as on wallpaper.
    pub(super) fn doubt(self) -> Option<Witnesses> {
        let Self { beside, finer, clear, .. } = self;
        let doubted = [beside, clear].into_iter().find(|found| !found.show_the_epipole());
        doubted.or((!finer.is_no_chance()).then_some(finer))
    }
}

/// Evidence for the direction of the baseline of two known cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate) struct Baseline {
    /// Matches found without the geometry, beside a camera that only turned.
    pub beside: Witnesses,
    /// The other solution of the largest plane, if there is one.
    pub other: Option<OtherPose>,
    /// Number of matches along the lines whose scene point is in front of both cameras.
    pub in_front: usize,
    /// Number of matches along the lines.
    pub matches: usize,
}

impl Baseline {
    /// Returns whether too many scene points are behind a camera. By chance, half of them are.
    pub fn is_behind(self) -> bool {
        at_least(self.in_front, self.matches) < MOSTLY_ALONG
    }
}

/// Matches found without the geometry that a pose explains and the other solution of a plane does not, and the
/// reverse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate) struct OtherPose {
    pub this_only: usize,
    pub other_only: usize,
}

impl OtherPose {
    /// Returns whether chance seldom favours a pose as much (sign test).
    pub fn is_decided(self) -> bool {
        self.this_only > self.other_only
            && tail(self.other_only, self.this_only + self.other_only, 0.5) <= BY_CHANCE
    }

    /// Returns the relative advantage of the pose.
    pub(super) fn margin(self) -> f64 {
        let (this, other) = (self.this_only as f64, self.other_only as f64);
        (this - other) / (this + other).max(1.0)
    }
}

/// Returns whether most displacements are along their lines, whatever their number.
pub(super) fn are_mostly(along: usize, of: usize) -> bool {
    along as f64 >= MOSTLY_ALONG * of as f64 && along > 0
}

/// Returns the lower bound of a share of which `some` of `all` were seen (Wilson's interval,
/// one-sided, 95 %).
fn at_least(some: usize, all: usize) -> f64 {
    const Z: f64 = 1.645;
    let n = all.max(1) as f64;
    let share = some as f64 / n;
    let spread = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    (share + Z * Z / (2.0 * n) - spread) / (1.0 + Z * Z / n)
}

/// Returns the probability that at most `few` of `n` trials fail if each succeeds with probability `p`.
fn tail(few: usize, n: usize, p: f64) -> f64 {
    let odds = ((1.0 - p) / p).ln();
    let mut log_term = n as f64 * p.ln();
    let mut sum = log_term.exp();
    for k in 1..=few {
        log_term += ((n - k + 1) as f64 / k as f64).ln() + odds;
        sum += log_term.exp();
    }
    sum.min(1.0)
}

/// Matches with image 2 and with its mirror image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::estimate) struct Mirror {
    pub matches: MirrorMatches,
    /// Whether most of the likely matches found without the geometry are off their lines.
    pub is_suspect: bool,
}

impl Mirror {
    /// Returns whether one image is a mirror image of the other. Symmetric things match either way, but as it
    /// is, an image matches better than its mirror image.
    pub(super) fn is_likely(self) -> bool {
        let MirrorMatches { flipped, all_flipped, upright, corners, by_chance } = self.matches;
        let are_many = flipped as f64 >= MIRRORED * corners as f64 && flipped > 0;
        let others = all_flipped.saturating_sub(flipped);
        let each = repeat_n(by_chance, flipped).chain(repeat_n(1.0, others));
        are_many && self.is_suspect || flipped > upright && Agreement::of(each, OF_A_PLANE).is_no_chance()
    }
}

/// Counts of distinctive matches, found without `F`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::estimate) struct Together {
    /// Number of all distinctive matches.
    pub all: usize,
    /// Number of all distinctive matches that contradict `F`.
    pub off: usize,
    /// Number of distinctive matches that move like their neighbours.
    pub matches: usize,
    /// Number of matches that move like their neighbours and contradict `F`.
    pub contradicting: usize,
}

impl Together {
    /// Returns the number of matches that contradict `F` and the number of matches tested, if more
    /// contradict `F` than are wrong by chance. Few of the matches that move like their neighbours
    /// are wrong (Poisson distribution), and fewer than half of all distinctive matches.
    pub(super) fn contradict(self) -> Option<(usize, usize)> {
        let expected = WRONG_TOGETHER * self.matches as f64;
        if 1.0 - fewer_than(self.contradicting, expected) < WRONG_BY_CHANCE {
            return Some((self.contradicting, self.matches));
        }
        is_majority(self.off, self.all).then_some((self.off, self.all))
    }
}

/// Agreement of given matches with a geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct GivenFigures {
    /// Number of given matches that agree with each other, or of all if no geometry agrees with enough of them.
    pub matches: usize,
    /// Number of these matches that are off their epipolar lines by more than their noise.
    pub off: usize,
    /// Median distance of these matches from their epipolar lines, px.
    pub distance: f64,
}

impl GivenFigures {
    /// Returns whether most of the matches contradict the geometry, and not by chance.
    pub fn contradict(&self) -> bool {
        is_majority(self.off, self.matches)
    }
}

/// Returns whether more than half are unlikely to be so many by chance.
fn is_majority(some: usize, all: usize) -> bool {
    tail(all - some, all, 0.5) < HALF_WRONG_BY_CHANCE
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

/// Figures of a geometry from the barcodes of corresponding lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BarcodeFigures {
    /// Agreement of the barcodes of corresponding epipolar lines over both images: 1 for equal
    /// barcodes, 0 for unrelated ones.
    pub correlation: f64,
    /// Best agreement with the second sequence shifted in time, which only chance explains.
    pub by_chance: f64,
    /// Number of independent epipolar lines. The same objects cross neighbouring lines.
    pub lines: f64,
    /// Standard deviation of the epipolar lines at moving objects, px, from a jackknife over the
    /// frames. `None` with too few frames.
    pub deviation: Option<f64>,
    /// Number of frames compared.
    pub frames: usize,
}

impl BarcodeFigures {
    /// Returns the number of whole independent lines, the number told to people.
    pub fn whole_lines(&self) -> usize {
        self.lines as usize
    }
}

/// Data that a result was refined on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(in crate::estimate) enum RefinedOn {
    /// None: refinement was off, or the search has no patches.
    #[default]
    Nothing,
    /// The clicks alone.
    Clicks,
    /// None: too few patches matched along the epipolar lines.
    TooFewMatches,
    /// This number of matches.
    Matches(usize),
    /// Matches of another program alone. This number of matches of the images lies along the lines
    /// of the result.
    Given(usize),
    /// Given matches without pictures.
    Points(GivenPoints),
}

/// Given matches without pictures that agree with a geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate) struct GivenPoints {
    pub agreeing: usize,
    pub matches: usize,
    /// Whether chance explains the agreement.
    pub is_chance: bool,
}

/// Figures that a verdict rests on.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::estimate) struct Evidence<'a> {
    /// Whether patches were compared.
    pub patches: bool,
    /// Figures of motion barcodes, for sequences.
    pub barcodes: Option<BarcodeFigures>,
    /// Data that the result was refined on.
    pub refined_on: RefinedOn,
    /// Sampson distances of the clicks, px.
    pub clicks: &'a [f64],
    /// Standard deviation of a click, px.
    pub click_sigma: f64,
    /// Relative advantage over the best clearly different geometry.
    pub margin: Option<f64>,
    /// Evidence of the images for the lines. `None` if the geometry does not rest on the images, or without refinement.
    pub lines: Option<LineEvidence>,
    /// Median standard deviation of the epipolar lines at the matches, px.
    pub deviation: Option<f64>,
    /// Evidence of the largest plane. `None` without matches.
    pub plane: Option<PlaneEvidence>,
    /// Distinctive matches, found without the geometry.
    pub together: Together,
    /// Whether a lens as strong as a fisheye explains the matches clearly better.
    pub strong_lens: bool,
    /// Agreement of the matches found without the geometry. `None` if no patches were compared.
    pub unguided: Option<Agreement>,
    /// Number of these matches on their epipolar lines.
    pub unguided_on_lines: usize,
    /// Agreement of the matches of another program. `None` without any.
    pub given: Option<GivenFigures>,
    /// Matches beside the smooth warp. `None` without matches.
    pub relief: Option<Relief>,
    /// Evidence for the baseline of known cameras, in place of `plane` and `relief`. `None` if the cameras are not
    /// known, or their essential matrix is not the result.
    pub baseline: Option<Baseline>,
    /// Matches with the mirror image. `None` without matches.
    pub mirror: Option<Mirror>,
    /// Pattern of the residuals. `None` without neighbouring matches.
    pub pattern: Option<ResidualPattern>,
    /// Longer side of image 1, px.
    pub side: f64,
}
