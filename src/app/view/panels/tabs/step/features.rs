//! Chart of the matches of features: how many are tentative, distinctive, and on lines of the result.

use egui::Ui;

use super::super::empty;
use super::race::{Bar, bars};
use crate::app::model::Model;
use crate::app::view::theme;

pub fn show(ui: &mut Ui, model: &Model) {
    let Some(record) = model.record().filter(|record| !record.matches.is_empty()) else {
        let text = if model.has_record() {
            "This search needed no matches of features."
        } else {
            "Matches of features appear here during a search."
        };
        empty(ui, text);
        return;
    };
    let [distinctive, agree] = record.matches_that_count();
    let all = record.tentative.max(record.matches.len()).max(1) as f64;
    let rows = [
        ("tentative", record.tentative, 0.35),
        ("distinctive", distinctive, 0.65),
        ("on lines of the result", agree, 1.0),
    ];
    let known = if record.has_result() { 3 } else { 2 };
    let bar = |(row, (name, count, opacity)): (usize, (&str, usize, f32))| Bar {
        name: name.to_owned(),
        value: count.to_string(),
        share: count as f64 / all,
        row: row as f64,
        color: theme::HYPOTHESIS.gamma_multiply(opacity),
    };
    bars(ui, "matches of features", &rows.into_iter().take(known).enumerate().map(bar).collect::<Vec<_>>());
}
