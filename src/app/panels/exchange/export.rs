//! The window for exporting: what, in which format, and where to.

use std::path::{Path, PathBuf};

use egui::{Align2, Button, ComboBox, Key, Label, RichText, TextEdit, Ui, Window, vec2};

use super::super::open_dialog::path_of;
use super::super::{command_button, finish_button};
use crate::app::command::Command;
use crate::app::exchange::{ExchangeCommand, Order, PROFILE_CONVENTION, Reported, ViewPart, What};
use crate::app::rectified::RectifiedCommand;
use crate::app::scene::Scene;
use crate::io::Format;

/// Width of the names of the choices, screen points.
const LABEL_WIDTH: f32 = 84.0;

/// What has been chosen; it stays for the next time.
#[derive(Debug, Clone)]
pub struct FileExport {
    /// Whether it is shown.
    pub open: bool,
    order: Order,
    path: String,
    /// Where files of these images go unless something else is typed: the folder and the beginning of the name.
    begin: PathBuf,
    /// What was suggested last.
    suggested: String,
    just_opened: bool,
}

impl Default for FileExport {
    fn default() -> Self {
        let order = Order {
            path: PathBuf::new(),
            what: What::default(),
            format: Format::Json,
            with_matches: false,
            reported: Reported::default(),
            part: ViewPart::default(),
        };
        Self {
            open: false,
            order,
            path: String::new(),
            begin: PathBuf::new(),
            suggested: String::new(),
            just_opened: false,
        }
    }
}

impl FileExport {
    /// Shows it. `begin` is the path of an export of these images without its ending.
    pub fn show_with(&mut self, begin: PathBuf) {
        (self.open, self.just_opened) = (true, true);
        if begin != self.begin {
            (self.begin, self.path) = (begin, String::new());
        }
        self.suggest();
    }

    /// Fills in a path that was chosen.
    pub fn offer(&mut self, path: &Path) {
        self.path = path.display().to_string();
    }

