//! The dialog for the convention of an imported matrix, shown before its geometry is drawn.

use egui::{Grid, Key, Label, RichText, Ui};

use super::dialog::dialog;
use super::tabs::px;
use super::{finish_button, main_button};
use crate::app::model::command::{Command, ExchangeCommand};
use crate::app::view::theme;
use crate::convention::{ConventionCheck, FEWEST_MATCHES};
use crate::io::{ImportFound, ImportedMatrix};
use crate::presentation::sentence;

/// The imported content and the present choice.
#[derive(Debug, Clone)]
pub struct ReadingDialog {
    found: ImportFound,
    matrix: ImportedMatrix,
    chosen: usize,
    with_pairs: bool,
}

impl ReadingDialog {
    /// Creates the dialog. The pairs of the file are preselected unless they would replace others.
    pub fn new(found: ImportFound, matrix: ImportedMatrix, has_pairs: bool) -> Self {
        let with_pairs = !found.pairs.is_empty() && !has_pairs;
        let chosen = match &matrix.check {
            // If no reading fits, the one as in the file is preselected.
            Some(check) if !check.fits() => as_read(check).unwrap_or(0),
            _ => 0,
        };
        Self { found, matrix, chosen, with_pairs }
    }

    pub fn found(&self) -> &ImportFound {
        &self.found
    }

    pub fn matrix(&self) -> &ImportedMatrix {
        &self.matrix
    }

    /// Shows the dialog. Returns whether it stays open.
    pub fn show(&mut self, ctx: &egui::Context, commands: &mut Vec<Command>) -> bool {
        dialog(ctx, "Convention of the matrix", 680.0, |ui| {
            let ImportFound { name, format, .. } = &self.found;
            ui.weak(format!("A fundamental matrix from {name}, read as {format}."));
            ui.add_space(6.0);
            self.verdict(ui);
            ui.add_space(6.0);
            if !self.found.pairs.is_empty() {
                let text = format!("Also import its {} point pairs", self.found.pairs.len());
                ui.checkbox(&mut self.with_pairs, text)
                    .on_hover_text("They replace the present pairs. Undo restores those.");
                ui.add_space(6.0);
            }
            ui.horizontal(|ui| self.buttons(ui, commands));
        })
    }

    fn verdict(&mut self, ui: &mut Ui) {
        let ImportedMatrix { check, matches, count, .. } = &self.matrix;
        if let Some(check) = check {
            let palette = theme::palette(ui.visuals());
            let color = if check.fits() { ui.visuals().text_color() } else { palette.caution };
            ui.add(Label::new(RichText::new(sentence(&check.sentence())).color(color)).wrap());
            ui.add_space(4.0);
            ui.weak(format!("Readings, measured on {} {matches}:", check.matches));
            readings(ui, check, &mut self.chosen);
        } else {
            let missing = FEWEST_MATCHES.saturating_sub(*count);
            let text = if missing > 0 {
                format!(
                    "The matrix was not checked: that takes {FEWEST_MATCHES} matches, and there are \
                     {count}. Find the geometry without clicks, or click {missing} more point pairs, and import the \
                     matrix again. Or import it as it is."
                )
            } else {
                "The matrix could not be checked: its numbers are too large to tell the readings apart."
                    .to_owned()
            };
            ui.add(Label::new(text).wrap());
        }
    }

    fn buttons(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let with_pairs = self.with_pairs;
        let accept = |reading| Command::from(ExchangeCommand::Accept { reading, with_pairs });
        let chosen = self.matrix.check.as_ref().map(|_| self.chosen);
        // A reading that fits nothing is not proposed.
        let fits = self.matrix.check.as_ref().is_none_or(ConventionCheck::fits);
        let name = accept(chosen).name();
        let button = if fits { main_button(ui, name) } else { ui.button(name) };
        finish_button(ui, button, accept(chosen), commands);
        let reject = Command::from(ExchangeCommand::Reject);
        let button = ui.button(reject.name());
        finish_button(ui, button, reject, commands);
        let is_enter = ui.input(|input| input.key_pressed(Key::Enter));
        if fits && is_enter && ui.memory(|memory| memory.focused().is_none()) {
            commands.push(accept(chosen));
        }
    }
}

fn as_read(check: &ConventionCheck) -> Option<usize> {
    check.readings.iter().position(|ranked| ranked.reading.changes() == 0)
}

fn readings(ui: &mut Ui, check: &ConventionCheck, chosen: &mut usize) {
    let own = as_read(check);
    let is_alike = |place: usize| check.fits() && !check.readings[place].told_apart;
    // The sentence names the next different reading. It is a choice if it fits, too.
    let next = check.readings.iter().position(|ranked| ranked.told_apart);
    let next = next.filter(|place| check.readings[*place].median <= check.limit);
    // Other readings than the best one, those that fit as well, and the one of the file are no choice.
    let is_listed =
        |place: &usize| *place == 0 || Some(*place) == own || Some(*place) == next || is_alike(*place);
    let headings = [
        ("Reading", "How the numbers of the matrix are interpreted."),
        ("Median, px", "Half of the matches are closer to their epipolar lines than this."),
        ("Fitting", "Share of the matches that are close enough to their epipolar lines."),
        ("", ""),
    ];
    Grid::new("readings").num_columns(4).striped(true).spacing([18.0, 4.0]).show(ui, |ui| {
        for (title, tooltip) in headings {
            ui.weak(title).on_hover_text(tooltip);
        }
        ui.end_row();
        for place in (0..check.readings.len()).filter(is_listed) {
            let ranked = &check.readings[place];
            let is_own = Some(place) == own;
            let name = if is_own { "as in the file".to_owned() } else { ranked.reading.brief() };
            ui.radio_value(chosen, place, name).on_hover_text(sentence(&ranked.reading.to_string()));
            ui.label(px(ranked.median));
            ui.label(format!("{:.0} %", 100.0 * ranked.within));
            let note = match place {
                0 if check.fits() => "recommended",
                _ if is_alike(place) => "fits as well",
                _ => "",
            };
            ui.weak(note);
            ui.end_row();
        }
    });
}
