//! The worst trials of the two-point method, and what explains them.

use super::circumstances::Circumstances;
use super::sight::Sight;
use super::{ReportSubject, TWO_POINT};
use crate::evaluate::report::TrialRecord;
use crate::evaluate::table::pixels;
use crate::publish::{Publication, TextTable};

/// Trials that are shown.
const SHOWN: usize = 3;

/// A trial and whose it is.
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
    let shown = different_clicks(&worst_first(&all));
    if shown.is_empty() {
        document.paragraph("No trial of two-point gave a fundamental matrix.");
        return;
    }
    document.paragraph(
        "The largest errors of all two-point trials with a result, of each draw of clicks the worst, and what is unusual \
         about the clicks or went wrong in the search.",
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

/// The first few of which no two have the same clicks.
fn different_clicks<'a>(places: &[WorstTrial<'a>]) -> Vec<WorstTrial<'a>> {
    let mut chosen: Vec<WorstTrial> = Vec::new();
    for place in places {
        if chosen.len() < SHOWN
            && !chosen.iter().any(|c| c.scene == place.scene && c.trial.trial == place.trial.trial)
        {
            chosen.push(*place);
        }
    }
    chosen
}

/// The worst trial of each contender in a row.
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
            "The worst trial of each: its error, and that of the best hypothesis the search had kept, px."
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
