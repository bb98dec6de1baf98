//! The figures of any geometry, as if it had been among the hypotheses.

use crate::cancel::CancelFlag;
use crate::estimate::lines::{LineExaminer, LineFigures, PencilAngles};
use crate::estimate::patches::{BAND, PatchLevels, SupportLevel};
use crate::estimate::{Assessment, Estimate, Parameters, PatchSupport, PreparedPair, Search};
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::similarity::SimilaritySource;

/// What figures are computed from.
pub(super) struct Examiner<'a> {
    pub prepared: &'a PreparedPair,
    pub source: &'a dyn SimilaritySource,
    pub patches: &'a PatchLevels,
    pub parameters: &'a Parameters,
}

impl Examiner<'_> {
    /// The patches that agree with `f` (full size), where the search looks at patches.
    pub fn patch_support(&self, f: &FundamentalMatrix) -> Option<PatchSupport> {
        let fine = self.fine()?;
        Some(fine.support.measure(&f.rescaled(fine.scales[0], fine.scales[1])?))
    }

    /// What the lines through two clicks say of `f` (full size); `None` where they degenerate. `turn` is about how far
    /// image 2 is rotated against image 1, radians.
    pub fn line_figures(
        &self,
        clicks: [PointPair; 2],
        f: &FundamentalMatrix,
        turn: f64,
    ) -> Option<LineFigures> {
        let mut angles = PencilAngles::of(f, &clicks, turn)?;
        if let Some(fine) = self.fine() {
            let at_fine = f.rescaled(fine.scales[0], fine.scales[1])?;
            let matches = fine.support.matches(&at_fine, BAND);
            let own = clicks.map(|click| click.rescaled(fine.scales));
            // κ where the scene is, as for every other hypothesis.
            let pairs = matches.iter().map(|m| m.pair);
            angles = PencilAngles::nearest(&at_fine, &own, &angles, pairs).unwrap_or(angles);
        }
        let cancel = CancelFlag::default();
        let examiner = LineExaminer::new(self.source, clicks, self.parameters, &cancel);
        examiner.figures(&[angles]).pop().flatten()
    }

    fn fine(&self) -> Option<&SupportLevel> {
        match self.parameters.search {
            Search::Patches => Some(self.patches.fine(self.prepared.pyramids())),
            Search::Lines => None,
        }
    }
}

/// What the estimator would say of `f` (full size), had it been among the hypotheses of the search that found `beside`
/// on the same images with these clicks and parameters: to rank a matrix from elsewhere, the true one say.
///
/// `None` where the epipolar lines of `f` degenerate at the clicks.
pub fn examine(
    prepared: &PreparedPair,
    clicks: [PointPair; 2],
    f: &FundamentalMatrix,
    beside: &Estimate,
    parameters: &Parameters,
) -> Option<Estimate> {
    let view = beside.view();
    let (source, patches) = (prepared.similarity_source(view, parameters), prepared.patches_of(beside));
    let examiner = Examiner { prepared, source: &*source, patches: &patches, parameters };
    let turn = beside.hypotheses().first().map_or(view.rotation, Estimate::turn);
    let assessment = Assessment {
        lines: Some(examiner.line_figures(clicks, f, turn)?),
        support: examiner.patch_support(f),
        ..Assessment::default()
    };
    Some(Estimate { geometry: (*f).into(), assessment, trace: None })
}
