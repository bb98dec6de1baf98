//! What an estimate holds: a geometry, what was found out about it, and the search that found it.
//!
//! One type serves hypotheses, preliminary, followed, final and imported results: the parts that a result does not have
//! are absent, never made up.

use std::sync::Arc;

use nalgebra::Matrix3;
use serde::Serialize;

use crate::estimate::evidence::patches::{Hypothesis, PatchLevels};
use crate::estimate::{
    Clicks, ComparedPencils, LineFigures, Method, PatchSupport, PreparedPair, Preset, RefinedMatch,
    Refinement, Stage, Trust, Uncertainty, Warning,
};
use crate::features::FeatureViews;
use crate::geometry::{EpipolarGeometry, FundamentalMatrix};
use crate::image::RelativeView;

/// Hypotheses reported with all their figures. Rivals are among them. It bounds the time and the
/// size of a result.
pub(in crate::estimate) const REPORTED: usize = 60;

/// A geometry and what is known about it. All coordinates are full-size pixels.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// F and the epipoles.
    pub geometry: EpipolarGeometry,
    /// What was found out about it.
    pub assessment: Assessment,
    /// The search that found it; `None` for a hypothesis, which is part of one, for a geometry that follows moved
    /// clicks, and for one from elsewhere.
    pub trace: Option<Arc<SearchTrace>>,
}

/// What was found out about a geometry. What nobody looked at is absent.
#[derive(Debug, Clone, Default)]
pub struct Assessment {
    /// What the lines through two clicks say of it.
    pub lines: Option<LineFigures>,
    /// Patches that agree with it.
    pub support: Option<PatchSupport>,
    /// Advantage over the best clearly different hypothesis, relative to the better of the two: of patch support when
    /// the search looks at patches, else of the line score. `None` when there is no other hypothesis.
    pub margin: Option<f64>,
    /// The same after refinement, by what the matches weigh: measured where the margin before leaves open which geometry
    /// is better, and then what decides.
    pub refined_margin: Option<f64>,
    /// How far the hypotheses of the search are from it, which says which of them the margin is measured to.
    pub apart: Option<Apart>,
    /// What the motion barcodes of lines say of it, where sequences were compared.
    pub barcodes: Option<BarcodeFigures>,
    /// The fit of all seven degrees of freedom at full resolution, if there was one.
    pub refinement: Option<Refinement>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// How far to trust it; `None` before everything was looked at.
    pub trust: Option<Trust>,
    /// What is determined where the verdict says that the epipoles are not: one plane, or a turn of the camera.
    pub plane: Option<PlaneHomography>,
}

/// How far the hypotheses of a search are from its result: what the margin is measured between.
#[derive(Debug, Clone, PartialEq)]
pub struct Apart {
    /// Distance of each hypothesis from the result, in their order, px: the median of the symmetric distances of the matches
    /// from its epipolar lines (of two in the middle the smaller one); without matches, the mean distance of its epipolar
    /// lines from those of the result, all over the images.
    pub distances: Vec<f64>,
    /// A hypothesis that is farther than this is clearly different, px.
    pub limit: f64,
    /// How many matches the distances are measured on: those of the leading hypothesis before refinement, those that lines
    /// were refined on, or the clicks where these determine the geometry.
    pub matches: usize,
}

impl Apart {
    /// The first hypothesis that is clearly different, by its place in the list: the margin is how far the first one is
    /// ahead of it.
    pub fn rival(&self) -> Option<usize> {
        self.distances.iter().position(|distance| *distance > self.limit)
    }
}

/// What takes one image to the other where all that is seen lies on one plane, or the camera only turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneHomography {
    /// `x2 ∝ H x1`, in full-size pixels; its last entry is 1, where that does not make the others endless.
    pub homography21: Matrix3<f64>,
    /// Matches that follow it.
    pub matches: usize,
    /// Their share of all matches, 0 to 1.
    pub share: f64,
    /// Median distance in image 2 between these matches and where it puts them, px.
    pub residual: f64,
}

/// What the barcodes of corresponding lines say of a geometry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BarcodeFigures {
    /// How well the barcodes of corresponding epipolar lines agree over both images, 1 for equal ones, 0 for unrelated.
    pub correlation: f64,
    /// The best agreement when the second sequence is shifted in time, so that it cannot agree but by chance.
    pub by_chance: f64,
    /// Epipolar lines that tell something of their own: neighbours are crossed by the same things.
    pub lines: f64,
    /// Standard deviation of the epipolar lines where things move, px, from leaving out a part of the frames at a time;
    /// `None` where too few frames are left.
    pub deviation: Option<f64>,
    /// Frames that were compared.
    pub frames: usize,
}

