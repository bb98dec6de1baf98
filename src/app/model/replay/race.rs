//! The race of the best hypotheses.

use super::kept;
use super::moment::{Ink, Moment, Racer};
use super::record::Record;
use super::strokes::{ease_in_out, farthest, lines_of, share};
use crate::estimate::SearchPlan;
use crate::presentation::{proposer_in_words, resampling_in_words};

/// Draws the step of validation.
pub fn validation(moment: &mut Moment, record: &Record, seconds: f64) {
    if record.trips.is_empty() {
        moment.zoom = 1.0 + (farthest(record) - 1.0) * (1.0 - ease_in_out(share(seconds, 0.0, 0.2)));
    }
    let (places, racers): (Vec<usize>, Vec<_>) =
        record.race.iter().enumerate().filter(|(_, own)| !own.course.is_empty()).unzip();
    let Some(checkpoints) = racers.first().map(|own| own.course.len()) else { return };
    // Several racers may have the same origin.
    let name = |k: usize| {
        let own = |k: usize| proposer_in_words(racers[k].hypothesis.origin.source);
        let same: Vec<usize> = (0..racers.len()).filter(|other| own(*other) == own(k)).collect();
        match same.iter().position(|other| *other == k) {
            Some(number) if same.len() > 1 => format!("{} ({})", own(k), number + 1),
            _ => own(k),
        }
    };
    let along = share(seconds, 0.0, 0.8) * checkpoints as f64;
    // Before the first checkpoint, no support has been counted.
    let support = |own: &[f64], along: f64| {
        let (last, part) = (along.floor() as usize, along.fract());
        let at = |k: usize| k.checked_sub(1).map_or(0.0, |k| own[k.min(own.len() - 1)]);
        at(last) + (at(last + 1) - at(last)) * part
    };
    let ranks = |along: f64| {
        let mut order: Vec<usize> = (0..racers.len()).collect();
        let own = |k: &usize| support(&racers[*k].course, along);
        order.sort_by(|a, b| own(b).total_cmp(&own(a)).then(a.cmp(b)));
        let mut ranks = vec![0; order.len()];
        for (rank, racer) in order.into_iter().enumerate() {
            ranks[racer] = rank;
        }
        ranks
    };
    // Rows change places within 0.12 s after a checkpoint.
    let (before, now) = (ranks((along.floor() - 1.0).max(0.0)), ranks(along.floor()));
    let swap = ease_in_out(share(along.fract() * 0.8 / checkpoints as f64, 0.0, 0.04));
    let is_over = along >= checkpoints as f64;
    let row = |k: usize| {
        let swap = if is_over { 1.0 } else { swap };
        before[k] as f64 + (now[k] as f64 - before[k] as f64) * swap
    };
    moment.race = (0..racers.len())
        .map(|k| Racer {
            name: name(k),
            place: places[k],
            support: support(&racers[k].course, along),
            at_end: racers[k].course.last().copied().unwrap_or(0.0),
            row: row(k),
        })
        .collect();
    let leader = (0..racers.len()).min_by_key(|k| now[*k]).unwrap_or(0);
    let turned_up = 0.25 + 0.65 * along / checkpoints as f64;
    lines_of(moment, record, &racers[leader].hypothesis.fundamental, Ink::Unchecked, turned_up);
    moment.kept = kept::same(record, &racers[leader].hypothesis);
    moment.tell("leader", moment.race[leader].name.clone());
    if let Some(then) = racers[leader].hypothesis.origin.then {
        // Its epipoles are no longer those of the first proposal.
        moment.tell("improved by", resampling_in_words(then));
    }
    moment.tell("support", format!("{:.0}", moment.race[leader].support));
    let second = moment.race.iter().enumerate().filter(|(k, _)| *k != leader).map(|(_, own)| own.support);
    if let Some(second) = second.reduce(f64::max) {
        moment.tell("next best", format!("{second:.0}"));
    }
    if record.plan == SearchPlan::Barcodes {
        // The first figure is the support before the fit.
        let round = (along as usize).saturating_sub(1);
        moment.tell("round of the fits", format!("{round} of {}", checkpoints - 1));
    } else {
        moment.tell("counted", format!("{:.0} % of the evidence", 100.0 * along / checkpoints as f64));
    }
}
