//! The tab of the distances of points from the result, from other methods, and from the ground
//! truth.

use egui::{Rect, ScrollArea, Sense, Ui, UiBuilder, vec2};

use super::super::table::{Column, RowLook, Table};
use super::{Tab, empty};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::comparison::{Comparison, Contestant, Measure, PointSet, Subject};
use crate::app::model::document::{PointRef, Role, Side, pair_name};
use crate::app::model::focus::{LineSource, Target};
use crate::app::model::ids::TabId;
use crate::app::model::verdict::Gauge;
use crate::app::view::panels::truth_button;
use crate::comparison::Spread;
use crate::io::TruthOrigin;

/// Registered in [`super::TABS`].
pub const TAB: Tab = Tab { id: TabId::Residuals, tools, show };

/// Shows the truth buttons, unless the chooser of a folder with ground truth has them.
fn tools(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    if model.folder().is_none_or(|(folder, _)| folder.known().is_none()) {
        truth_button(ui, model, commands);
    }
}

/// Properties of a geometry, each a column of the summary.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Name,
    From,
    Median,
    Mean,
    Largest,
    BelowOne,
}

impl Part {
    const ALL: [Self; 6] = [Self::Name, Self::From, Self::Median, Self::Mean, Self::Largest, Self::BelowOne];

    /// Returns the columns of the summary. A narrow summary shows `From` as a tooltip.
    fn columns(is_narrow: bool) -> Vec<Self> {
        Self::ALL.into_iter().filter(|part| !(is_narrow && *part == Self::From)).collect()
    }

    fn column(self) -> Column {
        match self {
            Self::Name => Column::words(
                "Geometry",
                92.0,
                "Source of the geometry. Click a row to show that geometry in the whole window.",
            ),
            Self::From => Column::words(
                "From",
                176.0,
                "Data from which the geometry was computed, or the data that are missing.",
            ),
            Self::Median => Column::figures("Median, px", 76.0, "Half of the points are closer than this."),
            Self::Mean => Column::figures("Mean, px", 70.0, "Mean distance over all points."),
            Self::Largest => Column::figures("Max, px", 70.0, "Distance of the worst point."),
            Self::BelowOne => Column::figures("< 1 px", 56.0, "Share of the points closer than 1 px."),
        }
    }

    /// Returns the value in a spread, for columns of figures.
    fn of(self, spread: &Spread) -> Option<f64> {
        match self {
            Self::Name | Self::From => None,
            Self::Median => Some(spread.median),
            Self::Mean => Some(spread.mean),
            Self::Largest => Some(spread.max),
            Self::BelowOne => Some(spread.below_one),
        }
    }
}

/// Returns the geometries with a row. An imported geometry has a row only if there is one.
fn contestants(model: &Model) -> Vec<Contestant> {
    let has_imported = model.document.imported.is_some();
    Contestant::ALL.into_iter().filter(|c| has_imported || *c != Contestant::Imported).collect()
}

/// Returns the columns of the points table: the point, and its distance to each geometry.
fn point_columns(contestants: &[Contestant]) -> Vec<Column> {
    let point = Column::figures(
        "Point",
        84.0,
        "The pair, or the number of the true match. Point at a row to find it in both images. Click a pair \
         to select it, or a true match to inspect its lines.",
    );
    let distance = |contestant: &Contestant| {
        let (title, tooltip) = match contestant {
            Contestant::Result => ("Result", "Distance from the result, px."),
            Contestant::SevenPoint => ("7-point", "Distance from the seven-point geometry, px."),
            Contestant::EightPoint => ("8-point", "Distance from the eight-point geometry, px."),
            Contestant::Ransac => ("RANSAC", "Distance from the geometry of RANSAC, px."),
            Contestant::LeastMedian => {
                ("LMedS", "Distance from the geometry of least median of squares, px.")
            }
            Contestant::Imported => ("Imported", "Distance from the imported geometry, px."),
            Contestant::Truth => ("Truth", "Distance from the true geometry, px."),
        };
        // This title is longer than the others.
        let width = if *contestant == Contestant::Imported { 86.0 } else { 68.0 };
        Column { title, tooltip, width, is_text: false }
    };
    std::iter::once(point).chain(contestants.iter().map(distance)).collect()
}

