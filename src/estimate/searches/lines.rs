//! Search with lines alone, without any point (paper, section 4).

use super::REPORTED;
use super::features::judge_proposed;
use super::judged::{Found, Judged, report_preliminary};
use super::record::SearchRecord;
use super::refinement::refine_best;
use super::stand_ins::farthest_apart;
use crate::estimate::evidence::lines::{LineCandidate, LineConsensus, compare_lines, geometries_from_lines};
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::verdict::assessment::RestsOn;
use crate::estimate::{
    Estimate, EstimateError, HypothesisNote, Parameters, Proposed, ProposedBy, Search, Stage,
};
use crate::geometry::PointPair;
use crate::similarity::{ScaledSimilarity, SimilarityParameters, SimilaritySource};

/// Smallest reach of disparities without a click to fix their zero, as a share of the longer side:
/// a quarter of the image. The time grows with it.
const UNANCHORED_REACH: f64 = 0.25;

/// Finds candidate pairs among all lines and draws three of them at a time: two give the epipoles,
/// a third gives the map. Counts the candidates that agree.
pub(in crate::estimate) fn search(
    input: SearchInput,
    ranked_by: Search,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let viewed = ViewedPair::upright(input);
    let parameters = input.parameters;
    let reach = parameters.similarity.disparity_reach.max(UNANCHORED_REACH);
    let similarity = SimilarityParameters { disparity_reach: reach, ..parameters.similarity };
    let unanchored = Parameters { similarity, ..parameters.clone() };
    let source = input.prepared.similarity_source(viewed.patches.view(), &unanchored);
    let mut geometries = from_all_lines(&*source, parameters, record, |_, pairs| Ok(pairs))?;
    geometries.truncate(REPORTED);
    let hypotheses: Vec<Estimate> =
        geometries.iter().map(|proposed| Estimate::proposed(*proposed, None, None)).collect();
    let proposed = *geometries.first().ok_or(EstimateError::NothingWithoutClicks)?;
    report_preliminary(proposed, &hypotheses, None, &viewed, record);

    if ranked_by == Search::Patches
        && let Some(found) = by_their_patches(&geometries, &viewed, record)?
    {
        return Ok(found);
    }
    record.enter(Stage::Refinement)?;
    let refined = refine_best(geometries.into_iter(), &viewed, record.cancel())?.map(|(refined, _)| refined);
    let matches = refined.iter().flat_map(|refined| &refined.refinement.matches);
    let supporting = matches.map(|m| m.pair).collect();
    let found = Found { proposed, hypotheses, supporting, refined, rests_on: RestsOn::Images };
    Ok(Judged::of(found, &viewed, record))
}

/// Returns geometries from the consensus of all lines, best first, full-size pixels. `sharpened` may move
/// the candidates, in pixels of the level, before they are drawn.
pub(super) fn from_all_lines(
    source: &dyn SimilaritySource,
    parameters: &Parameters,
    record: &mut SearchRecord,
    sharpened: impl FnOnce(&ScaledSimilarity, Vec<LineCandidate>) -> Result<Vec<LineCandidate>, EstimateError>,
) -> Result<Vec<Proposed>, EstimateError> {
    record.enter(Stage::Pencils)?;
    let cancel = record.cancel();
    let alone = &parameters.lines_alone;
    let level = source.at(alone.side);
    let compared = compare_lines(&level, alone.lines, source.rotation(), &parameters.pencils, cancel)?;
    record.lines_alone = Some((compared.lines, compared.pairs.len()));

    record.enter(Stage::Hypotheses)?;
    let pairs = sharpened(&level, compared.pairs)?;
    record.note_lines(compared.lines, &compared.swept, &pairs, level.scales);
    let how = LineConsensus { draws: alone.draws, area: alone.agreement, seed: parameters.seed };
    let found = geometries_from_lines(&pairs, level.frames, &how, cancel)?;
    record.counts.hypotheses += alone.draws;
    let full_size = level.scales.map(f64::recip);
    let full_size = found.iter().filter_map(|one| one.fundamental.rescaled(full_size));
    let proposed: Vec<Proposed> = full_size.map(|f| Proposed::by(ProposedBy::AllLines, f)).collect();
    let noted: Vec<HypothesisNote> = proposed.iter().map(|one| (*one).into()).collect();
    record.note_proposals(alone.draws, &noted);
    Ok(proposed)
}

/// Ranks, refines and judges the proposals by patches. `None` if too few patches match.
fn by_their_patches(
    geometries: &[Proposed],
    viewed: &ViewedPair,
    record: &mut SearchRecord,
) -> Result<Option<Judged>, EstimateError> {
    let SearchInput { prepared, clicks, .. } = viewed.input;
    record.enter(Stage::Validation)?;
    let fine = viewed.patches.fine();
    let full_size = fine.scales.map(f64::recip);
    let putative: Vec<PointPair> =
        fine.support.distinctive().into_iter().map(|m| m.rescaled(full_size)).collect();
    let chosen = geometries
        .iter()
        .find_map(|proposed| farthest_apart(prepared, &proposed.fundamental, &[], &putative));
    let Some(chosen) = chosen else { return Ok(None) };
    judge_proposed(geometries, &viewed.with_clicks(&clicks.with_chosen(chosen)), record)
}
