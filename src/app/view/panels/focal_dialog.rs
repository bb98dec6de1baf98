//! The dialog for the focal lengths of pictures without a calibration.

use egui::{Context, Label, TextEdit};

use super::dialog::{dialog, ending, row_label};
use crate::app::model::command::Command;
use crate::app::model::document::Side;
use crate::camera::FocalLength;

/// A picture whose focal length is asked for.
#[derive(Debug, Clone)]
struct Row {
    /// Focal length of the EXIF data.
    guess: Option<FocalLength>,
    text: String,
}

/// The typed focal lengths.
#[derive(Debug, Clone)]
pub struct FocalDialog {
    rows: [Row; 2],
    just_opened: bool,
}

impl FocalDialog {
    /// Creates the dialog with the focal lengths of EXIF data.
    pub fn new(guesses: [Option<FocalLength>; 2]) -> Self {
        let rows = guesses.map(|guess| Row { guess, text: guess.map_or_else(String::new, shown) });
        Self { rows, just_opened: true }
    }

    /// Shows the dialog. Returns whether it stays open.
    pub fn show(&mut self, ctx: &Context, commands: &mut Vec<Command>) -> bool {
        let open = dialog(ctx, "Focal lengths", 460.0, |ui| {
            let text = "The 3-D points and the pose of the cameras need the focal lengths. The principal points \
                        are taken to be in the middle. A calibration file tells more: drop it on the window.";
            ui.add(Label::new(text).wrap());
            ui.add_space(6.0);
            for side in Side::BOTH {
                let row = &mut self.rows[side.index()];
                let name = ["Left image", "Right image"][side.index()];
                ui.horizontal(|ui| {
                    let label = row_label(ui, name);
                    let edit =
                        TextEdit::singleline(&mut row.text).hint_text("focal length").desired_width(110.0);
                    let field = ui.add(edit).labelled_by(label.id);
                    if self.just_opened && side == Side::Left {
                        field.request_focus();
                    }
                    ui.label("px");
                    ui.weak(row.note());
                });
            }
            ui.add_space(6.0);
            let [left, right] = self.rows.each_ref().map(Row::focal);
            let use_them = left.zip(right).map(|(left, right)| Command::SetFocalLengths([left, right]));
            ui.horizontal(|ui| ending(ui, "Use", use_them, Command::ShowFocalLengths, commands));
        });
        self.just_opened = false;
        open
    }
}

impl Row {
    /// Returns the guess while its text is unchanged, else the typed focal length.
    fn focal(&self) -> Option<FocalLength> {
        let text = self.text.trim();
        let typed = || {
            let pixels: f64 = text.parse().ok()?;
            (pixels.is_finite() && pixels > 0.0).then_some(FocalLength { pixels, deviation: 0.0 })
        };
        self.guess.filter(|guess| shown(*guess) == text).or_else(typed)
    }

    /// Tells where the focal length is from, or what is wrong with it.
    fn note(&self) -> String {
        match self.focal() {
            Some(FocalLength { deviation, .. }) if deviation > 0.0 => {
                format!("guessed from EXIF data, ± {:.0} %", 100.0 * deviation)
            }
            Some(_) => String::new(),
            None if self.text.trim().is_empty() => {
                "no EXIF data; often 0.7 to 1.3 times the width".to_owned()
            }
            None => "not a positive number".to_owned(),
        }
    }
}

fn shown(focal: FocalLength) -> String {
    format!("{:.0}", focal.pixels)
}
