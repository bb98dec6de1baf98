//! The figures of any geometry, as if it had been among the hypotheses.

use crate::estimate::lines::{LineExaminer, LineFigures, PencilAngles};
use crate::estimate::patches::BAND;
use crate::estimate::{Assessment, Estimate, Monitor, Parameters, PatchSupport, PreparedPair, Search};
use crate::geometry::{FundamentalMatrix, PointPair};

/// The patches that agree with `f` (full size).
pub(super) fn patch_support(prepared: &PreparedPair, f: &FundamentalMatrix) -> Option<PatchSupport> {
    let fine = prepared.fine_support();
    Some(fine.support.measure(&f.rescaled(fine.scales[0], fine.scales[1])?))
}

/// What the lines through two clicks say of `f` (full size); `None` where they degenerate.
pub(super) fn line_figures(
    prepared: &PreparedPair,
    clicks: [PointPair; 2],
    f: &FundamentalMatrix,
    turn: f64,
    parameters: &Parameters,
) -> Option<LineFigures> {
    let mut angles = PencilAngles::of(f, &clicks, turn)?;
    if parameters.search == Search::Patches {
        let fine = prepared.fine_support();
        let at_fine = f.rescaled(fine.scales[0], fine.scales[1])?;
        let matches = fine.support.matches(&at_fine, BAND);
        let own = clicks.map(|click| click.rescaled(fine.scales));
        // κ where the scene is, as for every other hypothesis.
        let pairs = matches.iter().map(|m| m.pair);
        angles = PencilAngles::nearest(&at_fine, &own, &angles, pairs).unwrap_or(angles);
    }
    let source = prepared.similarity_source(parameters);
    let similarity = source.at(parameters.pencils.coarse_side);
    let monitor = Monitor::silent();
    let examiner = LineExaminer {
        similarity: &similarity,
        clicks,
        parameters: &parameters.validation,
        monitor: &monitor,
    };
    examiner.figures(&[angles]).pop().flatten()
}

/// What the estimator would say of `f` (full size), had it been among its hypotheses: to rank a matrix from
/// elsewhere, the true one say, among those of a search with the same clicks and parameters.
///
/// `turn` is about how far image 2 is rotated against image 1, radians, as [`Estimate::turn`] of another
/// hypothesis tells. `None` where the epipolar lines of `f` degenerate at the clicks.
pub fn examine(
    prepared: &PreparedPair,
    clicks: [PointPair; 2],
    f: &FundamentalMatrix,
    turn: f64,
    parameters: &Parameters,
) -> Option<Estimate> {
    let lines = line_figures(prepared, clicks, f, turn, parameters)?;
    let support = match parameters.search {
        Search::Patches => Some(patch_support(prepared, f)?),
        Search::Lines => None,
    };
    let assessment = Assessment { lines: Some(lines), support, ..Assessment::default() };
    Some(Estimate { geometry: (*f).into(), assessment, trace: None })
}
