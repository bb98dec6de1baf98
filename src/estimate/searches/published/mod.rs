//! Published search (paper, section 5.1). Bisectors and round trips propose geometries, and lines
//! over both images rank them. The five numbers of the best one are refined on lines.

mod hypotheses;
mod refinement;

use super::REPORTED;
use super::judged::{Found, Judged, report_preliminary};
use super::pencils::compare_pencils;
use super::record::SearchRecord;
use super::refinement::refine_best;
use crate::estimate::evidence::lines::LineFigures;
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::verdict::assessment::RestsOn;
use crate::estimate::{Estimate, EstimateError, HypothesisNote, Proposed, Stage};

/// Searches through two or three clicks by lines.
pub(in crate::estimate) fn search(
    input: SearchInput,
    record: &mut SearchRecord,
) -> Result<Judged, EstimateError> {
    let viewed = ViewedPair::upright(input);
    Ok(Judged::of(find(&viewed, record)?, &viewed, record))
}

/// Proposes, ranks and refines geometries, without an assessment.
pub(super) fn find(viewed: &ViewedPair, record: &mut SearchRecord) -> Result<Found, EstimateError> {
    let SearchInput { clicks, parameters, .. } = viewed.input;
    let (source, cancel) = (&*viewed.source, record.cancel());
    let similarity = source.at(parameters.pencils.coarse_side);
    let (anchors, pencils) = compare_pencils(viewed, record)?;

    record.enter(Stage::Hypotheses)?;
    let third = clicks.third();
    let pencils = pencils.each_ref().map(AsRef::as_ref);
    let mut drafts = hypotheses::propose(&similarity, pencils, third.as_ref(), parameters, cancel)?;
    record.counts.hypotheses = drafts.len();
    drafts.truncate(hypotheses::validated(&drafts, third.is_some(), parameters));
    record.counts.validated = drafts.len();

    record.enter(Stage::Validation)?;
    let ranked = hypotheses::rank(&similarity, drafts, anchors, REPORTED, parameters, cancel)?;
    let proposed = |(proposed, lines): &(Proposed, LineFigures)| {
        Estimate::proposed(*proposed, Some(lines.clone()), None)
    };
    let hypotheses: Vec<Estimate> = ranked.hypotheses.iter().map(proposed).collect();
    let noted: Vec<HypothesisNote> =
        ranked.hypotheses.iter().map(|(proposed, _)| (*proposed).into()).collect();
    record.note_proposals(record.counts.hypotheses, &noted);
    record.note_ranking(&hypotheses, None);
    let best = ranked.hypotheses[0].0;
    report_preliminary(best, &hypotheses, None, viewed, record);

    record.enter(Stage::Refinement)?;
    let fundamental = hypotheses::refine(source, &ranked, anchors, parameters, cancel)?;
    let first = Proposed { fundamental, ..best };
    let starts = std::iter::once(first).chain(ranked.hypotheses.iter().map(|(proposed, _)| *proposed));
    let (refined, origin) = refine_best(starts, viewed, cancel)?.unzip();
    let proposed = Proposed { origin: origin.unwrap_or(first.origin), ..first };
    let matches = refined.iter().flat_map(|refined| &refined.refinement.matches);
    let supporting = matches.map(|m| m.pair).collect();
    Ok(Found { proposed, hypotheses, supporting, refined, rests_on: RestsOn::Images })
}
