//! Results: a geometry, its assessment, and the search that found it.
//!
//! One type serves hypotheses and preliminary, followed, final and imported results. Parts that a
//! result does not have are `None`.

use std::sync::Arc;

use nalgebra::Matrix3;
use serde::Serialize;

use crate::estimate::evidence::patches::{Hypothesis, PatchLevels};
use crate::estimate::verdict::constants::RIGHT;
use crate::estimate::{
    BarcodeFigures, Case, Clicks, ComparedPencils, ENOUGH_MATCHES, EpipoleBearing, EpipoleCertainty, Event,
    HypothesisNote, LineBands, LineEvidence, LineFigures, Origin, PatchSupport, PreparedPair, Preset,
    Proposed, RefinedMatch, Refinement, Stage, Trust, Uncertainty, Verdict, Warning,
};
use crate::features::FeatureViews;
use crate::geometry::{Frame, FundamentalMatrix, PointPair};
use crate::image::RelativeView;

/// Geometry with its assessment. All coordinates are full-size pixels.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Fundamental matrix, `x2ᵀ F x1 = 0`.
    pub fundamental: FundamentalMatrix,
    /// Data from which the geometry was proposed. `None` for geometries that follow moved clicks, for given points and
    /// for imported geometries.
    pub origin: Option<Origin>,
    /// Figures, warnings and verdict.
    pub assessment: Assessment,
    /// The search that found the geometry. `None` for hypotheses, for geometries that follow moved
    /// clicks, and for imported geometries.
    pub trace: Option<Arc<SearchTrace>>,
}

/// Part of a geometry that the matches determine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Determined {
    /// Lines and epipoles.
    Everything,
    /// Lines, and the directions of both epipoles. One of them may be at infinity.
    EpipoleDirections,
    /// Lines near the matches, and directions of the epipoles. Elsewhere, the lines are open: their expected error all over
    /// the pictures exceeds 1 % of the longer side.
    NearMatches,
    /// Lines near the matches. The epipoles are open.
    Lines,
}

/// Assessment of a geometry. Figures that were not computed are `None`.
#[derive(Debug, Clone, Default)]
pub struct Assessment {
    /// Figures of the lines through two clicks.
    pub lines: Option<LineFigures>,
    /// Support by patches.
    pub support: Option<PatchSupport>,
    /// Advantage over the best clearly different hypothesis, relative to the better of the two. It
    /// compares patch support if the search uses patches, and line scores otherwise. `None` without
    /// such a hypothesis.
    pub margin: Option<f64>,
    /// Advantage after refinement, by the weights of the matches. It is measured if `margin` is too
    /// small to decide, and decides instead.
    pub refined_margin: Option<f64>,
    /// Distances of the hypotheses of the search from the result. They select the rival of the
    /// margin.
    pub apart: Option<Apart>,
    /// Evidence for the lines by the matches that the images show without them. `None` for a geometry that does not
    /// rest on the images, and without patches or refinement.
    pub line_evidence: Option<LineEvidence>,
    /// Figures of motion barcodes, for sequences.
    pub barcodes: Option<BarcodeFigures>,
    /// Fit of all seven degrees of freedom at full resolution.
    pub refinement: Option<Refinement>,
    /// Matches found by appearance in the whole of both images, without the geometry, that no other place
    /// resembles. They are evidence about any geometry. Empty without refinement.
    pub distinctive: Arc<[PointPair]>,
    /// Warnings about the clicks.
    pub warnings: Vec<Warning>,
    /// Verdict. `None` for unfinished results.
    pub trust: Option<Trust>,
    /// Figures that the verdict rests on. `None` for unfinished results.
    pub case: Option<Arc<Case>>,
    /// Homography of the plane or the camera rotation, if the verdict says that nothing else is
    /// certain.
    pub plane: Option<PlaneHomography>,
    /// Whether the geometry was fitted to given matches alone. The matches of the refinement then
    /// only judge it.
    pub of_given: bool,
}

/// Distances of the hypotheses of a search from its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Apart {
    /// Distance of each hypothesis from the result, in the order of the hypotheses, px. It is the
    /// lower median of the symmetric distances of the matches from the lines of the hypothesis.
    /// Without matches, it is the mean distance between the lines of both geometries over the
    /// images.
    pub distances: Vec<f64>,
    /// Distance beyond which a hypothesis is clearly different, px.
    pub limit: f64,
    /// Number of matches on which the distances are measured. These are the matches of the leading
    /// hypothesis before refinement, the refined matches of a search with lines, or the clicks if
    /// they alone determine the geometry.
    pub matches: usize,
}

impl Apart {
    /// Returns the index of the first clearly different hypothesis. The margin is the advantage of
    /// the first hypothesis over this one.
    pub fn rival(&self) -> Option<usize> {
        self.distances.iter().position(|distance| *distance > self.limit)
    }
}

