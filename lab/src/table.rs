//! Results of a report as table cells and as a plain text table.

use std::fmt::Write;

use super::bootstrap::Interval;
use super::median;
use super::report::{Figures, Overall, Record, Report, Shares, Verdicts};

/// Number of text columns, from the left.
const WORDS: usize = 2;

/// Formats the report as plain text, with remarks and notes: one row per pair and contender, then one per
/// contender over all pairs. Errors in px, times in seconds. Errors printed by the published experiment
/// stand beside the median of the same pair and method.
pub fn table(report: &Report) -> String {
    let printed = report.records.iter().any(|r| r.figures.printed.is_some());
    let mut rows = vec![headings(printed)];
    let mut last = None;
    for record in &report.records {
        let name = if last == Some(&record.pair) { "" } else { &record.pair };
        last = Some(&record.pair);
        rows.push(pair_row(name, record, printed));
    }
    let body_end = rows.len();
    rows.extend(report.overall.iter().enumerate().map(|(k, o)| overall_row(k, o, printed)));
    let mut text = layout(&rows, &[1, body_end]);
    if printed {
        text += "Printed: Fig. 8 of the paper, which uses the protocol paper and, as here, the best of three \
                 solutions for seven-point.\n";
    }
    if report.records.iter().any(|r| r.method == "seven-point") {
        text += "For seven-point, the solution nearest to all true matches counts.\n";
    }
    for note in &report.notes {
        let _ = writeln!(text, "Note: {note}");
    }
    text
}

fn headings(printed: bool) -> Vec<String> {
    let mut all =
        vec!["pair", "method", "matches", "trials", "median", "95 %", "mean", "<1 px", "<3 px", "<1 %"];
    all.extend(["failed", "time", "first"]);
    if printed {
        all.insert(AFTER_INTERVAL, "printed");
    }
    all.into_iter().map(str::to_owned).collect()
}

/// Column of printed errors, right of the median and its interval.
const AFTER_INTERVAL: usize = 6;

/// Formats the ranks of the search, one row per pair and contender with a search: medians of the
/// trials. Empty without such a contender.
pub fn search_table(report: &Report) -> String {
    let headings = [
        "pair",
        "method",
        "hypotheses",
        "best, px",
        "its rank: lines",
        "patches",
        "rank of truth: lines",
        "patches",
    ];
    let mut rows = vec![headings.map(str::to_owned).to_vec()];
    for record in &report.records {
        let searches: Vec<_> = record.trials.iter().filter_map(|t| t.search).collect();
        if searches.is_empty() {
            continue;
        }
        let middle = |values: Vec<f64>| median(&values);
        let rank = |of: &dyn Fn(&super::RankingRecord) -> Option<usize>| {
            let value = middle(searches.iter().filter_map(|s| of(s).map(|r| r as f64)).collect());
            if value.is_nan() { "-".to_owned() } else { format!("{value:.0}") }
        };
        rows.push(vec![
            record.pair.clone(),
            label(&record.method, record.preset.as_deref()),
            rank(&|s| Some(s.hypotheses)),
            pixels(middle(searches.iter().map(|s| s.best_error).collect())),
            rank(&|s| Some(s.best_rank_by_lines)),
            rank(&|s| s.best_rank_by_patches),
            rank(&|s| s.true_rank_by_lines),
            rank(&|s| s.true_rank_by_patches),
        ]);
    }
    if rows.len() == 1 { String::new() } else { layout(&rows, &[1]) }
}

/// Returns the accuracy of the verdicts, one sentence per contender with verdicts.
pub fn verdict_sentences(report: &Report) -> Vec<String> {
    let judged = report.overall.iter().filter(|overall| overall.figures.verdicts.results > 0);
    judged
        .map(|overall| {
            format!(
                "{}: {}",
                label(&overall.method, overall.preset.as_deref()),
                verdict_sentence(&overall.figures.verdicts)
            )
        })
        .collect()
}

/// Describes the accuracy of verdicts, omitting fractions of nothing.
fn verdict_sentence(v: &Verdicts) -> String {
    let everywhere = if v.good_everywhere == 0 {
        String::new()
    } else {
        format!(
            " Of the {} whose lines are equally close to the true ones over the whole images, {} {} called reliable.",
            v.good_everywhere,
            v.good_everywhere_and_called_reliable,
            if v.good_everywhere_and_called_reliable == 1 { "was" } else { "were" }
        )
    };
    sentence_on_matches(v) + &everywhere
}

/// Describes the accuracy at the true matches.
fn sentence_on_matches(v: &Verdicts) -> String {
    if v.called_reliable == 0 {
        return format!("no result of {} was called reliable.", v.results);
    }
    let reliable = format!(
        "{} of {} called reliable had an error below 1 % of the longer side",
        v.called_reliable_and_good,
        counted(v.called_reliable, "result")
    );
    if v.bad == 0 {
        return format!("{reliable}; no result had a larger one.");
    }
    let were = if v.bad_and_not_called_reliable == 1 { "was" } else { "were" };
    format!(
        "{reliable}; {} of {} with a larger one {were} not called reliable.",
        v.bad_and_not_called_reliable, v.bad
    )
}

/// Formats a number with its noun.
fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

