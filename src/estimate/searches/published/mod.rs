//! Search of the paper (section 5.1): bisectors and round trips propose, lines rank and refine.

mod hypotheses;
mod refinement;

use super::search::{Found, SearchInput, compared};
use crate::estimate::evidence::lines::LineFigures;
use crate::estimate::searches::record::SearchRecord;
use crate::estimate::verdict::result::REPORTED;
use crate::estimate::{Estimate, EstimateError, Stage};
use crate::geometry::FundamentalMatrix;

/// The search as published: bisectors and round trips propose, lines over both images rank, and the five numbers of the
/// best one are refined on lines.
pub(in crate::estimate) fn by_lines(
    input: &SearchInput,
    record: &mut SearchRecord,
) -> Result<Found, EstimateError> {
    let SearchInput { source, clicks, parameters, cancel, .. } = *input;
    let similarity = source.at(parameters.pencils.coarse_side);
    let (anchors, pencils) = compared(input, record)?;

    record.enter(Stage::Hypotheses)?;
    let third = clicks.third();
    let pencils = pencils.each_ref().map(AsRef::as_ref);
    let mut drafts = hypotheses::propose(&similarity, pencils, third.as_ref(), parameters, cancel)?;
    record.counts.hypotheses = drafts.len();
    drafts.truncate(hypotheses::validated(&drafts, third.is_some(), parameters));
    record.counts.validated = drafts.len();

    record.enter(Stage::Validation)?;
    let ranked = hypotheses::rank(&similarity, drafts, anchors, REPORTED, parameters, cancel)?;
    let proposed =
        |(f, lines): &(FundamentalMatrix, LineFigures)| Estimate::proposed(*f, Some(lines.clone()), None);
    let hypotheses: Vec<Estimate> = ranked.hypotheses.iter().map(proposed).collect();
    input.report(record, ranked.hypotheses[0].0, &hypotheses, None);

    record.enter(Stage::Refinement)?;
    let fundamental = hypotheses::refine(source, &ranked, anchors, parameters, cancel)?;
    let starts = std::iter::once(fundamental).chain(ranked.hypotheses.iter().map(|(f, _)| *f));
    let refined = input.refined(starts)?;
    let matches = refined.iter().flat_map(|refined| &refined.refinement.matches);
    let supporting = matches.map(|m| m.pair).collect();
    Ok(Found { fundamental, hypotheses, supporting, refined, clicks_alone: false })
}