/// Homography between the images, of a planar scene or of a camera that only rotated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlaneHomography {
    /// `x2 ∝ H x1`, in full-size pixels. The last entry is 1, unless it is nearly 0; then the norm
    /// is 1.
    // Result files have it as nested rows, beside the figures.
    #[serde(skip)]
    pub homography21: Matrix3<f64>,
    /// Number of matches that fit it.
    pub matches: usize,
    /// Share of all matches that fit it, 0 to 1.
    pub share: f64,
    /// Median transfer error of these matches in image 2, px.
    pub residual: f64,
}

/// Record of the search that found a geometry.
#[derive(Debug, Clone, Default)]
pub struct SearchTrace {
    /// Clicks of the search, stand-ins included.
    pub clicks: Clicks,
    /// Relative rotation and scale of the images under which the geometry was found.
    pub view: RelativeView,
    /// Kind of covariant features used beside patches, if any.
    pub features: Option<FeatureViews>,
    /// Preset of the parameters.
    pub preset: Preset,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Compared pencils through each anchor.
    pub pencils: Vec<Arc<ComparedPencils>>,
    /// Best hypotheses that differ from each other, before refinement, best first.
    pub hypotheses: Vec<Estimate>,
    /// What happened, in order.
    pub events: Vec<Event>,
    /// Numbers of examined lines and hypotheses.
    pub counts: SearchCounts,
    /// Time per stage, in the order of the stages.
    pub timings: Vec<StageTiming>,
    /// Seconds until the first fundamental matrix.
    pub first_seconds: f64,
    /// Seconds of the whole search.
    pub seconds: f64,
}

/// Numbers of examined lines and hypotheses.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct SearchCounts {
    /// Number of textured lines in image 1 through each anchor. The search with all lines appends
    /// the number of its lines.
    pub lines1: Vec<usize>,
    /// Number of these lines in image 2.
    pub lines2: Vec<usize>,
    /// Number of candidate line pairs, in the same order.
    pub candidates: Vec<usize>,
    /// Number of hypotheses examined.
    pub hypotheses: usize,
    /// Number of hypotheses that went through full validation.
    pub validated: usize,
    /// Number of corners that keep their position while the scene moves (captions, logos, dirt on
    /// the sensor). They and their surroundings are left out.
    pub left_out: usize,
}

/// Time spent in one stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageTiming {
    /// The stage.
    pub stage: Stage,
    /// Wall-clock seconds, summed over all visits of the stage.
    pub seconds: f64,
}

impl Estimate {
    /// Returns a proposed geometry with its figures of lines and patches.
    pub(in crate::estimate) fn proposed(
        proposed: Proposed,
        lines: Option<LineFigures>,
        support: Option<PatchSupport>,
    ) -> Self {
        let assessment = Assessment { lines, support, ..Assessment::default() };
        let Proposed { fundamental, origin } = proposed;
        Self { fundamental, origin: Some(origin), assessment, trace: None }
    }

    /// Returns a geometry of a search with its origin.
    pub(in crate::estimate) fn as_proposed(&self) -> Option<Proposed> {
        Some(Proposed { fundamental: self.fundamental, origin: self.origin? })
    }

    /// Returns a geometry of a search for its record.
    pub(in crate::estimate) fn noted(&self) -> Option<HypothesisNote> {
        Some(HypothesisNote { support: self.support_score(), ..self.as_proposed()?.into() })
    }

    /// Returns the fundamental matrix, `x2ᵀ F x1 = 0`.
    pub fn fundamental(&self) -> &FundamentalMatrix {
        &self.fundamental
    }

    /// Returns the hypotheses of the search, best first. Empty without a search.
    pub fn hypotheses(&self) -> &[Estimate] {
        self.trace.as_ref().map_or(&[], |trace| &trace.hypotheses)
    }

    /// Returns whether the matches are evidence against another geometry. True for a reliable
    /// result, and for a doubtful result with [`ENOUGH_MATCHES`].
    pub fn may_contradict(&self) -> bool {
        match self.assessment.trust.as_ref().map(|trust| trust.verdict) {
            Some(Verdict::Reliable) => true,
            Some(Verdict::Doubtful) => self.matches().len() >= ENOUGH_MATCHES,
            Some(Verdict::Unreliable | Verdict::DifferentScenes) | None => false,
        }
    }

    /// Returns the refined matches. Empty without refinement.
    pub fn matches(&self) -> &[RefinedMatch] {
        self.assessment.refinement.as_ref().map_or(&[], |refinement| &refinement.matches)
    }

    /// Returns the points of the refined matches.
    pub fn matched_pairs(&self) -> Vec<PointPair> {
        self.matches().iter().map(|found| found.pair).collect()
    }

