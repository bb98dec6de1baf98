//! The table of the hypotheses with their figures. Choosing one shows it in the whole window.

use egui::Ui;

use super::super::super::table::{Column, RowLook, Table};
use super::super::empty;
use crate::app::model::verdict::{
    HypothesisFigure, HypothesisScales, Standing, epipole_text, line_score_text,
};
use crate::app::model::{Command, MethodStep, Model, Target};
use crate::estimate::{Estimate, LineScore};
use crate::geometry::{Frame, HomogeneousPoint, finite_point};

const COLUMNS: [Column; 7] = [
    Column::figures(
        "Rank",
        74.0,
        "Rank before refinement, best first. The rival is the best clearly different geometry. Hypotheses \
         marked ≈ agree with the result. Point at a row for details.",
    ),
    Column::figures(
        "Support",
        74.0,
        "Image corners that find a match along their epipolar line, weighted by similarity. Higher is better; \
         compare rows.",
    ),
    Column::figures(
        "Line cost",
        84.0,
        "How unlike corresponding lines are, over both images. Lower is better. The preset Robust gives the \
         cost relative to mismatched lines, As published in grey² per sample.",
    ),
    Column::figures(
        "Round trip",
        100.0,
        "Distance, px, between a line and its image after the maps H (to the other image) and G (back). A small \
         distance means that both directions agree. A good result may have a large distance, and a wrong \
         result a small one.",
    ),
    Column::figures(
        "Stretch",
        72.0,
        "Stretch κ of the line map H (left to right) divided by that of G (right to left). 1 means that \
         both directions agree.",
    ),
    Column::figures(
        "Left epipole",
        130.0,
        "Position of the other camera in the left image, px, or its direction if far away. Sorted by the \
         distance from the image centre.",
    ),
    Column::figures(
        "Right epipole",
        130.0,
        "Position of the other camera in the right image, px, or its direction if far away. Sorted by the \
         distance from the image centre.",
    ),
];

/// Width below which the right epipole is left out, screen points: figures would run into each other.
const ROOM_FOR_ALL: f32 = 400.0;

/// Why the result may have worse figures than a hypothesis.
const RESULT: &str = "Hypotheses are ranked by their support in reduced images. The result is fitted to patches at \
                      full resolution, so a hypothesis may have more support.";

/// Columns that belong to a step.
fn columns_of(step: MethodStep) -> &'static [usize] {
    if step == MethodStep::RoundTrip { &[0, 3, 4, 5, 6] } else { &[0, 1, 2, 5, 6] }
}

/// Shows the table of the hypotheses with the figures of a step. The margin follows from a pair of
/// rows; pointing at a row explains it.
pub fn show(ui: &mut Ui, step: MethodStep, model: &Model, commands: &mut Vec<Command>) {
    let listed = Listed::new(model);
    if listed.rows() == 0 {
        empty(ui, "Candidate geometries appear here during the estimate.");
        return;
    }
    let mut of = columns_of(step);
    if ui.available_width() < ROOM_FOR_ALL {
        of = &of[..of.len() - 1];
    }
    let columns: Vec<Column> = of.iter().map(|column| COLUMNS[*column].clone()).collect();
    let frames = model.document.frames();
    let chosen = model.shown().and_then(|shown| shown.hypothesis).map(|(number, _)| number);
    let lit = match model.open.focus.hovered() {
        Some(Target::Hypothesis(number)) => Some(number),
        _ => None,
    };
    let number = |row: usize| listed.number(row);
    let line_score = model.document.parameters.validation.line_score;
    let searched = model.open.computation.searched();
    let scales = searched.map(|searched| HypothesisScales::new(searched, line_score));
    let standing = |row: usize| Standing::of(listed.result?, number(row)?);
    let touched = Table {
        name: if step == MethodStep::RoundTrip { "round trips" } else { "validation" },
        columns: &columns,
        rows: listed.rows(),
        revision: model.open.computation.revision(),
        row_name: &|row| {
            let mark = if standing(row) == Some(Standing::Rival) { ", the rival" } else { "" };
            number(row).map_or("Result".to_owned(), |number| format!("Hypothesis {}{mark}", number + 1))
        },
        key: &|row, column| key(listed.hypothesis(row), row, of[column], frames),
        text: &|row, column| match (of[column], number(row)) {
            (0, None) => "Result".to_owned(),
            (0, Some(number)) => match standing(row) {
                Some(Standing::Near) => format!("≈ {}", number + 1),
                Some(Standing::Rival) => format!("rival   {}", number + 1),
                Some(Standing::Behind) | None => (number + 1).to_string(),
            },
            (column, _) => text(listed.hypothesis(row), column, line_score),
        },
        gauge: &|row, column| {
            let figure = figure(of[column])?;
            let (scales, value) = (scales.as_ref()?, figure.of(listed.hypothesis(row)));
            if number(row).is_some() { scales.gauge(figure, value) } else { scales.of_result(figure, value) }
        },
        about: &|row| match number(row) {
            Some(number) => Some(Standing::of(listed.result?, number)?.in_words(listed.result?, number)),
            None => Some(RESULT.to_owned()),
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

fn key(hypothesis: &Estimate, row: usize, column: usize, frames: Option<[Frame; 2]>) -> f64 {
    let away = |epipole: &HomogeneousPoint, side: usize| {
        let centre = frames.map_or(crate::geometry::Point::origin(), |frames| frames[side].centre());
        finite_point(epipole).map_or(f64::INFINITY, |point| (point - centre).norm())
    };
    if let Some(figure) = figure(column) {
        return figure.of(hypothesis);
    }
    match column {
        0 => row as f64,
        5 => away(&hypothesis.geometry.epipole1(), 0),
        _ => away(&hypothesis.geometry.epipole2(), 1),
    }
}

fn figure(column: usize) -> Option<HypothesisFigure> {
    match column {
        1 => Some(HypothesisFigure::Support),
        2 => Some(HypothesisFigure::LineScore),
        3 => Some(HypothesisFigure::RoundTrip),
        4 => Some(HypothesisFigure::ThereBack),
        _ => None,
    }
}

fn text(hypothesis: &Estimate, column: usize, line_score: LineScore) -> String {
    let decimals = |figure: HypothesisFigure, decimals: usize| {
        let value = figure.of(hypothesis);
        if value.is_finite() { format!("{value:.decimals$}") } else { String::new() }
    };
    match column {
        1 => decimals(HypothesisFigure::Support, 1),
        2 => hypothesis.line_score().map_or(String::new(), |score| line_score_text(line_score, score)),
        3 => decimals(HypothesisFigure::RoundTrip, 2),
        4 => decimals(HypothesisFigure::ThereBack, 3),
        5 => epipole_text(&hypothesis.geometry.epipole1(), None),
        _ => epipole_text(&hypothesis.geometry.epipole2(), None),
    }
}
