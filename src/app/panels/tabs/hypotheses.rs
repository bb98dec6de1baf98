//! The hypotheses of the estimate with their figures; choosing one makes the whole window show it.

use egui::Ui;

use super::super::command_button;
use super::super::table::{Column, Look, Table};
use super::{Tab, empty};
use crate::app::command::Command;
use crate::app::focus::Target;
use crate::app::scene::Scene;
use crate::app::verdict::epipole_text;
use crate::estimate::{Construction, Estimate};
use crate::geometry::{Frame, HomogeneousPoint, finite_point};

/// Registered in [`super::TABS`].
pub const TAB: Tab = Tab {
    title: "Hypotheses",
    tooltip: "The geometries that came nearest, with the figures they were judged by.",
    inspects: false,
    compares: false,
    rectifies: false,
    tools,
    show,
};

const COLUMNS: [Column; 7] = [
    Column {
        title: "Rank",
        tooltip: "Place in the list, best first, before refinement; the result is what refinement made of the best.",
        width: 64.0,
        is_text: false,
    },
    Column {
        title: "Support",
        tooltip: "How strongly matching image patches agree with it; higher is better. Empty where patches were \
                  not compared.",
        width: 88.0,
        is_text: false,
    },
    Column {
        title: "Line score",
        tooltip: "How unlike its corresponding lines are over both images; lower is better.",
        width: 100.0,
        is_text: false,
    },
    Column {
        title: "Round trip, px",
        tooltip: "Mean area between a line and where H and G bring it, over the image width; small means that both \
                  directions agree.",
        width: 126.0,
        is_text: false,
    },
    Column {
        title: "κ of H / κ of G",
        tooltip: "Ratio of the maps found in the two directions; 1 means that they agree.",
        width: 126.0,
        is_text: false,
    },
    Column {
        title: "Left epipole",
        tooltip: "Where the left image sees the other camera, px, or the direction if it is far away. Sorted by the \
                  distance from the middle.",
        width: 200.0,
        is_text: false,
    },
    Column {
        title: "Right epipole",
        tooltip: "Where the right image sees the other camera, px, or the direction if it is far away. Sorted by the \
                  distance from the middle.",
        width: 200.0,
        is_text: false,
    },
];

fn tools(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let chosen = scene.shows_another();
    command_button(ui, Command::ChooseHypothesis(None), chosen, commands);
}

fn show(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let listed = Listed::new(scene);
    if listed.rows() == 0 {
        empty(
            ui,
            "The geometries that the estimate considered appear here, once there are enough point pairs. Click one to \
             see it in both images.",
        );
        return;
    }
    let frames = scene.document.pictures.as_ref().map(|pictures| pictures.each_ref().map(|p| p.frame));
    let chosen = scene.shown().and_then(|shown| shown.hypothesis).map(|(number, _)| number);
    let lit = match scene.focus.hovered() {
        Some(Target::Hypothesis(number)) => Some(number),
        _ => None,
    };
    let number = |row: usize| listed.number(row);
    let touched = Table {
        name: "hypotheses",
        columns: &COLUMNS,
        rows: listed.rows(),
        revision: scene.computation.revision(),
        row_name: &|row| {
            number(row).map_or("Result".to_owned(), |number| format!("Hypothesis {}", number + 1))
        },
        key: &|row, column| key(listed.hypothesis(row), row, column, frames),
        text: &|row, column| match (column, number(row)) {
            (0, None) => "Result".to_owned(),
            (0, Some(number)) => (number + 1).to_string(),
            _ => text(listed.hypothesis(row), column),
        },
        look: &|row| Look { chosen: chosen == number(row), lit: number(row).is_some() && lit == number(row) },
        toggle: &|_| None,
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

/// The rows: the result, once it is final, then the hypotheses by rank.
struct Listed<'a> {
    result: Option<&'a Estimate>,
    hypotheses: &'a [Estimate],
}

impl<'a> Listed<'a> {
    fn new(scene: &Scene<'a>) -> Self {
        let estimate = scene.computation.searched();
        Self {
            result: estimate.filter(|estimate| estimate.assessment.trust.is_some()),
            hypotheses: estimate.map_or(&[], |estimate| estimate.hypotheses()),
        }
    }

    fn rows(&self) -> usize {
        self.hypotheses.len() + usize::from(self.result.is_some())
    }

    /// The number of the hypothesis of a row; `None` for the result.
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
    match column {
        0 => row as f64,
        1 => hypothesis.support_score().unwrap_or(f64::NAN),
        2 => hypothesis.line_score().unwrap_or(f64::NAN),
        3 => round_trip_area(hypothesis),
        4 => ratio(hypothesis),
        5 => away(&hypothesis.geometry.epipole1(), 0),
        _ => away(&hypothesis.geometry.epipole2(), 1),
    }
}

fn ratio(hypothesis: &Estimate) -> f64 {
    let construction = hypothesis.assessment.lines.as_ref().map(|lines| &lines.construction);
    let backward = construction.and_then(Construction::kappa_line1_from_line2);
    construction
        .zip(backward)
        .map_or(f64::NAN, |(construction, backward)| construction.kappa_line2_from_line1() / backward)
}

fn round_trip_area(hypothesis: &Estimate) -> f64 {
    hypothesis.assessment.lines.as_ref().and_then(|lines| lines.round_trip_area).unwrap_or(f64::NAN)
}

fn text(hypothesis: &Estimate, column: usize) -> String {
    let figure = |value: f64, decimals: usize| {
        if value.is_finite() { format!("{value:.decimals$}") } else { String::new() }
    };
    match column {
        1 => figure(hypothesis.support_score().unwrap_or(f64::NAN), 1),
        2 => figure(hypothesis.line_score().unwrap_or(f64::NAN), 3),
        3 => figure(round_trip_area(hypothesis), 2),
        4 => figure(ratio(hypothesis), 3),
        5 => epipole_text(&hypothesis.geometry.epipole1(), None),
        _ => epipole_text(&hypothesis.geometry.epipole2(), None),
    }
}
