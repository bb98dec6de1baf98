//! Search with patches: votes for κ propose, patch support ranks, matches along the epipolar lines refine.

use crate::estimate::evidence::lines::draw_pairs;
use crate::estimate::evidence::patches;
use crate::estimate::searches::record::SearchRecord;
use crate::estimate::searches::search::{Found, SearchInput, compared};
use crate::estimate::verdict::result::REPORTED;
use crate::estimate::{Estimate, EstimateError, Stage};

/// The search with patches: they vote for the κ of combinations of candidate lines, their support ranks, and matches
/// along the epipolar lines refine.
pub(in crate::estimate) fn by_patches(
    input: &SearchInput,
    record: &mut SearchRecord,
) -> Result<Found, EstimateError> {
    let SearchInput { prepared, patches: levels, clicks, parameters, cancel, .. } = *input;
    let pyramids = prepared.pyramids();
    let (coarse, voting) = (levels.coarse(pyramids), levels.voting(pyramids));
    let (anchors, pencils) = compared(input, record)?;

    record.enter(Stage::Hypotheses)?;
    let candidates = pencils.each_ref().map(|compared| compared.candidates.as_slice());
    let drawn = draw_pairs(candidates, parameters.hypotheses, parameters.seed);
    let proposals = patches::propose(coarse, voting, &drawn, &anchors, cancel)?;
    if let Some(first) = proposals.first()
        && let Some(fundamental) = first.full_size(coarse.scales)
    {
        let to_draw = proposals.iter().take(REPORTED);
        let hypotheses: Vec<Estimate> =
            to_draw.filter_map(|p| Some(p.unvalidated(coarse.scales, anchors)?.into())).collect();
        input.report(record, fundamental, &hypotheses, Some(first.support));
    }
    record.counts.hypotheses = drawn.len();
    record.counts.validated = proposals.len();

    record.enter(Stage::Validation)?;
    let fine = levels.fine(pyramids);
    let ranked = patches::rank(coarse, fine, &proposals, &clicks.observed(), parameters, cancel)?;
    let (hypotheses, leader) = input.hypotheses(Some(&anchors), &ranked)?;
    input.report(record, *hypotheses[0].fundamental(), &hypotheses, Some(leader.support));

    record.enter(Stage::Refinement)?;
    input.refine_ranked(&ranked, hypotheses)
}
