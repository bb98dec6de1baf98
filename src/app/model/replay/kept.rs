//! Hypotheses of the result that parts of the replay belong to.
//!
//! A result keeps the best different hypotheses; the others were dropped. A part belongs to a kept hypothesis if both
//! have the same geometry, or if the part is a candidate that proposed the hypothesis.

use super::moment::Moment;
use super::record::Record;
use crate::app::model::focus::{Replayed, Target};
use crate::estimate::{HypothesisNote, ProposedBy, SearchPlan};

/// Returns the hypothesis that a part of a moment belongs to, by its place in the list of the result. `None` if the
/// part belongs to no kept one.
pub fn hypothesis_of(record: &Record, moment: &Moment, target: Target) -> Option<usize> {
    match target {
        Target::Replayed(Replayed::Hypothesis(k)) => same(record, record.hypotheses.get(k)?),
        Target::Replayed(Replayed::Racer(k)) => same(record, &record.race.get(k)?.hypothesis),
        Target::Replayed(Replayed::Line(_)) => moment.kept,
        Target::Hypothesis(k) => Some(k).filter(|k| *k < record.kept.len()),
        Target::Cell { pair, row, column } => {
            let compared = &record.pencils.get(pair)?.compared;
            let mut candidates = compared.candidates.iter();
            let rank = candidates.position(|own| compared.cell(own) == Some([row, column]))? + 1;
            from_line_pairs(record, |ranks| ranks.get(pair) == Some(&rank))
        }
        _ => None,
    }
}

/// Returns the kept hypothesis with the geometry of another one, or else the best kept one from the same line pairs.
pub fn same(record: &Record, own: &HypothesisNote) -> Option<usize> {
    let equal = record.kept.iter().position(|(fundamental, _)| *fundamental == own.fundamental);
    equal.or_else(|| from_source(record, own.origin.source))
}

/// Returns the best kept hypothesis from one pair of candidates. Other sources have many hypotheses in common.
pub fn from_source(record: &Record, source: ProposedBy) -> Option<usize> {
    let ProposedBy::LinePairs { ranks } = source else { return None };
    from_line_pairs(record, |other| other == ranks)
}

/// Returns the best kept hypothesis from candidates with such ranks. Without clicks, the search compares lines through
/// several pairs of matches, so that a rank does not tell the candidate.
fn from_line_pairs(record: &Record, is_one: impl Fn([usize; 2]) -> bool) -> Option<usize> {
    if record.plan == SearchPlan::Unclicked {
        return None;
    }
    record
        .kept
        .iter()
        .position(|(_, source)| matches!(source, Some(ProposedBy::LinePairs { ranks }) if is_one(*ranks)))
}