/// Share of the width for the summary, normally and in narrow tables.
const SUMMARY_SHARE: [f32; 2] = [0.575, 0.53];
/// Width below which the summary leaves out its widest column, screen points.
const ROOM_FOR_ALL: f32 = 900.0;
/// Width below which both tables scroll sideways, screen points.
const LEAST_WIDTH: f32 = 660.0;
/// Space between the tables, screen points.
const BETWEEN: f32 = 18.0;

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    if model.document.pairs.is_empty() && model.truth().is_none() {
        empty(
            ui,
            "Distances of your pairs from the epipolar lines appear here, beside those of the 7-point and \
             8-point algorithms. Click point pairs, or open a folder with ground truth (VGG, or pairs with \
             true matches). The sample has ground truth, too: press Ground truth (G).",
        );
        return;
    }
    choices(ui, model, commands);
    let Some(comparison) = model.open.comparison.as_ref() else { return };
    if comparison.points == 0 {
        empty(ui, "There are no points to measure on. Click a point pair, or choose True matches above.");
        return;
    }
    let room = ui.available_size();
    ScrollArea::horizontal().id_salt("residual tables").auto_shrink([false, false]).show(ui, |ui| {
        let size = vec2(room.x.max(LEAST_WIDTH), ui.available_height());
        let (area, _) = ui.allocate_exact_size(size, Sense::hover());
        let is_narrow = size.x < ROOM_FOR_ALL;
        let share = SUMMARY_SHARE[usize::from(is_narrow)];
        let (left, right) = area.split_left_right_at_fraction(share);
        let right = Rect::from_min_max(right.min + vec2(BETWEEN, 0.0), right.max);
        ui.scope_builder(UiBuilder::new().max_rect(left), |ui| {
            summary(ui, model, comparison, is_narrow, commands);
        });
        ui.scope_builder(UiBuilder::new().max_rect(right), |ui| points(ui, model, comparison, commands));
    });
}

/// Shows the choices of points, measure and input.
fn choices(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let now = model.look.compared;
    let has_truth = model.truth().is_some();
    let mut choice = |ui: &mut Ui, name: &str, tooltip: &str, chosen: bool, enabled: bool, then: Subject| {
        let response = ui.add_enabled(enabled, egui::Button::selectable(chosen, name));
        let missing = "Needs ground truth: open a folder that has it, or press Ground truth (G).";
        if response.on_hover_text(tooltip).on_disabled_hover_text(missing).clicked() {
            commands.push(Command::Compare(then));
        }
    };
    let sets = [(PointSet::Pairs, "Point pairs"), (PointSet::TrueMatches, "True matches")];
    let in_use = |set| if has_truth { set } else { PointSet::Pairs };
    // Every row of choices costs a row of the tables.
    let is_narrow = ui.available_width() < ROOM_FOR_ALL;
    ui.horizontal_wrapped(|ui| {
        let spacing = ui.spacing_mut();
        spacing.item_spacing.x = if is_narrow { 3.0 } else { 4.0 };
        if is_narrow {
            (spacing.button_padding, spacing.interact_size.y) = (vec2(5.0, 1.0), 20.0);
        }
        ui.weak("Measure on");
        for (set, name) in sets {
            let then = Subject { measured: set, ..now };
            let enabled = has_truth || set == PointSet::Pairs;
            let chosen = in_use(now.measured) == set;
            choice(ui, name, "Measure on these points.", chosen, enabled, then);
        }
        between(ui, is_narrow);
        ui.weak("Distance");
        for (measure, name, tooltip) in [
            (
                Measure::Symmetric,
                "Symmetric",
                "Mean distance of the two points from each other's epipolar lines.",
            ),
            (
                Measure::Sampson,
                "Sampson",
                "Distance that the two points would have to move to fit exactly, to first order.",
            ),
        ] {
            choice(ui, name, tooltip, now.measure == measure, true, Subject { measure, ..now });
        }
        between(ui, is_narrow);
        ui.weak("7/8-point input").on_hover_text("Point pairs given to the 7-point and 8-point algorithms.");
        for set in [PointSet::Pairs, PointSet::TrueMatches] {
            let name = match set {
                PointSet::Pairs => "Point pairs",
                PointSet::TrueMatches => "My pairs + true matches",
            };
            let tooltip = match set {
                PointSet::Pairs => {
                    "All pairs that are not left out. The 7-point algorithm takes the first seven."
                }
                PointSet::TrueMatches => {
                    "Your pairs of the estimate, with their errors, plus as many true matches as needed, \
                     drawn at random."
                }
            };
            let then = Subject { fitted: set, ..now };
            let enabled = has_truth || set == PointSet::Pairs;
            let chosen = in_use(now.fitted) == set;
            choice(ui, name, tooltip, chosen, enabled, then);
        }
    });
}

