//! The dialog for the focal lengths of pictures without a calibration.

use egui::{Context, Label, TextEdit};

use super::dialog::{dialog, ending, row_label};
use crate::app::model::{Command, Side};
use crate::app::view::theme;
use crate::camera::FocalLength;

/// Relative standard deviation proposed for typed focal lengths, as for those of EXIF data. A chosen value:
/// who has a calibration changes it to 0.
const TYPED_DEVIATION: f64 = 0.05;

type Lengths = [Option<FocalLength>; 2];

#[derive(Debug, Clone)]
pub struct FocalDialog {
    guesses: Lengths,
    /// Widths of the pictures, px.
    widths: [usize; 2],
    pixels: [String; 2],
    percent: String,
    just_opened: bool,
}

impl FocalDialog {
    /// Creates the dialog with the lengths in use, or with those of EXIF data.
    pub fn new(used: Lengths, guesses: Lengths, widths: [usize; 2]) -> Self {
        let known = [used[0].or(guesses[0]), used[1].or(guesses[1])];
        let pixels = known.map(|length| length.map_or_else(String::new, |length| shown(length.pixels)));
        let deviation = known.iter().flatten().map(|guess| guess.deviation).reduce(f64::max);
        let percent = shown(100.0 * deviation.unwrap_or(TYPED_DEVIATION));
        Self { guesses, widths, pixels, percent, just_opened: true }
    }

    /// Shows the dialog. Returns whether it stays open.
    pub fn show(&mut self, ctx: &Context, commands: &mut Vec<Command>) -> bool {
        let open = dialog(ctx, "Focal lengths", 460.0, |ui| {
            let text = "The 3-D points and the pose of the cameras need the focal lengths. The principal points \
                        are taken to be in the middle. A calibration file tells more: drop it on the window.";
            ui.add(Label::new(text).wrap());
            ui.add_space(6.0);
            let of_percent = match self.percent() {
                Some(percent) if percent > 0.0 => "included in the uncertainty of the pose",
                Some(_) => "exact",
                None => NO_PERCENT,
            };
            let [note1, note2] = Side::BOTH.map(|side| self.note(side));
            let [left, right] = &mut self.pixels;
            for (name, text, hint, unit, note) in [
                ("Left image", left, "focal length", "px", note1),
                ("Right image", right, "focal length", "px", note2),
                ("Known to ±", &mut self.percent, "0", "%", of_percent.to_owned()),
            ] {
                ui.horizontal(|ui| {
                    let label = row_label(ui, name);
                    let edit = TextEdit::singleline(text).hint_text(hint).desired_width(110.0);
                    let field = ui.add(edit).labelled_by(label.id);
                    if std::mem::take(&mut self.just_opened) {
                        field.request_focus();
                    }
                    ui.label(unit);
                    if [NO_LENGTH, NO_PERCENT].contains(&note.as_str()) {
                        ui.colored_label(theme::palette(ui.visuals()).bad, note);
                    } else {
                        ui.weak(note);
                    }
                });
            }
            ui.add_space(6.0);
            let lengths = Side::BOTH.map(|side| self.focal(side));
            let use_them = if let [Some(left), Some(right)] = lengths { Some([left, right]) } else { None };
            let use_them = use_them.map(Command::SetFocalLengths);
            ui.horizontal(|ui| ending(ui, "Use", use_them, Command::ShowFocalLengths, commands));
        });
        self.just_opened = false;
        open
    }

    /// Returns the text of a focal length. Without text for the right image, the text for the left one counts.
    fn text(&self, side: Side) -> &str {
        let [left, right] = self.pixels.each_ref().map(|text| text.trim());
        if side == Side::Left || right.is_empty() { left } else { right }
    }

    fn focal(&self, side: Side) -> Option<FocalLength> {
        Some(FocalLength { pixels: self.focal_pixels(side)?, deviation: self.percent()? / 100.0 })
    }

    fn focal_pixels(&self, side: Side) -> Option<f64> {
        self.text(side).parse().ok().filter(|pixels: &f64| pixels.is_finite() && *pixels > 0.0)
    }

    /// Returns the deviation in percent; that of an empty field is 0.
    fn percent(&self) -> Option<f64> {
        let text = self.percent.trim();
        let percent = if text.is_empty() { 0.0 } else { text.parse().ok()? };
        (0.0..100.0).contains(&percent).then_some(percent)
    }

    /// Tells where a focal length is from and how much a camera with it sees, or what is wrong with it.
    fn note(&self, side: Side) -> String {
        let text = self.text(side);
        let is_empty = self.pixels[side.index()].trim().is_empty();
        if text.is_empty() {
            return "no EXIF data; often 0.7 to 1.3 times the width".to_owned();
        }
        let Some(pixels) = self.focal_pixels(side) else { return NO_LENGTH.to_owned() };
        let is_guess = self.guesses[side.index()].is_some_and(|guess| shown(guess.pixels) == text);
        let source = match (is_empty, is_guess) {
            (true, _) => "that of the left image: ",
            (false, true) => "from EXIF data: ",
            (false, false) => "",
        };
        let angle = 2.0 * (0.5 * self.widths[side.index()] as f64 / pixels).atan().to_degrees();
        format!("{source}sees {angle:.0}° from left to right")
    }
}

/// Text beside a focal length that cannot be read.
const NO_LENGTH: &str = "not a positive number";
/// Text beside a deviation that cannot be read.
const NO_PERCENT: &str = "not a percentage below 100";

/// Returns a number to two decimals, so that a typed one stays as it is.
fn shown(value: f64) -> String {
    ((100.0 * value).round() / 100.0).to_string()
}
