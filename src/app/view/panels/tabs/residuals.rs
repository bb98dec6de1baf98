//! The tab of the distances of points from the result, from other methods, and from the ground
//! truth.

use egui::{ScrollArea, Ui};

use super::super::table::{Column, RowLook, Table};
use super::{Tab, empty};
use crate::app::model::comparison::{Comparison, Contestant, Measure, PointSet, Subject};
use crate::app::model::{
    Command, LineSource, Model, OverlayId, PointRef, Role, Side, TabId, Target, pair_name,
};
use crate::app::view::panels::truth_button;
use crate::app::view::theme;

pub const TAB: Tab = Tab { id: TabId::Residuals, tools, show };

/// Shows the switch of the ground truth.
pub fn tools(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    truth_button(ui, model, commands);
}

/// Shows what is missing. Returns the comparison if there is one with points.
pub fn measured<'a>(ui: &mut Ui, model: &'a Model, commands: &mut Vec<Command>) -> Option<&'a Comparison> {
    let sets = [PointSet::Pairs, PointSet::Matches, PointSet::Given, PointSet::TrueMatches];
    if sets.iter().all(|set| missing(model, *set).is_some()) {
        let text = if model.open.computation.is_running() {
            "Distances from the epipolar lines appear here with the result."
        } else if model.compares_barcodes() && model.result().is_some() {
            "Distances from the epipolar lines appear here. Motion barcodes give no matches: click point pairs."
        } else if model.document.imported.is_some() {
            "Distances from the epipolar lines appear here. Click point pairs, or find F without clicks: the \
             matches of the images then judge the imported geometry."
        } else {
            "Distances from the epipolar lines appear here. Click point pairs, or find F without clicks."
        };
        empty(ui, text);
        return None;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        choices(ui, model, commands);
    });
    let comparison = model.open.comparison.as_ref()?;
    if comparison.points.is_empty() {
        empty(ui, "There are no points to measure on. Click a point pair, or choose other points above.");
        return None;
    }
    // Until the new one arrives, figures of the previous result are pale.
    if comparison.of != model.result().map(|found| *found.fundamental()) {
        ui.multiply_opacity(theme::STALE_OPACITY);
    }
    Some(comparison)
}

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let Some(comparison) = measured(ui, model, commands) else { return };
    let of_given = comparison.measured == PointSet::Given;
    if model.look.shows(OverlayId::MagnifiedResiduals) && (of_given || !model.matches().is_empty()) {
        let which = if of_given { "given matches that fit" } else { "matches" };
        ui.weak(format!(
            "Strokes in the pictures: distances of the {which} from their lines, 50 times enlarged"
        ));
    }
    points(ui, model, comparison, commands);
}

pub fn choices(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let now = model.look.compared;
    let measured = model.open.comparison.as_ref().map_or(now.measured, |comparison| comparison.measured);
    ui.weak("Measured on");
    for (set, name, tooltip) in [
        (PointSet::Pairs, "Point pairs", "Measure on the pairs that you clicked."),
        (PointSet::Matches, "Matches", MATCHES),
        (PointSet::Given, "Given", "Measure on the imported matches."),
        (PointSet::TrueMatches, "True matches", "Measure on the true matches."),
    ] {
        if set == PointSet::Given && model.document.given.is_none() {
            continue;
        }
        let then = Subject { measured: set, ..now };
        choice(ui, (name, tooltip), measured == set, missing(model, set), then, commands);
    }
    ui.add_space(theme::GAP);
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
        let then = Subject { measure, ..now };
        choice(ui, (name, tooltip), now.measure == measure, None, then, commands);
    }
}

const MATCHES: &str = "The matches that the program found in the images. It looked for them along the epipolar \
                           lines of the result, which favours the result.";

/// Returns why there are no points of a kind; `None` if there are some.
pub fn missing(model: &Model, set: PointSet) -> Option<&'static str> {
    match set {
        PointSet::Pairs => model.document.pairs.is_empty().then_some("You have clicked no point pair."),
        PointSet::Matches => model.matches().is_empty().then_some("There is no result with matches yet."),
        PointSet::Given => model.document.given.is_none().then_some("No matches were imported."),
        PointSet::TrueMatches => match model.truth() {
            Some(truth) if truth.matches.is_empty() => {
                Some("The ground truth is a matrix without true matches.")
            }
            Some(_) => None,
            None => Some(
                "Needs ground truth: open a folder that has it, or press Ground truth (G) on the sample.",
            ),
        },
    }
}

/// Shows one value of a choice. It is disabled if something is missing.
pub fn choice(
    ui: &mut Ui,
    (name, tooltip): (&str, &str),
    chosen: bool,
    missing: Option<&str>,
    then: Subject,
    commands: &mut Vec<Command>,
) {
    let response = ui.add_enabled(missing.is_none(), egui::Button::selectable(chosen, name).small());
    let response = response.on_hover_text(tooltip);
    if response.on_disabled_hover_text(missing.unwrap_or_default()).clicked() {
        commands.push(Command::Compare(then));
    }
}

