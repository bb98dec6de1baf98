//! The export dialog: content, format and file.

use std::path::{Path, PathBuf};

use egui::{Button, ComboBox, Key, Label, RichText, Role, Ui, WidgetInfo};

use super::super::dialog::{PathField, dialog, path_of, row_label};
use super::super::{command_button, finish_button};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::command::ExchangeCommand;
use crate::app::model::exchange::{
    ExportKind, ExportOrder, FigureFormat, PROFILE_CONVENTION, ReportFormat, ViewPart, result_note,
    trust_note,
};
use crate::app::model::ids::OverlayId;
use crate::app::model::rectified::RectifiedCommand;
use crate::app::view::theme;
use crate::io::Format;

/// Choices of the dialog, kept for the next time.
#[derive(Debug, Clone, Default)]
pub struct FileExport {
    /// Whether it is shown.
    pub open: bool,
    order: ExportOrder,
    path: String,
    /// Folder and stem of suggested file names.
    begin: PathBuf,
    /// Latest suggested path.
    suggested: String,
    just_opened: bool,
}

impl FileExport {
    /// Opens the dialog. `begin` is the folder and stem of exports of these images.
    pub fn show_with(&mut self, begin: PathBuf) {
        (self.open, self.just_opened) = (true, true);
        if begin != self.begin {
            (self.begin, self.path) = (begin, String::new());
        }
        self.suggest();
    }

    /// Fills in a chosen path.
    pub fn offer(&mut self, path: &Path) {
        self.path = path.display().to_string();
    }

