//! The tab of the result beside other methods, an imported geometry and the ground truth.

use egui::{Label, RichText, ScrollArea, Ui};

use super::super::finish_button;
use super::super::table::{Column, RowLook, Table};
use super::Tab;
use super::residuals::{choice, contestants, measured, missing, px, tools};
use crate::app::model::command::PickPurpose;
use crate::app::model::comparison::{Comparison, Contestant, PointSet, Subject};
use crate::app::model::{Command, Model, TabId};
use crate::app::view::theme;
use crate::comparison::Spread;
use crate::io::TruthOrigin;
use crate::judge::Finding;
use crate::presentation::judgement_in_words;

pub const TAB: Tab = Tab { id: TabId::Compare, tools, show };

/// Width below which the summary leaves out its widest column, screen points.
const ROOM_FOR_ALL: f32 = 560.0;
/// Width below which the table scrolls sideways, screen points.
const LEAST_WIDTH: f32 = 270.0;
/// Width beside the choices from which the button of an import is there, screen points.
const ROOM_FOR_OFFER: f32 = 140.0;

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let Some(comparison) = measured(ui, model, commands) else { return offer_import(ui, model, commands) };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        inputs(ui, model, comparison, commands);
        // The table needs the row in a small window.
        if ui.available_size_before_wrap().x > ROOM_FOR_OFFER {
            offer_import(ui, model, commands);
        }
    });
    // The comparison may be older than the import.
    let imported = model.document.imported.as_ref().map(|imported| imported.fundamental);
    if let Some((_, judgement)) = comparison.judgement.as_ref().filter(|(of, _)| Some(*of) == imported) {
        let palette = theme::palette(ui.visuals());
        let color = match judgement.finding {
            // The sentence tells that the two differ by more than chance.
            Finding::Fits if judgement.significance.is_some_and(|found| found.is_significant) => {
                palette.caution
            }
            Finding::Fits => palette.good,
            Finding::DoesNotFit => palette.bad,
            Finding::Undecided => palette.caution,
        };
        let words = RichText::new(format!("Imported: {}", judgement_in_words(judgement))).color(color);
        ui.add(Label::new(words).wrap());
    }
    let room = ui.available_width();
    ScrollArea::horizontal().id_salt("summary table").auto_shrink([false, false]).show(ui, |ui| {
        ui.set_width(room.max(LEAST_WIDTH));
        summary(ui, model, comparison, room < ROOM_FOR_ALL, commands);
    });
}

fn offer_import(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    if model.document.pictures.is_some() && model.document.imported.is_none() {
        let button = ui.button("Import a geometry…");
        finish_button(ui, button, Command::Browse(PickPurpose::Import), commands);
    }
}