/// Aligns the columns, with rules above the given rows.
fn layout(rows: &[Vec<String>], ruled: &[usize]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let widths: Vec<usize> =
        (0..columns).map(|c| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for (k, row) in rows.iter().enumerate() {
        if ruled.contains(&k) {
            let _ = writeln!(text, "{}", "-".repeat(widths.iter().sum::<usize>() + 2 * (widths.len() - 1)));
        }
        let cells = row.iter().zip(&widths).enumerate().map(|(c, (cell, width))| {
            // Text is left-aligned, numbers are right-aligned.
            if c < WORDS { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    text
}

/// Returns the name of a method with its preset.
fn label(method: &str, preset: Option<&str>) -> String {
    preset.map_or_else(|| method.to_owned(), |preset| format!("{method} {preset}"))
}

fn pair_row(name: &str, record: &Record, printed: bool) -> Vec<String> {
    let start = [
        name.to_owned(),
        label(&record.method, record.preset.as_deref()),
        record.matches.to_string(),
        record.trials.len().to_string(),
        pixels(record.median),
        range(record.median_interval),
    ];
    row(start, &record.figures, record.failures, printed)
}

fn overall_row(index: usize, overall: &Overall, printed: bool) -> Vec<String> {
    let start = [
        if index == 0 { format!("all {}", overall.pairs) } else { String::new() },
        label(&overall.method, overall.preset.as_deref()),
        String::new(),
        overall.trials.to_string(),
        pixels(overall.median_of_medians),
        range(overall.median_of_medians_interval),
    ];
    row(start, &overall.figures, overall.failures, printed)
}

/// Returns the cells of a row: `start` up to the interval of the median, the printed error, and the
/// other statistics.
fn row(start: [String; AFTER_INTERVAL], figures: &Figures, failures: usize, printed: bool) -> Vec<String> {
    let Shares { below_1_px, below_3_px, below_1_percent } = figures.shares;
    let mut row = Vec::from(start);
    row.extend(printed.then(|| pixels(figures.printed.unwrap_or(f64::NAN))));
    row.push(pixels(figures.mean));
    row.extend([below_1_px, below_3_px, below_1_percent].map(share));
    row.push(failures.to_string());
    row.extend([figures.median_seconds, figures.median_first_seconds].map(seconds));
    row
}

/// Formats an interval.
fn range(interval: Option<Interval>) -> String {
    interval.map_or_else(|| "-".to_owned(), |i| format!("{}–{}", pixels(i.low), pixels(i.high)))
}

/// Formats a fraction of the trials as per cent.
fn share(part: f64) -> String {
    if part.is_nan() { "-".to_owned() } else { format!("{:.0} %", 100.0 * part) }
}

/// Formats pixels: two decimals below 100 px, none above.
fn pixels(value: f64) -> String {
    match value {
        v if v.is_nan() => "-".to_owned(),
        v if v.is_infinite() => "inf".to_owned(),
        v if v < 100.0 => format!("{v:.2}"),
        v => format!("{v:.0}"),
    }
}

/// Formats seconds: two decimals, or five below a hundredth of a second.
fn seconds(value: f64) -> String {
    match value {
        v if v.is_nan() => "-".to_owned(),
        v if v < 0.01 => format!("{v:.5}"),
        v => format!("{v:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_precise_as_they_are_worth() {
        assert_eq!(
            [0.123, 12.0, 1234.5, f64::INFINITY, f64::NAN].map(pixels),
            ["0.12", "12.00", "1234", "inf", "-"]
        );
        assert_eq!([1.234, 0.000_031, f64::NAN].map(seconds), ["1.23", "0.00003", "-"]);
    }

    #[test]
    fn verdicts_name_no_share_of_nothing() {
        let verdicts = |called_reliable_and_good, called_reliable, bad_and_not_called_reliable, bad| {
            let results = called_reliable_and_good + bad;
            verdict_sentence(&Verdicts {
                results,
                called_reliable,
                called_reliable_and_good,
                bad,
                bad_and_not_called_reliable,
                ..Verdicts::default()
            })
        };
        assert_eq!(verdicts(0, 0, 3, 3), "no result of 3 was called reliable.");
        assert_eq!(
            verdicts(1, 1, 0, 0),
            "1 of 1 result called reliable had an error below 1 % of the longer side; no result had a larger one."
        );
        assert_eq!(
            verdicts(5, 6, 1, 2),
            "5 of 6 results called reliable had an error below 1 % of the longer side; 1 of 2 with a larger one was not \
             called reliable."
        );
        let everywhere = Verdicts {
            results: 3,
            called_reliable: 2,
            called_reliable_and_good: 2,
            good_everywhere: 2,
            good_everywhere_and_called_reliable: 1,
            ..Verdicts::default()
        };
        assert_eq!(
            verdict_sentence(&everywhere),
            "2 of 2 results called reliable had an error below 1 % of the longer side; no result had a larger one. Of the 2 \
             whose lines are equally close to the true ones over the whole images, 1 was called reliable."
        );
    }

    #[test]
    fn intervals_show_where_failures_reach() {
        assert_eq!(range(Some(Interval { low: 0.123, high: f64::INFINITY })), "0.12–inf");
        assert_eq!(range(None), "-");
    }
}
