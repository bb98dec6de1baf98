//! Worst trials of the two-point method, with possible causes.

use super::circumstances::Circumstances;
use super::sight::Sight;
use super::{ReportSubject, TWO_POINT};
use crate::evaluate::report::TrialRecord;
use crate::evaluate::table::pixels;
use crate::publish::{Publication, TextTable};

/// Minimum number of trials shown, if there are so many.
const SHOWN: usize = 3;
/// Maximum number of pairs with a bad trial shown.
const MOST_SHOWN: usize = 12;

/// Trial with its scene and contender.
#[derive(Clone, Copy)]
struct WorstTrial<'a> {
    scene: usize,
    contender: usize,
    trial: &'a TrialRecord,
}

pub(super) fn write(subject: &ReportSubject, document: &mut Publication) {
    let worst_first = |contenders: &[usize]| {
        let mut places: Vec<WorstTrial> = contenders
            .iter()
            .flat_map(|&contender| (0..subject.scenes.len()).map(move |scene| (scene, contender)))
            .flat_map(|(scene, contender)| {
                subject.record(scene, contender).trials.iter().map(move |trial| WorstTrial {
                    scene,
                    contender,
                    trial,
                })
            })
            .filter(|place| place.trial.fundamental.is_some())
            .collect();
        places.sort_by(|a, b| b.trial.mean.total_cmp(&a.trial.mean));
        places
    };
    let all: Vec<usize> = subject.of_method(TWO_POINT).collect();
    if all.is_empty() {
        return;
    }
    document.section("Worst trials");
    let places = worst_first(&all);
    let good = |place: &WorstTrial| place.trial.mean < subject.scenes[place.scene].good_error();
    let draws: Vec<Draw> = places.iter().map(|p| (p.scene, p.trial.trial, good(p))).collect();
    let shown: Vec<WorstTrial> = chosen(&draws).into_iter().map(|k| places[k]).collect();
    if shown.is_empty() {
        document.paragraph("No trial of two-point gave a fundamental matrix.");
        return;
    }
    document.paragraph(
        format!(
            "The largest errors of all two-point trials with a result: the worst trial of every pair with one above \
             1 % of the longer side ({MOST_SHOWN} at most), then of others until {SHOWN} are shown, with what is \
             unusual about the clicks or went wrong in the search.",
        ),
    );
    if all.len() > 1 {
        let each = all.iter().filter_map(|c| worst_first(&[*c]).first().copied());
        document.table(comparison(subject, each));
    }
    for (k, place) in shown.into_iter().enumerate() {
        if let Some(sight) = Sight::new(subject, place.scene, place.contender, place.trial) {
            show(subject, &sight, place, k + 1, document);
        }
    }
}

/// Index of a pair, index of a draw of clicks on it, and whether the result is good.
type Draw = (usize, usize, bool);

/// Selects the trials to show from a list with the worst first: the worst trial of each pair, bad
/// ones first, then other trials. No clicks appear twice, even if another preset had them too.
fn chosen(worst_first: &[Draw]) -> Vec<usize> {
    let (mut of_pairs, mut others): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
    for (k, (pair, draw, _)) in worst_first.iter().enumerate() {
        let has = |chosen: &usize| worst_first[*chosen].0 == *pair;
        if !of_pairs.iter().any(has) {
            of_pairs.push(k);
        } else if !of_pairs.iter().chain(&others).any(|c| has(c) && worst_first[*c].1 == *draw) {
            others.push(k);
        }
    }
    // A good error depends on the image size, so a bad trial may follow good trials of larger
    // images.
    let is_good = |k: &usize| worst_first[*k].2;
    of_pairs.sort_by_key(is_good);
    let bad = of_pairs.iter().filter(|k| !is_good(k)).count();
    of_pairs.extend(others);
    of_pairs.truncate(bad.clamp(SHOWN, MOST_SHOWN));
    of_pairs
}

/// Returns a table of the worst trial of each contender.
fn comparison<'a>(subject: &ReportSubject, places: impl Iterator<Item = WorstTrial<'a>>) -> TextTable {
    let rows = places.map(|WorstTrial { scene, contender, trial }| {
        vec![
            subject.contenders[contender].label(),
            subject.scenes[scene].name.clone(),
            trial.verdict.map_or("-", crate::estimate::Verdict::label).to_owned(),
            (trial.trial + 1).to_string(),
            pixels(trial.mean),
            trial.search.map_or_else(|| "-".to_owned(), |search| pixels(search.best_error)),
        ]
    });
    TextTable {
        caption:
            "The worst trial of each contender: its error, and the error of the best hypothesis kept, px."
                .to_owned(),
        headings: ["method", "pair", "verdict", "trial", "error", "best hypothesis"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
        words: 3,
        ruled: Vec::new(),
    }
}

fn show(
    subject: &ReportSubject,
    sight: &Sight,
    place: WorstTrial,
    number: usize,
    document: &mut Publication,
) {
    let (label, name, trial) =
        (subject.contenders[place.contender].label(), &sight.scene.name, sight.trial.trial + 1);
    let circumstances = Circumstances::of(sight);
    document.subsection(format!(
        "{number}. Pair {name}, trial {trial}, {label}: {} px",
        pixels(sight.trial.mean)
    ));
    document.list(circumstances.sentences());
    document.figure(
        format!("worst-{number}"),
        sight.picture(),
        format!(
            "Pair {name}, trial {trial} of {label}: estimated epipolar lines (green) and true ones (blue), error {} px.",
            pixels(sight.trial.mean)
        ),
    );
    document.facts(sight.facts().into_iter().chain(circumstances.facts()).collect());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_of_every_bad_pair_is_shown_and_no_clicks_twice() {
        // Two presets have the worst trials, on the same clicks of pair 4. Pairs 7 and 2 are bad, 1
        // is good.
        let draws = [
            (4, 0, false),
            (4, 0, false),
            (4, 1, false),
            (7, 2, false),
            (2, 0, false),
            (1, 0, true),
            (7, 1, true),
        ];
        assert_eq!(chosen(&draws), [0, 3, 4]);
        // One pair fills up with its other draws. A long list of bad pairs is cut.
        assert_eq!(chosen(&draws[..3]), [0, 2]);
        let many: Vec<Draw> = (0..40).map(|pair| (pair, 0, pair > 30)).collect();
        assert_eq!(chosen(&many), (0..MOST_SHOWN).collect::<Vec<_>>());
        let four: Vec<Draw> = (0..9).map(|pair| (pair, 0, pair > 3)).collect();
        assert_eq!(chosen(&four), [0, 1, 2, 3]);
        // Larger images tolerate larger errors in px.
        let mixed = [(1, 0, true), (3, 0, true), (2, 0, false), (5, 0, true), (2, 1, false)];
        assert_eq!(chosen(&mixed), [2, 0, 1]);
        assert_eq!(chosen(&[]), [0; 0]);
    }
}
