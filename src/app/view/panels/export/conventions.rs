//! The conventions of the numbers in an exported file, and the verdict on its geometry.

use egui::{Label, RichText, Ui};

use crate::app::model::Model;
use crate::app::model::exchange::{ExportKind, ExportOrder, FigureFormat, result_note, trust_note};
use crate::app::view::theme;
use crate::camera::PicturesOf;
use crate::io::{Format, LINE_COLUMNS, TrustNote};
use crate::presentation::pictures_in_words;

/// Shows the conventions of the numbers in the file. Every file states them, too.
pub fn conventions(ui: &mut Ui, order: &ExportOrder, model: &Model) {
    let mut sentences: Vec<String> = match order.what {
        ExportKind::Geometry => order.format.convention(),
        ExportKind::Array => {
            let convention = Format::Json.convention().into_iter().take(2);
            convention.chain(["The array is 3 x 3, float64, row by row.".to_owned()]).collect()
        }
        // Sentences about F do not apply to points.
        ExportKind::Plane | ExportKind::Pairs => {
            order.format.convention().into_iter().skip(1).take(2).collect()
        }
        // The format chosen for other kinds does not apply to the table.
        ExportKind::Table => Format::Text.convention().into_iter().skip(1).take(1).collect(),
        ExportKind::Report => Format::Json.convention(),
        ExportKind::Profile => LINE_COLUMNS.map(str::to_owned).to_vec(),
        ExportKind::Figure => vec![match order.figure.format {
            FigureFormat::Svg => {
                "Contains the images at full resolution. Lines and text can be edited.".to_owned()
            }
            FigureFormat::Pdf => {
                "One page with the images at full resolution. Lines and text are vectors, and the font \
                 is embedded."
                    .to_owned()
            }
        }],
        ExportKind::Cloud => vec!["Axes of the left camera. The unit is the distance of the cameras.".to_owned()],
        ExportKind::View => vec!["A PNG file at the resolution of the screen.".to_owned()],
        ExportKind::Colmap => vec![
            "The database itself stays as it is. COLMAP counts the centre of the upper left pixel as (0.5, 0.5), and \
             points and F are converted."
                .to_owned(),
        ],
        ExportKind::Rectified | ExportKind::Undistorted => {
            vec!["Existing files of the same names are replaced.".to_owned()]
        }
    };
    let pictures_of = match order.what {
        ExportKind::Geometry
        | ExportKind::Array
        | ExportKind::Plane
        | ExportKind::Report
        | ExportKind::Profile => model.open.pictures_of(),
        ExportKind::Pairs | ExportKind::Table => PicturesOf::Original,
        _ => PicturesOf::Untold,
    };
    // The lens itself is in the file.
    sentences.extend(pictures_in_words(&pictures_of, 0.0).into_iter().take(1));
    for sentence in sentences {
        ui.add(Label::new(RichText::new(sentence).weak().small()).wrap());
    }
}

/// Shows a warning if the geometry is not reliable. All files but arrays and databases contain the same warning.
pub fn trust(ui: &mut Ui, what: ExportKind, model: &Model) {
    let note = match what {
        ExportKind::Report | ExportKind::Cloud => result_note(model),
        // The homography is certain where F is not.
        ExportKind::Plane | ExportKind::Pairs => None,
        _ => trust_note(model),
    };
    let Some(note) = note.filter(|note| note.verdict != "reliable") else { return };
    let palette = theme::palette(ui.visuals());
    let color = if note.verdict == "unreliable" { palette.bad } else { palette.caution };
    ui.add_space(4.0);
    let is_silent = matches!(what, ExportKind::Array | ExportKind::Colmap);
    let tells = if is_silent { "the file cannot say so" } else { "the file says so" };
    let is_result = note.geometry == TrustNote::RESULT;
    let named = if is_result { &note.verdict } else { &note.geometry };
    let text = format!("This geometry is {named}, and {tells}.");
    let reasons = note.reasons.join("\n");
    let label = ui.add(Label::new(RichText::new(text).color(color).strong()).wrap());
    if !reasons.is_empty() {
        label.on_hover_text(&reasons);
        let first: String = note.reasons.first().cloned().unwrap_or_default();
        ui.add(Label::new(RichText::new(first).color(color).small()).wrap());
    }
}