/// Separates two groups of choices.
fn between(ui: &mut Ui, is_narrow: bool) {
    if is_narrow {
        ui.add_space(5.0);
    } else {
        ui.separator();
    }
}

fn summary(
    ui: &mut Ui,
    model: &Model,
    comparison: &Comparison,
    is_narrow: bool,
    commands: &mut Vec<Command>,
) {
    let shown = model.shown();
    let chosen = shown
        .filter(|shown| shown.hypothesis.is_none())
        .map(|shown| shown.contestant.unwrap_or(Contestant::Result));
    let contestants = contestants(model);
    let parts = Part::columns(is_narrow);
    let columns: Vec<Column> = parts.iter().map(|part| part.column()).collect();
    let touched = Table {
        name: if is_narrow { "narrow residual summary" } else { "residual summary" },
        columns: &columns,
        rows: contestants.len(),
        revision: comparison.number,
        row_name: &|row| format!("Geometry: {}", contestants[row].name()),
        key: &|row, column| {
            let part = parts.get(column).copied().unwrap_or(Part::Name);
            if matches!(part, Part::Name | Part::From) {
                return row as f64;
            }
            comparison
                .of(contestants[row])
                .spread
                .as_ref()
                .and_then(|spread| part.of(spread))
                .unwrap_or(f64::NAN)
        },
        text: &|row, column| {
            let (contestant, part) = (contestants[row], parts[column]);
            let compared = comparison.of(contestant);
            match (part, compared.spread.as_ref().and_then(|spread| part.of(spread))) {
                // The text continues over the empty columns of figures.
                (Part::Name, _) if is_narrow && compared.fit.is_err() => {
                    format!("{}: {}", contestant.name(), from(model, comparison, contestant))
                }
                (Part::Name, _) => contestant.name().to_owned(),
                (Part::From, _) => from(model, comparison, contestant),
                (_, None) => String::new(),
                (Part::BelowOne, Some(share)) => format!("{:.0} %", 100.0 * share),
                (_, Some(distance)) => px(distance),
            }
        },
        gauge: &|_, _| None,
        about: &|row| {
            let contestant = contestants[row];
            let is_cut = is_narrow && comparison.of(contestant).fit.is_ok();
            is_cut.then(|| format!("{}: {}.", contestant.name(), from(model, comparison, contestant)))
        },
        look: &|row| RowLook { chosen: chosen == Some(contestants[row]), lit: false },
        toggle: &|_| None,
    }
    .show(ui);
    if let Some(row) = touched.clicked {
        let contestant = contestants[row];
        // Without a geometry shown, there is nothing to replace.
        if shown.is_some() && comparison.fundamental(contestant).is_some() {
            commands.push(Command::ChooseContestant(contestant));
        }
    }
}

