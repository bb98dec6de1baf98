//! The table of the hypotheses with their figures. Choosing one shows it in the whole window.

use egui::{Label, RichText, Ui};

use super::super::super::table::{Column, RowLook, Table};
use super::super::empty;
use crate::app::model::verdict::{
    HypothesisFigure, Standing, epipole_text, line_score_text, short_epipole_text,
};
use crate::app::model::{Command, Model, Side, Target};
use crate::app::view::theme;
use crate::estimate::Estimate;
use crate::geometry::{Point, finite_point};
use crate::presentation::origin_in_words;

/// Width below which the epipoles are rounded and the last columns are left out, screen points. The tooltips of the
/// rows have both epipoles.
const ROOM_FOR_ALL: f32 = 400.0;

/// Why the result may have less support than a hypothesis.
const RESULT: &str = "Support is counted in reduced images and ranks the hypotheses. The best ones are then refined at full \
                      resolution, and the one with the most and best matches there is the result, unless clicks contradict it.";

/// What the sign of a hypothesis near the result means.
const NEAR: &str = "≈: near the result at half of the matches or more; the epipole may differ.";

/// Shows the table of the hypotheses. The margin follows from a pair of rows; pointing at a row explains it.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let listed = Listed::new(model);
    if listed.rows() == 0 {
        empty(ui, "Candidate geometries appear here during the estimate.");
        return;
    }
    let chosen = model.shown().and_then(|shown| shown.hypothesis).map(|(number, _)| number);
    let lit = match model.open.focus.hovered() {
        Some(Target::Hypothesis(number)) => Some(number),
        _ => None,
    };
    let number = |row: usize| listed.number(row);
    let line_score = model.document.parameters.validation.line_score;
    let standing = |row: usize| Standing::of(listed.result?, number(row)?);
    let listed = &listed;
    let support = |row: usize| listed.hypothesis(row).support_score();
    let own = support(0).filter(|_| listed.result.is_some());
    let is_beaten = own.is_some() && (1..listed.rows()).any(|row| support(row) > own);
    let has_near = (0..listed.rows()).any(|row| standing(row) == Some(Standing::Near));
    let notes = [(is_beaten, "Support ranks before refinement, the result won after it."), (has_near, NEAR)];
    let notes: Vec<&str> = notes.into_iter().filter_map(|(holds, note)| holds.then_some(note)).collect();
    if !notes.is_empty() {
        let text = RichText::new(notes.join(" ")).size(theme::CAPTION).weak();
        ui.add(Label::new(text).wrap()).on_hover_text(RESULT);
    }
    let rank = Column::figures(
        "Rank",
        74.0,
        "Rank before refinement, best first. The rival is the best clearly different geometry. Geometries marked ≈ may \
         have other epipoles than the result.",
        |row| row as f64,
        |_| String::new(),
    );
    let rank = rank.written(|row| match (number(row), standing(row)) {
        (None, _) => "Result".to_owned(),
        (Some(number), Some(Standing::Near)) => format!("≈ {}", number + 1),
        (Some(number), Some(Standing::Rival)) => format!("rival   {}", number + 1),
        (Some(number), _) => (number + 1).to_string(),
    });
    let figure = |title, width, tooltip, figure: HypothesisFigure, decimals: usize| {
        let text = move |value: f64| match figure {
            HypothesisFigure::LineScore => line_score_text(line_score, value),
            _ => format!("{value:.decimals$}"),
        };
        let value = move |row: usize| figure.of(listed.hypothesis(row));
        Column::figures(title, width, tooltip, value, text)
    };
    let is_narrow = ui.available_width() < ROOM_FOR_ALL;
    let epipoles = Side::BOTH.map(|side| epipole(listed, model, side, is_narrow));
    let mut columns: Vec<Column> =
        std::iter::once(rank).chain(known_figures(listed, figure)).chain(epipoles).collect();
    while is_narrow && columns.iter().map(Column::least_width).sum::<f32>() > ui.available_width() {
        columns.pop();
    }
    let is_open = model.epipole_is_open();
    let tells_epipoles = |row: usize| is_narrow && (number(row).is_some() || !is_open);
    let touched = Table {
        name: "hypotheses",
        columns: &columns,
        rows: listed.rows(),
        revision: model.open.computation.revision(),
        list: (model.open.computation.run(), 0),
        row_name: &|row| {
            let mark = if standing(row) == Some(Standing::Rival) { ", the rival" } else { "" };
            number(row).map_or("Result".to_owned(), |number| format!("Hypothesis {}{mark}", number + 1))
        },
        about: &|row| {
            let standing = match number(row) {
                Some(number) => listed.result.and_then(|result| {
                    Standing::of(result, number).map(|standing| standing.in_words(result, number))
                }),
                None => Some(RESULT.to_owned()),
            };
            let origin = listed.hypothesis(row).origin;
            let origin = origin.map(|origin| format!("Proposed by {}", origin_in_words(&origin)));
            let epipoles = tells_epipoles(row).then(|| both_epipoles(listed, row));
            let lines = standing.into_iter().chain(origin).chain(epipoles);
            lines.reduce(|above, below| format!("{above}\n{below}"))
        },
        look: &|row| RowLook {
            chosen: chosen == number(row),
            lit: number(row).is_some() && lit == number(row),
        },
    }
    .show(ui);
    if let Some(number) = touched.hovered.and_then(number) {
        commands.push(Command::PointAt(Target::Hypothesis(number)));
    }
    if let Some(row) = touched.clicked {
        let clicked = number(row);
        commands.push(Command::ChooseHypothesis(clicked.filter(|_| clicked != chosen)));
    }
}

