//! The verdict over a stored table of evidence: false trust and doubt, in seconds.
//!
//! `lab/trust.py table` makes `table.jsonl` of results with known truth. Its first line has the recorded counts. Each
//! other line has the figures of a result, whether its lines are right near the matches, and whether there is parallax.

use std::{fs, path::Path};

use serde::Deserialize;

use super::{Case, Trust, Verdict};

#[derive(Deserialize)]
struct Recorded {
    /// Number of results whose lines are right, with parallax, and of those called reliable.
    right: usize,
    reliable: usize,
    /// Number of unrelated pairs, and of those named different scenes.
    unrelated: usize,
    named: usize,
    /// Brier score of the probability.
    brier: f64,
}

#[derive(Deserialize)]
struct Row {
    /// Set, pair, clicks and seed.
    key: String,
    /// Whether the lines are right near the matches. `None` if that is not known.
    lines: Option<bool>,
    /// Whether the cameras are apart, and some matches off every plane.
    parallax: bool,
    case: Case,
}

fn table() -> (Recorded, Vec<Row>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/estimate/verdict/trust/table.jsonl");
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let recorded = serde_json::from_str(lines.next().unwrap()).unwrap();
    (recorded, lines.map(|line| serde_json::from_str(line).expect("a row of the table")).collect())
}

#[test]
fn false_trust_and_doubt_are_as_recorded() {
    let (recorded, rows) = table();
    let (mut wrong, mut claimed) = (Vec::new(), Vec::new());
    let (mut right, mut reliable) = (0, 0);
    for Row { key, lines, parallax, case } in rows {
        let trust = Trust::judge(&case);
        let is_reliable = trust.verdict == Verdict::Reliable;
        if is_reliable && (lines == Some(false) || !parallax) {
            wrong.push(key.clone());
        }
        if !parallax && trust.determines_the_epipole() {
            claimed.push(key);
        }
        let is_right = lines == Some(true) && parallax;
        right += usize::from(is_right);
        reliable += usize::from(is_right && is_reliable);
    }
    assert!(wrong.is_empty(), "reliable though wrong: {wrong:?}");
    assert!(claimed.is_empty(), "with an epipole though without parallax: {claimed:?}");
    assert_eq!((reliable, right), (recorded.reliable, recorded.right), "reliable ones of the right results");
}

#[test]
fn the_probability_is_as_good_as_recorded() {
    let (recorded, rows) = table();
    let known = rows.into_iter().filter_map(|row| Some((row.case.lines?.probability(), row.lines?)));
    let errors: Vec<f64> = known.map(|(p, is_right)| (p - f64::from(u8::from(is_right))).powi(2)).collect();
    let brier = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!((brier - recorded.brier).abs() < 5e-4, "Brier score {brier:.4}, recorded {}", recorded.brier);
}

#[test]
fn unrelated_pictures_are_named_and_no_right_result_is() {
    let (recorded, rows) = table();
    let (mut named, mut unrelated) = (0, 0);
    for Row { key, lines, case, .. } in rows {
        let is_named = Trust::judge(&case).verdict == Verdict::DifferentScenes;
        assert!(!is_named || lines != Some(true), "{key} is right");
        if key.starts_with("unrelated/") {
            named += usize::from(is_named);
            unrelated += 1;
        }
    }
    assert_eq!((named, unrelated), (recorded.named, recorded.unrelated));
}