/// Describes the data a geometry was computed from, or the data missing.
fn from(model: &Model, comparison: &Comparison, contestant: Contestant) -> String {
    let fit = match &comparison.of(contestant).fit {
        Ok(fit) => fit,
        Err(why) => return why.clone(),
    };
    match contestant {
        Contestant::Result => format!("{} pairs and the images", fit.pairs),
        Contestant::SevenPoint if fit.solutions > 1 => {
            format!("7 pairs, nearest of {} solutions", fit.solutions)
        }
        Contestant::SevenPoint => "7 pairs, the only solution".to_owned(),
        Contestant::EightPoint => format!("{} pairs", fit.pairs),
        Contestant::Ransac | Contestant::LeastMedian => format!("{} inliers", fit.pairs),
        Contestant::Imported => {
            model.document.imported.as_ref().map_or(String::new(), |imported| imported.file.clone())
        }
        Contestant::Truth => match model.truth().map(|truth| truth.origin) {
            Some(TruthOrigin::Matches) => format!("fitted to all {} matches", fit.pairs),
            Some(TruthOrigin::File) => "its own file".to_owned(),
            _ => "the two cameras".to_owned(),
        },
    }
}

fn points(ui: &mut Ui, model: &Model, comparison: &Comparison, commands: &mut Vec<Command>) {
    let are_pairs = comparison.measured == PointSet::Pairs;
    let target = |row: usize| if are_pairs { Target::Pair(row) } else { Target::TrueMatch(row) };
    let name = |row: usize| if are_pairs { pair_name(row) } else { (row + 1).to_string() };
    let document = &model.document;
    let contestants = contestants(model);
    let columns = point_columns(&contestants);
    let distances = |column: usize| &comparison.of(contestants[column - 1]).distances;
    let touched = Table {
        name: "residuals",
        columns: &columns,
        rows: comparison.points,
        revision: comparison.number,
        row_name: &|row| {
            format!("{} {}", if are_pairs { "Residuals of pair" } else { "True match" }, name(row))
        },
        key: &|row, column| match column {
            0 => row as f64,
            _ => distances(column).get(row).copied().unwrap_or(f64::NAN),
        },
        text: &|row, column| match column {
            0 if are_pairs && document.role(row) == Role::Check => format!("{}, check", name(row)),
            0 if are_pairs && document.role(row) == Role::Excluded => format!("{}, out", name(row)),
            0 => name(row),
            _ => distances(column).get(row).map_or(String::new(), |d| px(*d)),
        },
        gauge: &|row, column| {
            let contestant = contestants[column.checked_sub(1)?];
            let pair = document.pairs.get(row).filter(|_| are_pairs)?;
            let sigma = document.parameters.click_sigma;
            Some(Gauge::of_click(comparison.fundamental(contestant)?, pair, sigma))
        },
        about: &|_| None,
        look: &|row| RowLook {
            chosen: are_pairs && document.selection.is_some_and(|at| at.pair == row),
            lit: model.open.focus.hovered() == Some(target(row)),
        },
        toggle: &|row| {
            are_pairs.then(|| (document.role(row) != Role::Excluded, format!("Count pair {}", name(row))))
        },
    }
    .show(ui);
    if let Some(row) = touched.hovered {
        commands.push(Command::PointAt(target(row)));
    }
    if let Some((row, included)) = touched.toggled {
        commands.push(Command::IncludePair(row, included));
    } else if let Some(row) = touched.clicked {
        if are_pairs {
            commands.push(Command::Select(Some(PointRef { pair: row, side: Side::Left })));
        } else if let Some(pair) = model.truth().and_then(|truth| truth.matches.get(row)) {
            commands.push(Command::Pin(LineSource::Through { side: Side::Left, point: pair.point1 }));
        }
    }
}

/// Formats a distance: two decimals below 100 px, none from there on.
fn px(distance: f64) -> String {
    match distance {
        d if !d.is_finite() => "infinite".to_owned(),
        d if d >= 100.0 => format!("{d:.0}"),
        d if d >= 0.005 || d == 0.0 => format!("{d:.2}"),
        _ => "< 0.01".to_owned(),
    }
}
