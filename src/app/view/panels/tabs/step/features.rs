//! Chart of the matches of features: how many are tentative, distinctive, and on lines of the result.

use egui::{Ui, vec2};

use super::super::empty;
use super::race::{Bar, bars};
use crate::app::model::Model;
use crate::app::model::verdict::Tone;
use crate::app::view::theme;
use crate::estimate::Reason;

/// Height of the sentences below the chart of different scenes, screen points.
const HELP: f32 = 64.0;

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
    let rows =
        rows.into_iter().take(known).map(|(name, count, opacity)| (name, count, count as f64 / all, opacity));
    show_rows(ui, rows);
}

/// Shows how many matches agree if the pictures seem to show different scenes, beside what chance gives. Returns
/// whether they do.
pub fn show_different_scenes(ui: &mut Ui, model: &Model) -> bool {
    if model.tone() != Tone::Apart || model.shows_another() {
        return false;
    }
    let reasons = model.result().and_then(|estimate| estimate.assessment.trust.as_ref());
    let counts = reasons.and_then(|trust| {
        trust.reasons.iter().find_map(|reason| match *reason {
            Reason::DifferentScenes { agreeing, by_chance, matches } => Some([matches, by_chance, agreeing]),
            _ => None,
        })
    });
    let Some([matches, by_chance, agreeing]) = counts else { return false };
    ui.label("Matches that agree on one geometry");
    let share = |count: usize| count as f64 / matches.max(1) as f64;
    let height = (ui.available_height() - HELP).max(54.0);
    ui.allocate_ui(vec2(ui.available_width(), height), |ui| {
        show_rows(
            ui,
            [
                ("distinctive", matches, 1.0, 0.35),
                ("agree by chance", by_chance, share(by_chance), 0.35),
                ("agree here", agreeing, share(agreeing), 1.0),
            ],
        );
    });
    ui.weak("By chance: of as many matches between unrelated pictures, no more agree in 99 of 100 cases.");
    ui.weak(
        "What helps: two pictures of the same objects, taken from two places. If these do show one scene, click two \
         pairs. Clicks are searched even where no features match.",
    );
    true
}

/// Shows counts as bars: name, count, share of the longest bar, opacity.
fn show_rows<'a>(ui: &mut Ui, rows: impl IntoIterator<Item = (&'a str, usize, f64, f32)>) {
    let bar = |(row, (name, count, share, opacity)): (usize, (&str, usize, f64, f32))| Bar {
        name: name.to_owned(),
        value: count.to_string(),
        share,
        row: row as f64,
        color: theme::UNCHECKED.gamma_multiply(opacity),
    };
    bars(ui, "matches of features", &rows.into_iter().enumerate().map(bar).collect::<Vec<_>>());
}