/// Returns the columns with the figures that the search has.
fn known_figures<'a>(
    listed: &Listed,
    figure: impl Fn(&'static str, f32, &'static str, HypothesisFigure, usize) -> Column<'a>,
) -> impl Iterator<Item = Column<'a>> {
    let columns = [
        ("Support", 74.0, "Higher is better.", HypothesisFigure::Support, 1),
        (
            "Line cost",
            84.0,
            "How unlike corresponding lines are, over both images. Lower is better. The preset Robust gives the \
             cost relative to mismatched lines, As published in grey² per sample.",
            HypothesisFigure::LineScore,
            1,
        ),
        (
            "Round trip",
            100.0,
            "In px. A small distance means that both directions agree. A good result may have a large distance, and a \
             wrong result a small one.",
            HypothesisFigure::RoundTrip,
            2,
        ),
    ];
    let is_known = |figure: HypothesisFigure| {
        (0..listed.rows()).any(|row| figure.of(listed.hypothesis(row)).is_finite())
    };
    let known = columns.map(|(title, width, tooltip, kind, decimals)| {
        is_known(kind).then(|| figure(title, width, tooltip, kind, decimals))
    });
    known.into_iter().flatten()
}

/// Returns the column with the epipoles of one image.
fn epipole<'a>(listed: &'a Listed, model: &Model, side: Side, is_narrow: bool) -> Column<'a> {
    let (title, tooltip) = match side {
        Side::Left => (
            "Left epipole",
            "Position of the other camera in the left image, px, or its direction if far away. Sorted by the \
             distance from the image centre.",
        ),
        Side::Right => (
            "Right epipole",
            "Position of the other camera in the right image, px, or its direction if far away. Sorted by the \
             distance from the image centre.",
        ),
    };
    let epipole = move |row: usize| side.epipole(listed.hypothesis(row).fundamental());
    let centre = model.document.frame(side).map_or(Point::origin(), |frame| frame.centre());
    let away =
        move |row: usize| finite_point(&epipole(row)).map_or(f64::INFINITY, |point| (point - centre).norm());
    let is_open = model.epipole_is_open();
    let text = move |row: usize| match listed.number(row) {
        None if is_open => "not determined".to_owned(),
        _ if is_narrow => short_epipole_text(&epipole(row)),
        _ => epipole_text(&epipole(row)),
    };
    Column::figures(title, 130.0, tooltip, away, |_| String::new()).written(text)
}

/// Describes the epipoles of a row, one line each.
fn both_epipoles(listed: &Listed, row: usize) -> String {
    let [left, right] =
        Side::BOTH.map(|side| epipole_text(&side.epipole(listed.hypothesis(row).fundamental())));
    format!("Left epipole, px: {left}\nRight epipole, px: {right}")
}

/// Rows of the table: the final result, then the hypotheses by rank.
struct Listed<'a> {
    result: Option<&'a Estimate>,
    hypotheses: &'a [Estimate],
}

impl<'a> Listed<'a> {
    fn new(model: &'a Model) -> Self {
        let estimate = model.open.computation.searched();
        Self {
            result: estimate.filter(|estimate| estimate.assessment.trust.is_some()),
            hypotheses: estimate.map_or(&[], |estimate| estimate.hypotheses()),
        }
    }

    fn rows(&self) -> usize {
        self.hypotheses.len() + usize::from(self.result.is_some())
    }

    /// Returns the number of the hypothesis in a row; `None` for the result.
    fn number(&self, row: usize) -> Option<usize> {
        row.checked_sub(usize::from(self.result.is_some()))
    }

    fn hypothesis(&self, row: usize) -> &'a Estimate {
        match (self.number(row), self.result) {
            (None, Some(result)) => result,
            (number, _) => &self.hypotheses[number.unwrap_or(0)],
        }
    }
}
