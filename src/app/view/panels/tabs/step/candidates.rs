//! The table of the candidates: line pairs through a click that are each other's best match.

use egui::Ui;

use super::super::super::table::{Column, RowLook, Table};
use super::super::empty;
use super::{NO_PENCILS, has_no_pencils, touch};
use crate::app::model::focus::Replayed;
use crate::app::model::{Command, LineSource, Model, Target, pair_name};
use crate::estimate::ComparedPencils;

/// Number of candidates listed for each click. The pencils mark as many.
const LISTED: usize = 80;

/// A candidate in the table.
struct Listed {
    through: String,
    rank: usize,
    cost: f64,
    /// Directions of both lines, radians.
    angles: [f64; 2],
    target: Option<Target>,
    source: Option<LineSource>,
}

/// Returns the candidates through the clicks, or those among all lines of sequences.
fn all_listed(model: &Model) -> Vec<Listed> {
    if let Some(record) =
        model.record().filter(|record| record.recordings.is_some() && !record.is_by_clicks())
    {
        let listed = record.line_pairs.iter().take(LISTED).enumerate();
        return listed
            .map(|(rank, own)| Listed {
                through: "all lines".to_owned(),
                rank,
                cost: own.cost,
                angles: own.lines.map(|line| line.angle()),
                target: Some(Target::Replayed(Replayed::Candidate(rank))),
                source: None,
            })
            .collect();
    }
    let pencils = model.open.computation.pencils().into_iter().flatten().enumerate();
    let of = |(number, pencils): (usize, &ComparedPencils)| {
        let pair = model.document.pair_of_pencils(number, &pencils.click);
        let listed = pencils.candidates.iter().take(LISTED).enumerate();
        let listed = listed.map(|(rank, candidate)| Listed {
            through: pair.map_or_else(|| format!("match {}", number + 1), pair_name),
            rank,
            cost: f64::from(candidate.cost),
            angles: candidate.angles,
            target: pencils.cell(candidate).map(|[row, column]| Target::Cell { pair: number, row, column }),
            source: pair.map(|pair| LineSource::Pencil { pair, angles: candidate.angles }),
        });
        listed.collect::<Vec<_>>()
    };
    pencils.map(|(number, pencils)| (number, &**pencils)).flat_map(of).collect()
}

/// Shows the table. A row under the cursor shows its two lines in the images. A click pauses the replay, and pins
/// lines through a click.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let rows = &all_listed(model)[..];
    if rows.is_empty() {
        let text = "Candidate line pairs appear here during the estimate.";
        empty(ui, if has_no_pencils(model) { NO_PENCILS } else { text });
        return;
    }
    let name = |row: usize| rows[row].through.clone();
    let target = |row: usize| rows[row].target;
    let angle = |side: usize| move |row: usize| rows[row].angles[side].to_degrees();
    let degrees = |angle: f64| format!("{angle:.1}°");
    let columns = [
        Column::words(
            "Through",
            66.0,
            "The click through which both lines pass, if they were sought there.",
            name,
        ),
        Column::figures(
            "Rank",
            52.0,
            "Rank among the candidates of the click, cheapest first.",
            |row| (rows[row].rank + 1) as f64,
            |rank| format!("{rank:.0}"),
        ),
        Column::figures(
            "Cost",
            66.0,
            "Matching cost of the two lines. Lower is better.",
            |row| rows[row].cost,
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
        row_name: &|row| format!("Candidate {} through {}", rows[row].rank + 1, name(row)),
        about: &|_| None,
        look: &|row| RowLook {
            chosen: false,
            lit: target(row).is_some() && target(row) == model.open.focus.hovered(),
        },
    }
    .show(ui);
    if let Some(target) = touched.hovered.and_then(target) {
        touch(target, touched.clicked.is_some(), model, commands);
    }
    if let Some(row) = touched.clicked
        && let Some(source) = rows[row].source
    {
        commands.push(Command::Pin(source));
    }
}
