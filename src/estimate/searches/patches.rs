//! Search with patches: votes for κ propose geometries, patch support ranks them, and matches along
//! the epipolar lines refine them.

use super::REPORTED;
use super::judged::{distinct_hypotheses, report_preliminary};
use super::pencils::compare_pencils;
use super::ranked::Ranked;
use super::record::SearchRecord;
use crate::estimate::evidence::lines::draw_pairs;
use crate::estimate::evidence::patches;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::{Estimate, EstimateError, HypothesisNote, Proposed, Stage};

/// Proposes and ranks geometries through two clicks, or through two matches in their place, under one view.
pub(super) fn ranked(viewed: &ViewedPair, record: &mut SearchRecord) -> Result<Ranked, EstimateError> {
    let SearchInput { clicks, parameters, .. } = viewed.input;
    let cancel = record.cancel();
    let (coarse, voting) = (viewed.patches.coarse(), viewed.patches.voting());
    let (anchors, pencils) = compare_pencils(viewed, record)?;

    record.enter(Stage::Hypotheses)?;
    let candidates = pencils.each_ref().map(|compared| compared.candidates.as_slice());
    let drawn = draw_pairs(candidates, parameters.hypotheses, parameters.seed);
    let supported = parameters.patches.supported;
    let proposals = patches::propose(coarse, voting, candidates, &drawn, &anchors, supported, cancel)?;
    if let Some(first) = proposals.first()
        && let Some(proposed) = first.proposed(coarse.scales)
    {
        let to_draw = proposals.iter().take(REPORTED);
        let hypotheses: Vec<Estimate> =
            to_draw.filter_map(|p| Some(p.unvalidated(coarse.scales, anchors)?.into())).collect();
        let support = Some(first.support);
        report_preliminary(proposed, &hypotheses, support, viewed, record);
    }
    let noted = proposals.iter().filter_map(|proposal| {
        let support = Some(proposal.support.score);
        Some(HypothesisNote { support, ..proposal.proposed(coarse.scales)?.into() })
    });
    record.note_proposals(drawn.len(), &noted.collect::<Vec<_>>());
    record.counts.hypotheses = drawn.len();
    record.counts.validated = proposals.len();

    record.enter(Stage::Validation)?;
    let fine = viewed.patches.fine();
    let ranked = patches::rank(coarse, fine, &proposals, &clicks.observed(), parameters, cancel)?;
    let (hypotheses, leader) = distinct_hypotheses(&ranked, viewed, cancel)?;
    record.note_ranking(&hypotheses, Some(fine));
    let best = Proposed { fundamental: *hypotheses[0].fundamental(), origin: leader.origin };
    report_preliminary(best, &hypotheses, Some(leader.support), viewed, record);

    Ok(Ranked { proposals: ranked, hypotheses })
}