    /// The ending of files of the kind that is chosen.
    fn extension(&self) -> &'static str {
        match self.order.what {
            What::Geometry | What::Pairs => self.order.format.extension(),
            What::Report if self.order.reported == Reported::Json => "json",
            What::Report => "txt",
            What::Profile => "csv",
            What::View => "png",
        }
    }

    /// Follows a choice: a path that nobody has typed becomes another one, of a typed one only the ending.
    fn suggest(&mut self) {
        let kind = match self.order.what {
            What::Geometry => "geometry",
            What::Pairs => "pairs",
            What::Report => "report",
            What::Profile => "profile",
            What::View => "view",
        };
        let untouched = self.path.trim().is_empty() || self.path == self.suggested;
        // A script is run by its name, which must be one of a variable there.
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

    /// Shows the window.
    pub fn show(&mut self, ctx: &egui::Context, scene: &Scene, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        let mut open = true;
        Window::new("Export")
            .open(&mut open)
            .collapsible(false)
            .resizable(false)
            .anchor(Align2::CENTER_CENTER, vec2(0.0, -40.0))
            .show(ctx, |ui| {
                ui.set_width(560.0);
                let before = (self.order.what, self.order.format, self.order.reported);
                row(ui, "What", |ui| self.kinds(ui, scene));
                ui.add(Label::new(RichText::new(self.order.what.tooltip()).weak()).wrap());
                ui.add_space(4.0);
                self.choices(ui, scene);
                if before != (self.order.what, self.order.format, self.order.reported) {
                    self.suggest();
                }
                ui.add_space(4.0);
                self.conventions(ui);
                ui.add_space(6.0);
                ui.horizontal(|ui| self.file_field(ui, commands));
                let path = path_of(&self.path);
                let replaces = path.as_ref().is_some_and(|path| path.exists());
                let missing = self.order.what.missing(scene);
                ui.label(match (missing, replaces) {
                    (Some(missing), _) => missing,
                    (None, true) => "There is a file of that name; it will be replaced.",
                    (None, false) => "",
                });
                ui.add_space(6.0);
                let order =
                    path.filter(|_| missing.is_none()).map(|path| Order { path, ..self.order.clone() });
                self.buttons(ui, scene, order, commands);
            });
        self.just_opened = false;
        self.open &= open;
    }

    fn kinds(&mut self, ui: &mut Ui, scene: &Scene) {
        for what in What::ALL {
            let missing = what.missing(scene);
            let button =
                ui.add_enabled(missing.is_none(), Button::selectable(self.order.what == what, what.name()));
            let button = button.on_hover_text(what.tooltip());
            if button.on_disabled_hover_text(missing.unwrap_or_default()).clicked() {
                self.order.what = what;
            }
        }
    }

    /// What there is to choose for the kind of file.
    fn choices(&mut self, ui: &mut Ui, scene: &Scene) {
        match self.order.what {
            What::Geometry | What::Pairs => {
                ui.horizontal(|ui| {
                    let label = ui.add_sized([LABEL_WIDTH, 26.0], Label::new("Format"));
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
                let count = scene.computation.result().map_or(0, |(estimate, _)| estimate.matches().len());
                if count > 0 {
                    row(ui, "", |ui| {
                        ui.checkbox(
                            &mut self.order.with_matches,
                            format!("Also the {count} matches that the result rests on"),
                        )
                    });
                }
            }
            What::Report => row(ui, "Format", |ui| {
                ui.radio_value(&mut self.order.reported, Reported::Text, "Plain text")
                    .on_hover_text("In words and figures, for people.");
                ui.radio_value(&mut self.order.reported, Reported::Json, "JSON")
                    .on_hover_text("As epiline estimate writes it; other programs and this one read it.");
            }),
            What::Profile => {}
            What::View => row(ui, "Part", |ui| {
                ui.radio_value(&mut self.order.part, ViewPart::Images, "Both images")
                    .on_hover_text("The two images with everything drawn over them.");
                ui.radio_value(&mut self.order.part, ViewPart::Window, "The whole window");
            }),
        }
    }

    /// How the numbers of the file are to be taken; every file says so itself.
    fn conventions(&self, ui: &mut Ui) {
        let sentences: Vec<String> = match self.order.what {
            What::Geometry => self.order.format.convention(),
            // What is said about F does not belong to points alone.
            What::Pairs => self.order.format.convention().into_iter().skip(1).take(2).collect(),
            What::Report => Format::Json.convention(),
            What::Profile => PROFILE_CONVENTION.map(str::to_owned).to_vec(),
            What::View => vec!["A PNG file of as many pixels as are on the screen.".to_owned()],
        };
        for sentence in sentences {
            ui.add(Label::new(RichText::new(sentence).weak().small()).wrap());
        }
    }

    fn file_field(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let label = ui.add_sized([LABEL_WIDTH, 26.0], Label::new("File"));
        let edit = TextEdit::singleline(&mut self.path).hint_text("path of the file").desired_width(370.0);
        let response = ui.add(edit).labelled_by(label.id);
        if self.just_opened {
            response.request_focus();
        }
        let browse = ui.button("Browse");
        browse.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Button, true, "Browse for the export file")
        });
        let suggested = path_of(&self.path).unwrap_or_else(|| PathBuf::from(&self.suggested));
        finish_button(ui, browse, Command::Exchange(ExchangeCommand::BrowseExport(suggested)), commands);
    }

    fn buttons(&mut self, ui: &mut Ui, scene: &Scene, order: Option<Order>, commands: &mut Vec<Command>) {
        let command = order.map(|order| Command::Exchange(ExchangeCommand::Export(order)));
        ui.horizontal(|ui| {
            let export = ui.add_enabled(command.is_some(), Button::new("Export this"));
            let described = command
                .clone()
                .unwrap_or_else(|| Command::Exchange(ExchangeCommand::Export(self.order.clone())));
            finish_button(ui, export, described, commands);
            command_button(ui, Command::Cancel, true, commands);
            let right = egui::Layout::right_to_left(egui::Align::Center);
            ui.with_layout(right, |ui| {
                let rectified = ui.add_enabled(scene.shown().is_some(), Button::new("Rectified pair…"));
                if finish_button(ui, rectified, Command::Rectified(RectifiedCommand::ShowExport), commands)
                    .clicked()
                {
                    self.open = false;
                }
            });
        });
        if ui.input(|input| input.key_pressed(Key::Enter)) {
            commands.extend(command);
        }
    }
}

/// A choice with its name, in line with the others.
fn row<R>(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui) -> R) {
    ui.horizontal(|ui| {
        ui.add_sized([LABEL_WIDTH, 26.0], Label::new(name));
        content(ui);
    });
}