/// How a geometry was found.
#[derive(Debug, Clone, Default)]
pub struct SearchTrace {
    /// The clicks it was searched from.
    pub clicks: Clicks,
    /// How the images were taken to be turned and scaled against each other.
    pub view: RelativeView,
    /// Which covariant features were looked at beside patches, if any.
    pub features: Option<FeatureViews>,
    /// How it was computed.
    pub method: Method,
    /// The choices it was computed with.
    pub preset: Preset,
    /// The seed of every random choice.
    pub seed: u64,
    /// The pencils through each anchor, as they were compared.
    pub pencils: Vec<Arc<ComparedPencils>>,
    /// The best hypotheses that differ from each other, best first, as they were before refinement.
    pub hypotheses: Vec<Estimate>,
    /// How much was examined.
    pub counts: SearchCounts,
    /// Time per stage, in their order.
    pub timings: Vec<StageTiming>,
    /// Seconds until the first fundamental matrix.
    pub first_seconds: f64,
    /// Seconds in all.
    pub seconds: f64,
}

/// How much was examined.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct SearchCounts {
    /// Textured lines in image 1 through each anchor; then, where lines were compared without any point, of all these.
    pub lines1: Vec<usize>,
    /// The same in image 2.
    pub lines2: Vec<usize>,
    /// Candidate line pairs in the same order.
    pub candidates: Vec<usize>,
    /// Hypotheses examined.
    pub hypotheses: usize,
    /// Hypotheses that went through full validation.
    pub validated: usize,
    /// Corners that stay at their place though the scene does not (captions, a logo, dirt on the sensor): they and what
    /// is around them are left out.
    pub left_out: usize,
}

/// Time spent in one stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageTiming {
    /// The stage.
    pub stage: Stage,
    /// Wall-clock seconds in all, however often the search came to it.
    pub seconds: f64,
}

impl Estimate {
    /// A geometry that a search proposed, with what lines and patches say of it.
    pub(in crate::estimate) fn proposed(
        f: FundamentalMatrix,
        lines: Option<LineFigures>,
        support: Option<PatchSupport>,
    ) -> Self {
        let assessment = Assessment { lines, support, ..Assessment::default() };
        Self { geometry: f.into(), assessment, trace: None }
    }

    /// The fundamental matrix, `x2ᵀ F x1 = 0`.
    pub fn fundamental(&self) -> &FundamentalMatrix {
        self.geometry.fundamental()
    }

    /// The hypotheses of the search, best first; none where there was no search.
    pub fn hypotheses(&self) -> &[Estimate] {
        self.trace.as_ref().map_or(&[], |trace| &trace.hypotheses)
    }

    /// The matches that the refinement rests on; none where there was no refinement.
    pub fn matches(&self) -> &[RefinedMatch] {
        self.assessment.refinement.as_ref().map_or(&[], |refinement| &refinement.matches)
    }

    /// Whether all seven degrees of freedom were refined at full resolution.
    pub fn is_refined(&self) -> bool {
        self.assessment.refinement.is_some()
    }

    /// How well it is determined, when it was refined.
    pub fn uncertainty(&self) -> Option<&Uncertainty> {
        self.assessment.refinement.as_ref()?.uncertainty.as_ref()
    }

    /// Line score ([`LineFigures::score`]), when lines were compared.
    pub fn line_score(&self) -> Option<f64> {
        self.assessment.lines.as_ref()?.score
    }

    /// Patch support, summed over matches; `None` when patches were not looked at.
    pub fn support_score(&self) -> Option<f64> {
        self.assessment.support.map(|support| support.score)
    }

    /// How the images were taken to be turned and scaled against each other by the search that found it; upright where
    /// there was none.
    pub fn view(&self) -> RelativeView {
        self.trace.as_ref().map_or(RelativeView::UPRIGHT, |trace| trace.view)
    }

    /// How far image 2 is rotated against image 1 at the first click, radians, as far as lines tell; else 0.
    pub fn turn(&self) -> f64 {
        self.assessment.lines.as_ref().map_or(0.0, |lines| lines.construction.turn())
    }
}

impl PreparedPair {
    /// The patches that the search which found an estimate looked at.
    pub(in crate::estimate) fn patches_of(&self, found: &Estimate) -> Arc<PatchLevels> {
        let looked_at = found.trace.as_ref().and_then(|trace| Some((trace.view, trace.features?)));
        looked_at.map_or_else(|| self.upright_patches(), |(view, of)| self.patches_with_features(view, of))
    }
}

impl From<Hypothesis> for Estimate {
    fn from(Hypothesis { fundamental, lines, support }: Hypothesis) -> Self {
        Self::proposed(fundamental, lines, Some(support))
    }
}

/// A geometry that nobody has looked at: from a file, say.
impl From<FundamentalMatrix> for Estimate {
    fn from(fundamental: FundamentalMatrix) -> Self {
        Self { geometry: fundamental.into(), assessment: Assessment::default(), trace: None }
    }
}