fn inputs(ui: &mut Ui, model: &Model, comparison: &Comparison, commands: &mut Vec<Command>) {
    let now = model.look.compared;
    ui.weak("Fitted to")
        .on_hover_text("Pairs given to the 7-point and 8-point algorithms, RANSAC and LMedS.");
    for (set, name, tooltip) in [
        (
            PointSet::Pairs,
            "Point pairs",
            "All pairs that are not left out. The 7-point algorithm takes the first seven.",
        ),
        (
            PointSet::Matches,
            "Matches",
            "The matches that the program found along the epipolar lines of the result, which favours the result. \
             The 7-point algorithm takes seven at even steps of the list.",
        ),
        (
            PointSet::Given,
            "Given",
            "The imported matches. The 7-point algorithm takes seven at even steps of the list.",
        ),
        (
            PointSet::TrueMatches,
            "My pairs + true matches",
            "Your pairs of the estimate, with their errors, plus as many true matches as needed, drawn at \
             random.",
        ),
    ] {
        if set == PointSet::Given && model.document.given.is_none() {
            continue;
        }
        let then = Subject { fitted: set, ..now };
        choice(ui, (name, tooltip), comparison.fitted == set, missing(model, set), then, commands);
    }
    let is_circular = comparison.fitted == comparison.measured && comparison.fitted != PointSet::Pairs;
    if is_circular || comparison.fitted == PointSet::Matches {
        let text = RichText::new("partly circular").size(theme::CAPTION).weak();
        ui.label(text).on_hover_text(
            "The other methods are fitted to points that are measured, or to the result's matches.",
        );
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
    let of_spread = |of: fn(&Spread) -> f64| {
        let contestants = &contestants;
        move |row: usize| comparison.of(contestants[row]).spread.as_ref().map_or(f64::NAN, of)
    };
    let figure = |title, width, tooltip, of| Column::figures(title, width, tooltip, of_spread(of), px);
    let name = Column::words(
        "Geometry",
        92.0,
        "Source of the geometry. Click a row to show that geometry in the whole window.",
        |row| {
            let (contestant, name) = (contestants[row], contestants[row].name().to_owned());
            // The text continues over the empty columns of figures.
            let goes_on = is_narrow && comparison.of(contestant).fit.is_err();
            if goes_on { format!("{name}: {}", from(model, comparison, contestant)) } else { name }
        },
    );
    let source = Column::words(
        "From",
        176.0,
        "Data from which the geometry was computed, or the data that are missing.",
        |row| from(model, comparison, contestants[row]),
    );
    let median =
        figure("Median, px", 90.0, "Half of the points are closer than this.", |spread| spread.median);
    let mean = figure("Mean, px", 70.0, "Mean distance over all points.", |spread| spread.mean);
    let largest = figure("Max, px", 70.0, "Distance of the worst point.", |spread| spread.max);
    let near = Column::figures(
        "< 1 px",
        56.0,
        "Share of the points closer than 1 px.",
        of_spread(|spread| spread.below_one),
        |share| format!("{:.0} %", 100.0 * share),
    );
    // A narrow summary shows the source as a tooltip, and leaves the mean out, as its heading would touch the others.
    let columns = if is_narrow {
        vec![name, median, largest, near]
    } else {
        vec![name, source, median, mean, largest, near]
    };
    let touched = Table {
        name: if is_narrow { "narrow residual summary" } else { "residual summary" },
        columns: &columns,
        rows: contestants.len(),
        revision: comparison.number,
        list: (model.open.computation.run(), 0),
        row_name: &|row| format!("Geometry: {}", contestants[row].name()),
        about: &|row| {
            let contestant = contestants[row];
            let is_fitted = comparison.of(contestant).fit.is_ok();
            let note = match contestant {
                Contestant::SevenPoint if is_fitted => {
                    "Of several solutions, the nearest to the measured points counts."
                }
                Contestant::Truth if !is_fitted => {
                    return Some("Press Ground truth (G) to use it.".to_owned());
                }
                _ if is_narrow && is_fitted => "",
                _ => return None,
            };
            let from = from(model, comparison, contestant);
            Some(format!("{}: {from}. {note}", contestant.name()).trim_end().to_owned())
        },
        look: &|row| RowLook { chosen: chosen == Some(contestants[row]), lit: false },
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
    let set = match comparison.fitted {
        PointSet::Matches | PointSet::Given => "matches",
        PointSet::Pairs | PointSet::TrueMatches => "pairs",
    };
    match contestant {
        Contestant::Result if fit.pairs == 1 => "1 pair and the images".to_owned(),
        Contestant::Result if fit.pairs > 0 => format!("{} pairs and the images", fit.pairs),
        Contestant::Result => match model.result() {
            Some(found) if found.assessment.of_given => "the given matches".to_owned(),
            _ if model.document.given.is_some() => "the images and the given matches".to_owned(),
            _ => "the images alone".to_owned(),
        },
        Contestant::SevenPoint => {
            let which = match comparison.fitted {
                PointSet::Pairs => "first 7 pairs",
                PointSet::Matches | PointSet::Given => "7 spread matches",
                PointSet::TrueMatches => "7 pairs",
            };
            format!("{which}, {} solution{}", fit.solutions, if fit.solutions == 1 { "" } else { "s" })
        }
        Contestant::EightPoint => format!("{} {set}", fit.pairs),
        Contestant::Ransac => format!("{} inliers", fit.pairs),
        // It counts inliers by a scale of its own, so their number says nothing beside the others.
        Contestant::LeastMedian => format!("median of all {set}"),
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