/// Returns the geometries with a row. An imported and the true geometry have a row only if they are known.
pub fn contestants(model: &Model) -> Vec<Contestant> {
    let has_row = |contestant: &Contestant| match contestant {
        Contestant::Imported => model.document.imported.is_some(),
        Contestant::Truth => model.open.known().is_some(),
        _ => true,
    };
    Contestant::ALL.into_iter().filter(has_row).collect()
}

fn points(ui: &mut Ui, model: &Model, comparison: &Comparison, commands: &mut Vec<Command>) {
    let are_pairs = comparison.measured == PointSet::Pairs;
    // The result may be newer than the comparison and have other matches.
    let is_current =
        |row: usize| model.matches().get(row).map(|found| &found.pair) == comparison.points.get(row);
    let target = |row: usize| match comparison.measured {
        PointSet::Pairs => Some(Target::Pair(row)),
        PointSet::Matches => is_current(row).then_some(Target::Match(row)),
        PointSet::Given => Some(Target::GivenMatch(row)),
        PointSet::TrueMatches => Some(Target::TrueMatch(row)),
    };
    let name = |row: usize| if are_pairs { pair_name(row) } else { (row + 1).to_string() };
    let document = &model.document;
    let mut contestants = contestants(model);
    contestants.retain(|c| *c != Contestant::Truth || model.truth().is_some());
    // Compare tells why a geometry could not be computed.
    contestants.retain(|c| !comparison.of(*c).distances.is_empty());
    let point = Column::figures(
        "Point",
        84.0,
        "The pair, or the number of the match. Point at a row to find it in both images. Click a pair to \
         select it, or a match to inspect its lines.",
        |row| row as f64,
        |_| String::new(),
    );
    let point = point.written(|row| match document.role(row) {
        Role::Check if are_pairs => format!("{}, check", name(row)),
        Role::Excluded if are_pairs => format!("{}, out", name(row)),
        _ => name(row),
    });
    let distance = |contestant: Contestant| {
        let title = if contestant == Contestant::Truth { "Truth" } else { contestant.name() };
        // This title is longer than the others.
        let width = if contestant == Contestant::Imported { 104.0 } else { 86.0 };
        let tooltip = "Mean distance of both points from their epipolar lines in this geometry, px.";
        let distances = &comparison.of(contestant).distances;
        let distance = |row: usize| distances.get(row).copied().unwrap_or(f64::NAN);
        Column::figures(title, width, tooltip, distance, px).in_unit(", px")
    };
    let columns: Vec<Column> = std::iter::once(point).chain(contestants.into_iter().map(distance)).collect();
    let table = Table {
        name: "residuals",
        columns: &columns,
        rows: comparison.points.len(),
        revision: comparison.number,
        list: (model.open.computation.run(), comparison.measured as usize),
        row_name: &|row| {
            let kind = match comparison.measured {
                PointSet::Pairs => "Residuals of pair",
                PointSet::Matches => "Match",
                PointSet::Given => "Given match",
                PointSet::TrueMatches => "True match",
            };
            format!("{kind} {}", name(row))
        },
        about: &|_| None,
        look: &|row| RowLook {
            chosen: are_pairs && document.selection.is_some_and(|at| at.pair == row),
            lit: model.open.focus.hovered().is_some_and(|hovered| target(row) == Some(hovered)),
        },
    };
    // With many methods, a narrow table scrolls sideways.
    let width = ui.available_width().max(table.least_width(ui));
    let area = ScrollArea::horizontal().id_salt("residual table").auto_shrink([false, false]);
    let shown = area.show(ui, |ui| {
        ui.set_width(width);
        table.show(ui)
    });
    let touched = shown.inner;
    if let Some(target) = touched.hovered.and_then(target) {
        commands.push(Command::PointAt(target));
    }
    if let Some(row) = touched.clicked {
        if are_pairs {
            commands.push(Command::Select(Some(PointRef { pair: row, side: Side::Left })));
        } else if let Some(pair) = comparison.points.get(row) {
            commands.push(Command::Pin(LineSource::Through { side: Side::Left, point: pair.point1 }));
        }
    }
}

/// Formats a distance: two decimals below 100 px, none from there on.
pub fn px(distance: f64) -> String {
    match distance {
        d if !d.is_finite() => "infinite".to_owned(),
        d if d >= 100.0 => format!("{d:.0}"),
        d if d >= 0.005 || d == 0.0 => format!("{d:.2}"),
        _ => "< 0.01".to_owned(),
    }
}
