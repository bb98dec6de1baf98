//! All trials of all methods: tables and plots of the errors.

use super::{ReportSubject, style};
use crate::evaluate::median;
use crate::evaluate::report::Record;
use crate::evaluate::table::{Summary, has_printed, label, pixels, range, share};
use crate::publish::plot::{Distribution, Strip, StripGroup, cumulative, strips};
use crate::publish::{Publication, TextTable};

/// Error limits marked in the plots, px.
const LIMITS: [f64; 2] = [1.0, 3.0];

pub(super) fn write(subject: &ReportSubject, document: &mut Publication) {
    document.section("Errors");
    document.table(medians(subject));
    let distributions: Vec<_> = (0..subject.contenders.len()).map(|c| distribution(subject, c)).collect();
    document.figure(
        "errors-cumulative",
        cumulative(&distributions, "mean symmetric epipolar distance of a trial, px", "trials not above", &LIMITS),
        "Fraction of all trials whose error is at most the value on the axis. A curve that ends below 100 % has trials \
         without a result; further to the left is better.",
    );
    let reference = has_printed(subject.report);
    document.figure(
        "errors-by-pair",
        strips(&groups(subject), "mean symmetric epipolar distance of a trial, px", "median", "printed", &LIMITS),
        format!(
            "Every trial by pair and method, rows in the order of the legend; bars are the 95 % bootstrap intervals of \
             the medians{}. Trials without a result are counted at the right.",
            if reference { ", diamonds the values printed in the paper" } else { "" }
        ),
    );
    let Summary { headings, rows, groups, remarks } = Summary::new(subject.report);
    document.table(TextTable {
        caption: "All figures: errors in px, with a 95 % bootstrap interval of the median, times in seconds per trial \
                  until the result and until the first geometry."
            .to_owned(),
        headings,
        rows,
        words: Summary::WORDS,
        ruled: groups,
    });
    document.list(remarks);
}

/// Returns the table of pairs against methods, arranged as in the published experiment.
fn medians(subject: &ReportSubject) -> TextTable {
    let report = subject.report;
    // Columns of a method, followed by its printed errors.
    let mut headings = vec!["pair".to_owned()];
    let mut columns: Vec<MedianColumn> = Vec::new();
    for (c, contender) in subject.contenders.iter().enumerate() {
        headings.push(contender.label());
        columns.push(MedianColumn::Ours(c));
        let last = subject.contenders.get(c + 1).is_none_or(|next| next.method() != contender.method());
        if last && (0..subject.scenes.len()).any(|s| subject.record(s, c).printed.is_some()) {
            headings.push(format!("{}, printed", contender.method()));
            columns.push(MedianColumn::Printed(c));
        }
    }
    let row = |name: &str, ours: &dyn Fn(usize) -> String, printed: &dyn Fn(usize) -> String| {
        let cells = columns.iter().map(|column| match column {
            MedianColumn::Ours(c) => ours(*c),
            MedianColumn::Printed(c) => printed(*c),
        });
        std::iter::once(name.to_owned()).chain(cells).collect::<Vec<_>>()
    };
    let mut rows: Vec<_> = (0..subject.scenes.len())
        .map(|s| {
            let of = |c: usize| subject.record(s, c);
            let printed = |c: usize| pixels(of(c).printed.unwrap_or(f64::NAN));
            row(&subject.scenes[s].name, &|c| pixels(of(c).median), &printed)
        })
        .collect();
    let pairs = rows.len();
    let overall = |c: usize| report.overall.get(c);
    let cell = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    let nothing = |_: usize| String::new();
    rows.push(row("median", &|c| cell(overall(c).map(|o| pixels(o.median_of_medians))), &|c| {
        cell(overall(c).and_then(|o| o.printed).map(pixels))
    }));
    rows.push(row("95 %", &|c| cell(overall(c).map(|o| range(o.median_of_medians_interval))), &nothing));
    for (name, of) in
        [("< 1 px", (|s| s.below_1_px) as fn(&crate::evaluate::Shares) -> f64), ("< 3 px", |s| s.below_3_px)]
    {
        rows.push(row(name, &|c| cell(overall(c).map(|o| share(of(&o.shares)))), &nothing));
    }
    let turned = |c: usize| {
        let trials = (0..subject.scenes.len()).flat_map(|s| {
            let found = subject.record(s, c).trials.iter().filter_map(|t| t.fundamental);
            found.map(move |f| subject.scenes[s].turned(&f).to_degrees())
        });
        let middle = median(&trials.collect::<Vec<_>>());
        if middle.is_nan() { "-".to_owned() } else { format!("{middle:.1}°") }
    };
    rows.push(row("turned by", &turned, &nothing));
    rows.push(row("no result", &|c| cell(overall(c).map(|o| o.failures.to_string())), &nothing));
    TextTable {
        caption: "Median error of the trials of each pair, px; below, the median over pairs with its 95 % bootstrap \
                  interval over the draws of clicks, the share of trials below 1 and 3 px, the median angle by which the \
                  epipolar lines of the true matches are turned against the true ones, and the trials without a result."
            .to_owned(),
        headings,
        rows,
        words: 1,
        ruled: vec![pairs],
    }
}

/// Column of the table of medians.
enum MedianColumn {
    /// Measured errors of a contender.
    Ours(usize),
    /// Printed errors of its method.
    Printed(usize),
}

/// Returns all trials of a contender.
fn distribution(subject: &ReportSubject, contender: usize) -> Distribution {
    let records = (0..subject.scenes.len()).map(|s| subject.record(s, contender));
    Distribution {
        name: subject.contenders[contender].label(),
        stroke: style::stroke(subject, contender),
        values: records.flat_map(|r| r.trials.iter().map(|t| t.mean)).collect(),
    }
}

/// Returns one group per pair with one row per contender.
fn groups(subject: &ReportSubject) -> Vec<StripGroup> {
    let strip = |record: &Record, c: usize| Strip {
        name: label(&record.method, record.preset.as_deref()),
        stroke: style::stroke(subject, c),
        values: record.trials.iter().map(|t| t.mean).collect(),
        middle: record.median,
        interval: record.median_interval.map(|i| [i.low, i.high]),
        reference: record.printed,
    };
    (0..subject.scenes.len())
        .map(|s| StripGroup {
            name: subject.scenes[s].name.clone(),
            strips: (0..subject.contenders.len()).map(|c| strip(subject.record(s, c), c)).collect(),
        })
        .collect()
}