    /// Returns the file extension for the present choices.
    fn extension(&self) -> &'static str {
        match self.order.what {
            ExportKind::Geometry | ExportKind::Plane | ExportKind::Pairs => self.order.format.extension(),
            ExportKind::Report if self.order.reported == ReportFormat::Json => "json",
            ExportKind::Report => "txt",
            ExportKind::Table | ExportKind::Profile => "csv",
            ExportKind::Figure => self.order.figure.format.extension(),
            ExportKind::View => "png",
        }
    }

    /// Updates the path after a choice: replaces a suggested path, but only the extension of a
    /// typed one.
    fn suggest(&mut self) {
        let kind = match self.order.what {
            ExportKind::Geometry => "geometry",
            ExportKind::Plane => "plane",
            ExportKind::Pairs => "pairs",
            ExportKind::Table => "points",
            ExportKind::Report => "report",
            ExportKind::Profile => "profile",
            ExportKind::Figure => "figure",
            ExportKind::View => "view",
        };
        let untouched = self.path.trim().is_empty() || self.path == self.suggested;
        // MATLAB runs a script by its name, so the name must be a valid identifier.
        let separator = if self.extension() == Format::Matlab.extension() { '_' } else { '-' };
        let stem =
            self.begin.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let mut name = format!("{stem}{separator}{kind}");
        if separator == '_' {
            name = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
            if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
                name.insert(0, 'e');
            }
        }
        let own = self.begin.with_file_name(format!("{name}.{}", self.extension()));
        self.suggested = own.display().to_string();
        if untouched {
            self.path.clone_from(&self.suggested);
        } else if let Some(path) = path_of(&self.path) {
            self.path = path.with_extension(self.extension()).display().to_string();
        }
    }

    /// Shows the dialog if open.
    pub fn show(&mut self, ctx: &egui::Context, model: &Model, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        if !self.order.what.is_offered(model) {
            self.order.what = ExportKind::default();
            self.suggest();
        }
        let open = dialog(ctx, "Export", 560.0, |ui| {
            let before = (self.order.what, self.order.format, self.order.reported, self.order.figure.format);
            row(ui, "What", |ui| self.kinds(ui, model));
            ui.add(Label::new(RichText::new(self.order.what.tooltip()).weak()).wrap());
            ui.add_space(4.0);
            self.choices(ui, model);
            if before != (self.order.what, self.order.format, self.order.reported, self.order.figure.format) {
                self.suggest();
            }
            ui.add_space(4.0);
            self.conventions(ui);
            trust(ui, self.order.what, model);
            ui.add_space(6.0);
            let suggested = path_of(&self.path).unwrap_or_else(|| PathBuf::from(&self.suggested));
            let file = PathField {
                name: "File",
                hint: "path of the file",
                width: 370.0,
                browse: "Browse for the export file",
                command: ExchangeCommand::BrowseExport(suggested).into(),
            };
            let file = file.show(ui, &mut self.path, commands);
            if self.just_opened {
                file.request_focus();
            }
            let path = path_of(&self.path);
            let replaces = path.as_ref().is_some_and(|path| path.exists());
            let missing = self.order.what.missing(model);
            ui.label(match (missing, replaces) {
                (Some(missing), _) => missing,
                (None, true) => "A file of that name exists and will be replaced.",
                (None, false) => "",
            });
            ui.add_space(6.0);
            let order =
                path.filter(|_| missing.is_none()).map(|path| ExportOrder { path, ..self.order.clone() });
            self.buttons(ui, model, order, commands);
        });
        self.just_opened = false;
        self.open &= open;
    }

    fn kinds(&mut self, ui: &mut Ui, model: &Model) {
        for what in ExportKind::ALL.into_iter().filter(|what| what.is_offered(model)) {
            let missing = what.missing(model);
            let button =
                ui.add_enabled(missing.is_none(), Button::selectable(self.order.what == what, what.name()));
            let button = button.on_hover_text(what.tooltip());
            if button.on_disabled_hover_text(missing.unwrap_or_default()).clicked() {
                self.order.what = what;
            }
        }
    }

    /// Shows the options of the chosen kind of file.
    fn choices(&mut self, ui: &mut Ui, model: &Model) {
        match self.order.what {
            ExportKind::Plane => self.formats(ui),
            ExportKind::Geometry | ExportKind::Pairs => {
                self.formats(ui);
                let count =
                    model.open.computation.result().map_or(0, |(estimate, _)| estimate.matches().len());
                if count > 0 {
                    row(ui, "", |ui| {
                        ui.checkbox(
                            &mut self.order.with_matches,
                            format!("Include the {count} matches that support the result"),
                        )
                    });
                }
            }
            ExportKind::Report => row(ui, "Format", |ui| {
                ui.radio_value(&mut self.order.reported, ReportFormat::Text, "Plain text")
                    .on_hover_text("Words and figures, for reading.");
                ui.radio_value(&mut self.order.reported, ReportFormat::Json, "JSON")
                    .on_hover_text("The format of epiline estimate, for Epiline and other programs.");
            }),
            ExportKind::Table | ExportKind::Profile => {}
            ExportKind::Figure => {
                self.figure(ui);
                self.layers(ui, model);
            }
            ExportKind::View => row(ui, "Part", |ui| {
                ui.radio_value(&mut self.order.part, ViewPart::Images, "Both images")
                    .on_hover_text("The two images with all overlays.");
                ui.radio_value(&mut self.order.part, ViewPart::Window, "The whole window");
            }),
        }
    }

    fn formats(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let label = row_label(ui, "Format");
            let formats = ComboBox::from_id_salt("export format")
                .selected_text(self.order.format.label())
                .width(240.0)
                .show_ui(ui, |ui| {
                    for format in Format::ALL {
                        ui.selectable_value(&mut self.order.format, format, format.label());
                    }
                });
            formats.response.labelled_by(label.id);
        });
    }

    /// Shows the options of a figure.
    fn figure(&mut self, ui: &mut Ui) {
        let figure = &mut self.order.figure;
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

    /// Shows which visible layers the figure contains.
    fn layers(&mut self, ui: &mut Ui, model: &Model) {
        let figure = &mut self.order.figure;
        row(ui, "Layers", |ui| {
            ui.horizontal_wrapped(|ui| {
                let shown =
                    |id: &OverlayId| id.is_for_figures() && model.offers(*id) && model.look.shows(*id);
                for layer in OverlayId::all().filter(shown) {
                    let mut on = figure.has(layer);
                    let switch = ui.checkbox(&mut on, layer.name());
                    let name = format!("{} on the figure", layer.name());
                    switch.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, on, &name));
                    figure.set(layer, on);
                }
            });
        });
    }

    /// Shows the conventions of the numbers in the file. Every file states them, too.
    fn conventions(&self, ui: &mut Ui) {
        let sentences: Vec<String> = match self.order.what {
            ExportKind::Geometry => self.order.format.convention(),
            // Sentences about F do not apply to points.
            ExportKind::Plane | ExportKind::Pairs | ExportKind::Table => {
                self.order.format.convention().into_iter().skip(1).take(2).collect()
            }
            ExportKind::Report => Format::Json.convention(),
            ExportKind::Profile => PROFILE_CONVENTION.map(str::to_owned).to_vec(),
            ExportKind::Figure => vec![match self.order.figure.format {
                FigureFormat::Svg => {
                    "Contains the images at full resolution. Lines and text can be edited.".to_owned()
                }
                FigureFormat::Pdf => {
                    "One page with the images at full resolution. Lines and text are vectors, and the font \
                     is embedded."
                        .to_owned()
                }
            }],
            ExportKind::View => vec!["A PNG file at the resolution of the screen.".to_owned()],
        };
        for sentence in sentences {
            ui.add(Label::new(RichText::new(sentence).weak().small()).wrap());
        }
    }

    fn buttons(
        &mut self,
        ui: &mut Ui,
        model: &Model,
        order: Option<ExportOrder>,
        commands: &mut Vec<Command>,
    ) {
        let command = order.map(|order| ExchangeCommand::Export(order).into());
        ui.horizontal(|ui| {
            let export = ui.add_enabled(command.is_some(), Button::new("Export file"));
            let described =
                command.clone().unwrap_or_else(|| ExchangeCommand::Export(self.order.clone()).into());
            finish_button(ui, export, described, commands);
            command_button(ui, Command::Cancel, true, commands);
            let right = egui::Layout::right_to_left(egui::Align::Center);
            ui.with_layout(right, |ui| {
                let rectified = ui.add_enabled(model.shown().is_some(), Button::new("Rectified pair…"));
                if finish_button(ui, rectified, RectifiedCommand::ShowExport.into(), commands).clicked() {
                    self.open = false;
                }
            });
        });
        if ui.input(|input| input.key_pressed(Key::Enter)) {
            commands.extend(command);
        }
    }
}

/// Shows a warning if the geometry is not reliable. The file contains the same warning.
fn trust(ui: &mut Ui, what: ExportKind, model: &Model) {
    let note = match what {
        ExportKind::Plane | ExportKind::Report => result_note(model),
        ExportKind::Pairs => None,
        _ => trust_note(model),
    };
    let Some(note) = note.filter(|note| note.verdict != "reliable") else { return };
    let palette = theme::palette(ui.visuals());
    let color = if note.verdict == "unreliable" { palette.bad } else { palette.caution };
    ui.add_space(4.0);
    let text = format!("This geometry is {}, and the file says so.", note.verdict);
    let reasons = note.reasons.join("\n");
    let label = ui.add(Label::new(RichText::new(text).color(color).strong()).wrap());
    if !reasons.is_empty() {
        label.on_hover_text(&reasons);
        let first: String = note.reasons.first().cloned().unwrap_or_default();
        ui.add(Label::new(RichText::new(first).color(color).small()).wrap());
    }
}

/// Shows a labelled option, aligned with the others.
fn row<R>(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui) -> R) {
    ui.horizontal(|ui| {
        row_label(ui, name);
        content(ui);
    });
}
