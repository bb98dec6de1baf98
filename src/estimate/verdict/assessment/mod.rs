//! Assessment of a geometry: figures of its lines, patches, matches and rivals, and the verdict.

mod agreement;
mod baseline;
mod examination;
mod gathering;
mod line_evidence;
mod margin;
mod parallax;
mod points;
mod relief;

pub(in crate::estimate) use agreement::{given_figures, unguided_agreement};
pub use examination::examine;

pub(in crate::estimate) use points::PointEvidence;

use std::sync::Arc;

use crate::cancel::CancelFlag;
use crate::estimate::checks::{click_warnings, little_texture};
use crate::estimate::evidence::lines::ComparedPencils;
use crate::estimate::evidence::patches::Refined;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::verdict::selection::ClickedPairs;
use crate::estimate::verdict::trust::LineEvidence;
use crate::estimate::{Assessment, Estimate, PatchSupport, Refinement, Search, Trust, Warning};
use crate::geometry::{FundamentalMatrix, PointPair};
use examination::{line_figures, patch_support};
use line_evidence::line_evidence;
use margin::{all_apart, differs, least_clear, margin};

/// Data from which a geometry follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate) enum RestsOn {
    /// The images, with the clicks and the matches from elsewhere.
    Images,
    /// The clicks alone.
    ClicksAlone,
    /// Matches from elsewhere alone.
    GivenAlone,
}

/// Evidence by which a geometry is judged.
pub(in crate::estimate) struct Judge<'a> {
    pub viewed: &'a ViewedPair<'a>,
    /// Geometries found by the search, best first.
    pub hypotheses: &'a [Estimate],
    /// Pencils through the anchors.
    pub pencils: &'a [Arc<ComparedPencils>],
    pub rests_on: RestsOn,
    pub cancel: &'a CancelFlag,
}

impl Judge<'_> {
    /// Returns the assessment of a preliminary geometry, without a verdict.
    pub fn preliminary(&self, f: &FundamentalMatrix, support: Option<PatchSupport>) -> Assessment {
        let SearchInput { prepared, parameters, .. } = self.viewed.input;
        let frames = prepared.frames();
        let rival = self.hypotheses.iter().position(|other| differs(f, other.fundamental(), &[], frames));
        Assessment {
            lines: self.hypotheses.first().and_then(|best| best.assessment.lines.clone()),
            support,
            margin: margin(self.hypotheses, rival, parameters.search),
            warnings: self.warnings(f),
            ..Assessment::default()
        }
    }

    /// Returns the full assessment of a final geometry, with the verdict. Rivals are compared with
    /// it on the matches `supporting`.
    pub fn result(
        &self,
        f: &FundamentalMatrix,
        supporting: &[PointPair],
        refined: Option<Refined>,
    ) -> Assessment {
        let viewed = self.viewed;
        let SearchInput { prepared, clicks, parameters } = viewed.input;
        // These are figures of the result, not of the hypothesis from which it was refined.
        let turn = self.hypotheses.first().map_or(0.0, Estimate::turn);
        let anchors = clicks.anchors();
        let lines = anchors.first_chunk().and_then(|anchors| line_figures(viewed, *anchors, f, turn));
        let support = patch_support(viewed, f);
        let apart = all_apart(f, self.hypotheses, supporting, prepared.frames());
        let margin = margin(self.hypotheses, apart.rival(), parameters.search);
        let line_evidence = self.line_evidence(f, supporting, refined.as_ref().map(|one| &one.refinement));
        let least = |refined: &Refined| least_clear(refined.weight, refined.weight_deviation);
        // The margin decides where the images do not show the lines. Without figures before refinement, the figures
        // after it decide.
        let has_rival = line_evidence.is_none() && apart.rival().is_some();
        let is_open = |refined: &&Refined| has_rival && margin.is_none_or(|margin| margin < least(refined));
        let open = refined.as_ref().filter(is_open);
        let refined_margin = open.map(|refined| self.refined_margin(f, refined.weight, supporting));
        let refinement = refined.map(|refined| refined.refinement);
        let (case, plane) = self.case(f, refined_margin.or(margin), refinement.as_ref(), line_evidence);
        let trust = Trust::judge(&case);
        let says_one_plane = trust.says_one_plane();
        let mut warnings = self.warnings(f);
        let is_free = refinement.as_ref().is_some_and(|refinement| !refinement.is_posed);
        if is_free && prepared.calibrations().is_some() {
            warnings.push(Warning::CalibrationContradicted);
        }
        let distinctive =
            refinement.as_ref().map_or_else(Arc::default, |_| viewed.patches.distinctive().into());
        Assessment {
            lines,
            support,
            margin,
            refined_margin,
            apart: Some(apart),
            line_evidence,
            barcodes: None,
            refinement,
            distinctive,
            warnings,
            trust: Some(trust),
            plane: plane.filter(|_| says_one_plane),
            case: Some(Arc::new(case)),
            of_given: self.rests_on == RestsOn::GivenAlone,
        }
    }

    /// Returns the advantage of a refined geometry, whose matches weigh `weight`, over its refined
    /// rivals. A rival counts if refinement leaves it clearly different.
    fn refined_margin(&self, f: &FundamentalMatrix, weight: f64, supporting: &[PointPair]) -> f64 {
        let viewed = self.viewed;
        let SearchInput { prepared, parameters, .. } = viewed.input;
        let clicked = ClickedPairs::of(viewed.input);
        let is_rival = |other: &FundamentalMatrix| differs(f, other, supporting, prepared.frames());
        let heaviest = self
            .hypotheses
            .iter()
            .map(Estimate::fundamental)
            .filter(|other| is_rival(other))
            .take(parameters.refinement.rivals)
            .filter_map(|rival| viewed.patches.refine(rival, &clicked.0, self.cancel))
            .filter(|refined| is_rival(&refined.fundamental))
            .map(|refined| refined.weight)
            .fold(0.0, f64::max);
        margin::relative(weight, heaviest)
    }

    /// Returns the evidence of the images for the lines. `None` if a geometry does not rest on the images, or if
    /// refinement is off.
    fn line_evidence(
        &self,
        f: &FundamentalMatrix,
        supporting: &[PointPair],
        refinement: Option<&Refinement>,
    ) -> Option<LineEvidence> {
        let SearchInput { prepared, parameters, .. } = self.viewed.input;
        let is_refined = parameters.search == Search::Patches && parameters.refinement.refine;
        if self.rests_on != RestsOn::Images || !is_refined {
            return None;
        }
        let (patches, frames) = (&self.viewed.patches, prepared.frames());
        let found = refinement.map(|refinement| refinement.matches.iter().map(|m| m.pair).collect());
        let matches: Vec<PointPair> = found.unwrap_or_else(|| supporting.to_vec());
        let others = self.hypotheses.iter().map(Estimate::fundamental);
        let rivals: Vec<&FundamentalMatrix> =
            others.filter(|other| differs(f, other, &matches, frames)).collect();
        let agreement = unguided_agreement(patches, f, frames);
        Some(line_evidence(f, &rivals, patches.unguided(), frames, &agreement))
    }

    fn warnings(&self, f: &FundamentalMatrix) -> Vec<Warning> {
        let SearchInput { prepared, clicks, .. } = self.viewed.input;
        let mut warnings = little_texture(clicks, self.pencils);
        warnings.extend(click_warnings(f, prepared.frames(), clicks));
        warnings
    }
}
