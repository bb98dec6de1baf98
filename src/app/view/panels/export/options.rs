//! The options of each kind of export.

use egui::{ComboBox, DragValue, Role, Ui, WidgetInfo};

use super::super::dialog::{PathField, row_label};
use crate::app::model::command::PickPurpose;
use crate::app::model::exchange::{ExportKind, ExportOrder, FigureChoices, FigureFormat, ReportFormat};
use crate::app::model::{Command, Model, OverlayId};
use crate::io::{Format, PictureFormat, RectifiedOptions};

/// Shows the options of the chosen kind. `database` is the typed path of a database of COLMAP.
pub fn options(
    ui: &mut Ui,
    order: &mut ExportOrder,
    database: &mut String,
    model: &Model,
    commands: &mut Vec<Command>,
) {
    match order.what {
        ExportKind::Plane => formats(ui, &mut order.format),
        ExportKind::Geometry | ExportKind::Pairs => {
            formats(ui, &mut order.format);
            let count = model.matches().len();
            if count > 0 {
                row(ui, "", |ui| {
                    ui.checkbox(
                        &mut order.with_matches,
                        format!("Include the {count} matches that support the result"),
                    )
                });
            }
        }
        ExportKind::Report => row(ui, "Format", |ui| {
            ui.radio_value(&mut order.reported, ReportFormat::Text, "Plain text")
                .on_hover_text("Words and figures, for reading.");
            ui.radio_value(&mut order.reported, ReportFormat::Json, "JSON")
                .on_hover_text("The format of epiline estimate, for Epiline and other programs.");
        }),
        ExportKind::Colmap => {
            let (browse, purpose) = ("Browse for the database", PickPurpose::Database);
            let hint = "path of the existing database";
            PathField { name: "Database", hint, width: 500.0, browse, purpose }.show(ui, database, commands);
        }
        ExportKind::Array
        | ExportKind::Table
        | ExportKind::Profile
        | ExportKind::Undistorted
        | ExportKind::View
        | ExportKind::Cloud => {}
        ExportKind::Figure => {
            figure(ui, &mut order.figure);
            layers(ui, &mut order.figure, model);
        }
        ExportKind::Rectified => rectified(ui, &mut order.rectified),
    }
}

fn formats(ui: &mut Ui, format: &mut Format) {
    ui.horizontal(|ui| {
        let label = row_label(ui, "Format");
        let formats = ComboBox::from_id_salt("export format")
            .selected_text(format.label())
            .width(240.0)
            .show_ui(ui, |ui| {
                for other in Format::ALL {
                    ui.selectable_value(format, other, other.label());
                }
            });
        formats.response.labelled_by(label.id);
    });
}

fn figure(ui: &mut Ui, figure: &mut FigureChoices) {
    row(ui, "Format", |ui| {
        ui.radio_value(&mut figure.format, FigureFormat::Svg, "SVG")
            .on_hover_text("Vector lines and text, for editing and for the web.");
        ui.radio_value(&mut figure.format, FigureFormat::Pdf, "PDF")
            .on_hover_text("Vector lines and text, for LaTeX and printing.");
    });
    row(ui, "Images", |ui| {
        ui.radio_value(&mut figure.seen, false, "Whole");
        ui.radio_value(&mut figure.seen, true, "Current view")
            .on_hover_text("The part of the image that each pane shows.");
    });
    row(ui, "Style", |ui| {
        ui.checkbox(&mut figure.labels, "Labels").on_hover_text("The names of points and lines.");
        ui.checkbox(&mut figure.dark, "Dark background")
            .on_hover_text("A dark colour between and around the images.");
    });
}

fn rectified(ui: &mut Ui, rectified: &mut RectifiedOptions) {
    row(ui, "Pictures", |ui| {
        ui.radio_value(&mut rectified.format, PictureFormat::Png, "PNG")
            .on_hover_text("8 or 16 bits with transparency. Every program reads PNG.");
        ui.radio_value(&mut rectified.format, PictureFormat::Tiff, "TIFF")
            .on_hover_text("8 or 16 bits or floating point, with transparency.");
    });
    ui.horizontal(|ui| {
        let label = row_label(ui, "Guide lines");
        let spacing = DragValue::new(&mut rectified.guide_spacing).range(0..=1000);
        ui.add(spacing.prefix("every ").suffix(" rows"))
            .labelled_by(label.id)
            .on_hover_text("Rows between two guide lines in the picture of both. 0 draws none.");
    });
    row(ui, "Maps", |ui| {
        let text = "Source position of each pixel, as .npy arrays for cv2.remap";
        ui.checkbox(&mut rectified.maps, text).on_hover_text(
            "Rows × columns × (x, y) in pixels of the original image, as 32-bit floats. Empty pixels \
             have (-1, -1).",
        );
    });
}

/// Shows which visible layers the figure contains.
fn layers(ui: &mut Ui, figure: &mut FigureChoices, model: &Model) {
    row(ui, "Layers", |ui| {
        ui.horizontal_wrapped(|ui| {
            let shown = |id: &OverlayId| id.is_for_figures() && model.offers(*id) && model.look.shows(*id);
            for layer in OverlayId::ALL.into_iter().filter(shown) {
                let mut on = figure.has(layer);
                let switch = ui.checkbox(&mut on, layer.name());
                let name = format!("{} on the figure", layer.name());
                switch.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, on, &name));
                figure.set(layer, on);
            }
        });
    });
}

/// Shows a labelled option, aligned with the others.
fn row<R>(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui) -> R) {
    ui.horizontal(|ui| {
        row_label(ui, name);
        content(ui);
    });
}
