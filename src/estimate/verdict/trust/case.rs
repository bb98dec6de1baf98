//! Figures of a case, and the tests of each by itself.

use std::borrow::Cow;
use std::iter::repeat_n;

use serde::Serialize;

use super::chance::is_more_than;
use super::lines::LineEvidence;
use super::parallax::{Baseline, PlaneEvidence, Relief};
use crate::estimate::evidence::patches::MirrorMatches;
use crate::estimate::fit::ResidualPattern;
use crate::estimate::fit::false_alarms::{Agreement, OF_A_PLANE};
use crate::estimate::verdict::constants::{EVEN, MIRRORED, OFF_RIGHT_LINES};

/// Figures of a geometry from the barcodes of corresponding lines.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
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
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
#[serde(rename_all = "kebab-case")]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct GivenPoints {
    pub agreeing: usize,
    pub matches: usize,
    /// Whether chance explains the agreement.
    pub is_chance: bool,
}

/// Figures that a verdict rests on.
#[derive(Debug, Clone, Default, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize), serde(default))]
pub struct Case {
    /// Whether patches were compared.
    pub(in crate::estimate) patches: bool,
    /// Figures of motion barcodes, for sequences.
    pub(in crate::estimate) barcodes: Option<BarcodeFigures>,
    /// Data that the result was refined on.
    pub(in crate::estimate) refined_on: RefinedOn,
    /// Sampson distances of the clicks, px.
    pub(in crate::estimate) clicks: Cow<'static, [f64]>,
    /// Standard deviation of a click, px.
    pub(in crate::estimate) click_sigma: f64,
    /// Relative advantage over the best clearly different geometry.
    pub(in crate::estimate) margin: Option<f64>,
    /// Evidence of the images for the lines. `None` if the geometry does not rest on the images, or without refinement.
    pub(in crate::estimate) lines: Option<LineEvidence>,
    /// Median standard deviation of the epipolar lines at the matches, px.
    pub(in crate::estimate) deviation: Option<f64>,
    /// Evidence of the largest plane. `None` without matches.
    pub(in crate::estimate) plane: Option<PlaneEvidence>,
    /// Distinctive matches, found without the geometry. `None` without refinement.
    pub(in crate::estimate) distinctive: Option<Distinctive>,
    /// Whether a lens as strong as a fisheye explains the matches clearly better. `None` without refinement.
    pub(in crate::estimate) strong_lens: Option<bool>,
    /// Agreement of the matches found without the geometry. `None` if no patches were compared.
    pub(in crate::estimate) unguided: Option<Agreement>,
    /// Number of these matches on their epipolar lines.
    pub(in crate::estimate) unguided_on_lines: usize,
    /// Largest number of these matches on lines that chance explains.
    pub(in crate::estimate) unguided_by_chance: usize,
    /// Agreement of the matches of another program. `None` without any.
    pub(in crate::estimate) given: Option<GivenFigures>,
    /// Matches beside the smooth warp. `None` without matches.
    pub(in crate::estimate) relief: Option<Relief>,
    /// Evidence for the baseline of known cameras, in place of `plane` and `relief`. `None` if the cameras are not
    /// known, or their essential matrix is not the result.
    pub(in crate::estimate) baseline: Option<Baseline>,
    /// Matches with the mirror image. `None` without refinement.
    pub(in crate::estimate) mirror: Option<Mirror>,
    /// Pattern of the residuals. `None` without neighbouring matches.
    pub(in crate::estimate) pattern: Option<ResidualPattern>,
    /// Longer side of image 1, px.
    pub(in crate::estimate) side: f64,
}

/// Matches with image 2 and with its mirror image.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct Distinctive {
    pub all: usize,
    /// Number of those that contradict `F`.
    pub off: usize,
}

impl Distinctive {
    /// Returns whether more of them contradict `F` than a right geometry leaves.
    pub(super) fn contradict(self) -> bool {
        is_more_than(OFF_RIGHT_LINES, self.off, self.all)
    }
}

/// Agreement of given matches with a geometry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
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
        is_more_than(EVEN, self.off, self.matches)
    }
}