    /// Returns whether all seven degrees of freedom were refined at full resolution.
    pub fn is_refined(&self) -> bool {
        self.assessment.refinement.is_some()
    }

    /// Returns the uncertainty of a refined geometry.
    pub fn uncertainty(&self) -> Option<&Uncertainty> {
        self.assessment.refinement.as_ref()?.uncertainty.as_ref()
    }

    /// Returns where the epipoles are in images of these sizes. `None` without a covariance, and if
    /// the verdict says that a plane or a turn of the camera explains the matches. The covariance
    /// would describe one epipole, and other epipoles fit as well.
    pub fn epipole_bearings(&self, frames: [Frame; 2]) -> Option<[EpipoleBearing; 2]> {
        let uncertainty = self.uncertainty().filter(|_| !self.says_one_plane())?;
        Some([uncertainty.bearing(false, frames[0])?, uncertainty.bearing(true, frames[1])?])
    }

    /// Returns whether the evidence of the images for the lines decides about them, and not their matches or the lead
    /// over the rival.
    pub fn is_judged_by_lines(&self) -> bool {
        self.assessment.line_evidence.is_some()
    }

    /// Returns how precise the lines are all over images of these sizes, as far as the matches tell. `None` without a
    /// covariance, and if the epipoles are open: the lines are then right near the matches, and uncertain elsewhere.
    pub fn line_bands(&self, frames: [Frame; 2]) -> Option<LineBands> {
        self.uncertainty().filter(|_| !self.says_one_plane())?.line_bands(frames)
    }

    /// Returns what the matches determine, in images of these sizes. `None` without a covariance. Epipoles are
    /// determined only if each of their tests was passed.
    pub fn determined(&self, frames: [Frame; 2]) -> Option<Determined> {
        if self.says_one_plane() {
            return Some(Determined::Lines);
        }
        let certainty = self.epipole_bearings(frames)?.map(|bearing| bearing.certainty());
        if !self.assessment.trust.as_ref().is_some_and(Trust::determines_the_epipole) {
            return Some(Determined::Lines);
        }
        let side = frames[0].longer_side().max(frames[1].longer_side());
        let are_open_elsewhere =
            self.line_bands(frames).is_none_or(|bands| bands.expected_error() > RIGHT * side);
        Some(match certainty[0].max(certainty[1]) {
            EpipoleCertainty::Position | EpipoleCertainty::Direction if are_open_elsewhere => {
                Determined::NearMatches
            }
            EpipoleCertainty::Position => Determined::Everything,
            EpipoleCertainty::Direction => Determined::EpipoleDirections,
            EpipoleCertainty::Open => Determined::Lines,
        })
    }

    /// Returns whether the verdict says that only one plane or a rotation of the camera is certain. The
    /// epipoles are then not determined, and neither are the baseline and any depth.
    pub fn says_one_plane(&self) -> bool {
        self.assessment.trust.as_ref().is_some_and(Trust::says_one_plane)
    }

    /// Returns the line score ([`LineFigures::score`]), if lines were compared.
    pub fn line_score(&self) -> Option<f64> {
        self.assessment.lines.as_ref()?.score
    }

    /// Returns the patch support, summed over matches. `None` if no patches were compared.
    pub fn support_score(&self) -> Option<f64> {
        self.assessment.support.map(|support| support.score)
    }

    /// Returns the relative rotation and scale of the images in the search. Upright without a
    /// search.
    pub fn view(&self) -> RelativeView {
        self.trace.as_ref().map_or(RelativeView::UPRIGHT, |trace| trace.view)
    }

    /// Returns the rotation of image 2 against image 1 at the first click, by lines, radians. 0
    /// without line figures.
    pub fn turn(&self) -> f64 {
        self.assessment.lines.as_ref().map_or(0.0, |lines| lines.construction.turn())
    }
}

impl PreparedPair {
    /// Returns the patches used by the search of an estimate.
    pub(in crate::estimate) fn patches_of(&self, found: &Estimate) -> Arc<PatchLevels> {
        let looked_at = found.trace.as_ref().and_then(|trace| Some((trace.view, trace.features?)));
        looked_at.map_or_else(|| self.upright_patches(), |(view, of)| self.patches_with_features(view, of))
    }
}

impl From<Hypothesis> for Estimate {
    fn from(Hypothesis { origin, fundamental, lines, support }: Hypothesis) -> Self {
        Self::proposed(Proposed { fundamental, origin }, lines, Some(support))
    }
}

/// Returns the geometry without an assessment, such as one from a file.
impl From<FundamentalMatrix> for Estimate {
    fn from(fundamental: FundamentalMatrix) -> Self {
        Self { fundamental, origin: None, assessment: Assessment::default(), trace: None }
    }
}
