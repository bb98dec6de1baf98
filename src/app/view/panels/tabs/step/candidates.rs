//! The table of the candidates: line pairs through a click that are each other's best match.

use egui::Ui;

use super::super::super::table::{Column, RowLook, Table};
use super::super::empty;
use super::{NO_PENCILS, has_no_pencils};
use crate::app::model::{Command, LineSource, Model, Target, pair_name};
use crate::estimate::{Candidate, ComparedPencils};

/// Number of candidates listed for each click. The pencils mark as many.
const LISTED: usize = 80;

/// Shows the table. A row under the cursor shows its two lines in the images; a click pins them.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let pencils = model.open.computation.pencils().into_iter().flatten().enumerate();
    let of =
        |(number, pencils)| listed(pencils).map(move |(rank, candidate)| (number, pencils, rank, candidate));
    let rows: Vec<(usize, &ComparedPencils, usize, &Candidate)> =
        pencils.map(|(number, pencils)| (number, &**pencils)).flat_map(of).collect();
    if rows.is_empty() {
        let text = "Candidate line pairs appear here during the estimate.";
        empty(ui, if has_no_pencils(model) { NO_PENCILS } else { text });
        return;
    }
    let rows = &rows[..];
    let pair = |row: usize| model.document.pair_of_pencils(rows[row].0, &rows[row].1.click);
    let name = |row: usize| pair(row).map_or_else(|| format!("match {}", rows[row].0 + 1), pair_name);
    let target = |row: usize| {
        let (number, pencils, _, candidate) = rows[row];
        let [row, column] = pencils.cell(candidate)?;
        Some(Target::Cell { pair: number, row, column })
    };
    let angle = |side: usize| move |row: usize| rows[row].3.angles[side].to_degrees();
    let degrees = |angle: f64| format!("{angle:.1}°");
    let columns = [
        Column::words("Through", 66.0, "The click through which both lines pass.", name),
        Column::figures(
            "Rank",
            52.0,
            "Rank among the candidates of the click, cheapest first.",
            |row| (rows[row].2 + 1) as f64,
            |rank| format!("{rank:.0}"),
        ),
        Column::figures(
            "Cost",
            66.0,
            "Matching cost of the two lines. Lower is better.",
            |row| f64::from(rows[row].3.cost),
            |cost| format!("{cost:.3}"),
        ),
        Column::figures(
            "Left line",
            78.0,
            "Direction of the line in the left image, degrees, clockwise from the x axis.",
            angle(0),
            degrees,
        ),
        Column::figures(
            "Right line",
            78.0,
            "Direction of the line in the right image, degrees, clockwise from the x axis. Beyond 180°, it \
             corresponds to the left line in the opposite direction.",
            angle(1),
            degrees,
        ),
    ];
    let touched = Table {
        name: "candidates",
        columns: &columns,
        rows: rows.len(),
        revision: model.open.computation.pencils_revision(),
        list: (model.open.computation.run(), 0),
        row_name: &|row| format!("Candidate {} through {}", rows[row].2 + 1, name(row)),
        about: &|_| None,
        look: &|row| RowLook {
            chosen: false,
            lit: target(row).is_some() && target(row) == model.open.focus.hovered(),
        },
    }
    .show(ui);
    if let Some(target) = touched.hovered.and_then(target) {
        commands.push(Command::PointAt(target));
    }
    if let Some(row) = touched.clicked
        && let Some(pair) = pair(row)
    {
        commands.push(Command::Pin(LineSource::Pencil { pair, angles: rows[row].3.angles }));
    }
}

fn listed(pencils: &ComparedPencils) -> impl Iterator<Item = (usize, &Candidate)> {
    pencils.candidates.iter().take(LISTED).enumerate()
}
