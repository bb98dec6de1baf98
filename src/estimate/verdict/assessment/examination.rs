//! Figures of any geometry, computed like the figures of hypotheses.

use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::{LineExaminer, LineFigures, PencilAngles};
use crate::estimate::evidence::patches::BAND;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::{Assessment, Clicks, Estimate, Parameters, PatchSupport, PreparedPair, Search};
use crate::geometry::{FundamentalMatrix, PointPair};

/// Returns the patch support of `f` (full size). `None` if the search uses lines alone.
pub(super) fn patch_support(viewed: &ViewedPair, f: &FundamentalMatrix) -> Option<PatchSupport> {
    match viewed.input.parameters.search {
        Search::Patches => viewed.patches.measure(f),
        Search::Lines => None,
    }
}

/// Returns the figures of `f` (full size) by lines through two clicks. `None` if the lines
/// degenerate. `turn` is the approximate rotation of image 2 against image 1, radians.
pub(super) fn line_figures(
    viewed: &ViewedPair,
    clicks: [PointPair; 2],
    f: &FundamentalMatrix,
    turn: f64,
) -> Option<LineFigures> {
    let parameters = viewed.input.parameters;
    let mut angles = PencilAngles::of(f, &clicks, turn)?;
    if parameters.search == Search::Patches {
        let fine = viewed.patches.fine();
        let at_fine = f.rescaled(fine.scales)?;
        let matches = fine.support.matches(&at_fine, BAND);
        let own = clicks.map(|click| click.rescaled(fine.scales));
        // κ is fitted at the matches, as for all other hypotheses.
        let pairs = matches.iter().map(|m| m.pair);
        angles = PencilAngles::nearest(&at_fine, &own, &angles, pairs).unwrap_or(angles);
    }
    let cancel = CancelFlag::default();
    LineExaminer::new(&*viewed.source, clicks, parameters, &cancel).figures(&[angles]).pop().flatten()
}

/// Returns the figures of `f` (full size) as a hypothesis of the search that found `beside`, with
/// the same clicks and parameters. They rank an imported or true matrix among the hypotheses.
///
/// `None` if the epipolar lines of `f` degenerate at the clicks.
pub fn examine(
    prepared: &PreparedPair,
    clicks: [PointPair; 2],
    f: &FundamentalMatrix,
    beside: &Estimate,
    parameters: &Parameters,
) -> Option<Estimate> {
    let input = SearchInput { prepared, clicks: &Clicks::default(), parameters };
    let viewed = ViewedPair::new(input, prepared.patches_of(beside));
    let turn = beside.hypotheses().first().map_or(beside.view().rotation, Estimate::turn);
    let assessment = Assessment {
        lines: Some(line_figures(&viewed, clicks, f, turn)?),
        support: patch_support(&viewed, f),
        ..Assessment::default()
    };
    Some(Estimate { fundamental: *f, origin: None, assessment, trace: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Preset;
    use crate::estimate::exact::{ExactScene, ExactSource};
    use crate::geometry::finite_point;

    #[test]
    fn figures_of_the_truth_are_better_than_those_of_a_geometry_near_it() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        let (truth, wrong) = (scene.fundamental(), scene.disturbed(12.0));
        for (preset, by_patches) in [(Preset::Paper, false), (Preset::Robust, true)] {
            let parameters = Parameters::from(preset);
            let clicks = Clicks::default();
            let input = SearchInput { prepared: &prepared, clicks: &clicks, parameters: &parameters };
            let source = Box::new(ExactSource(scene.fundamental()));
            let viewed = ViewedPair { source, ..ViewedPair::upright(input) };
            let score = |f: &FundamentalMatrix| {
                line_figures(&viewed, scene.clicks(), f, 0.0).and_then(|figures| figures.score).unwrap()
            };
            assert!(score(&truth) < 0.5 * score(&wrong), "{} {}", score(&truth), score(&wrong));
            let [of_truth, of_wrong] = [truth, wrong].map(|f| patch_support(&viewed, &f));
            assert_eq!(of_truth.is_some(), by_patches, "published figures know no patches");
            if let (Some(right), Some(wrong)) = (of_truth, of_wrong) {
                assert!(right.score > 1.5 * wrong.score, "{right:?} {wrong:?}");
            }
        }
    }

    #[test]
    fn an_imported_matrix_is_examined_like_a_hypothesis() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        let parameters = Parameters::default();
        let beside = Estimate::from(scene.disturbed(1.0));
        let examined = |clicks, f: &FundamentalMatrix| examine(&prepared, clicks, f, &beside, &parameters);
        let of_truth = examined(scene.clicks(), &scene.fundamental()).unwrap();
        assert_eq!(of_truth.fundamental(), &scene.fundamental());
        assert!(of_truth.line_score().is_some() && of_truth.support_score().is_some());
        assert!(of_truth.trace.is_none() && of_truth.assessment.trust.is_none());
        // The epipole has no epipolar line.
        let forward = ExactScene::forward();
        let epipole = PointPair {
            point1: finite_point(&forward.fundamental().epipole1()).unwrap(),
            point2: finite_point(&forward.fundamental().epipole2()).unwrap(),
        };
        assert!(examined([epipole, forward.clicks()[1]], &forward.fundamental()).is_none());
    }
}
