//! The search with lines and nothing else (paper, section 4): no point is known.

use crate::estimate::evidence::lines::{LineConsensus, compare_lines, geometries_from_lines};
use crate::estimate::searches::features::by_features;
use crate::estimate::searches::record::SearchRecord;
use crate::estimate::searches::search::{Found, Judged, SearchInput};
use crate::estimate::searches::unclicked::chosen;
use crate::estimate::verdict::result::REPORTED;
use crate::estimate::{Estimate, EstimateError, Parameters, Search, Stage};
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::similarity::SimilarityParameters;

/// Disparities tried where no anchor shows the same scene point in both images: as a fraction of the longer side, at least.
const UNANCHORED_REACH: f64 = 0.25;

/// Candidate pairs among all lines, two for the epipoles and a third for the map, counted by the candidates that agree.
pub(in crate::estimate) fn by_lines_alone(
    input: &SearchInput,
    ranked_by: Search,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let SearchInput { prepared, parameters, cancel, .. } = *input;
    record.enter(Stage::Pencils)?;
    let reach = parameters.similarity.disparity_reach.max(UNANCHORED_REACH);
    let similarity = SimilarityParameters { disparity_reach: reach, ..parameters.similarity };
    let unanchored = Parameters { similarity, ..parameters.clone() };
    let source = prepared.similarity_source(input.patches.view(), &unanchored);
    let alone = &parameters.lines_alone;
    let level = source.at(alone.side);
    let compared = compare_lines(&level, alone.lines, source.rotation(), &parameters.pencils, cancel)?;
    record.lines_alone(compared.lines, compared.pairs.len());

    record.enter(Stage::Hypotheses)?;
    let how = LineConsensus { draws: alone.draws, area: alone.agreement, seed: parameters.seed };
    let found = geometries_from_lines(&compared.pairs, level.frames, &how, cancel)?;
    record.counts.hypotheses = alone.draws;
    let full_size = level.scales.map(f64::recip);
    let geometries: Vec<FundamentalMatrix> = found
        .iter()
        .filter_map(|one| one.fundamental.rescaled(full_size[0], full_size[1]))
        .take(REPORTED)
        .collect();
    let hypotheses: Vec<Estimate> = geometries.iter().map(|f| Estimate::from(*f)).collect();
    let fundamental = *geometries.first().ok_or(EstimateError::NothingWithoutClicks)?;
    input.report(record, fundamental, &hypotheses, None);

    if ranked_by == Search::Patches
        && let Some(found) = by_their_patches(input, &geometries, record)?
    {
        return Ok(found);
    }
    record.enter(Stage::Refinement)?;
    let refined = input.refined(geometries.into_iter())?;
    let matches = refined.iter().flat_map(|refined| &refined.refinement.matches);
    let supporting = matches.map(|m| m.pair).collect();
    let found = Found { fundamental, hypotheses, supporting, refined, clicks_alone: false };
    Ok(input.judged(record, found))
}

/// What lines proposed, ranked and refined by patches; `None` where patches find nothing to hold on to.
fn by_their_patches(
    input: &SearchInput,
    geometries: &[FundamentalMatrix],
    record: &mut SearchRecord,
) -> Result<Option<Judged>, EstimateError> {
    let SearchInput { prepared, patches, .. } = *input;
    record.enter(Stage::Validation)?;
    let fine = patches.fine(prepared.pyramids());
    let full_size = fine.scales.map(f64::recip);
    let putative: Vec<PointPair> =
        fine.support.distinctive().into_iter().map(|m| m.rescaled(full_size)).collect();
    let Some(chosen) = geometries.iter().find_map(|f| chosen(prepared, f, &[], &putative)) else {
        return Ok(None);
    };
    let clicks = input.clicks.with_chosen(chosen);
    let seen = SearchInput { clicks: &clicks, ..*input };
    let found = by_features(&seen, geometries, &[])?;
    Ok(found.map(|found| seen.judged(record, found)))
}
