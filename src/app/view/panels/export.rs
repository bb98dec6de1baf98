//! The export dialog: content, format and file.

mod conventions;
mod options;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use egui::{Align, Button, Label, Layout, RichText, ScrollArea, Ui, vec2};

use super::copy_fundamental_menu;
use super::dialog::{PathField, dialog, ending, path_of};
use crate::app::model::command::PickPurpose;
use crate::app::model::exchange::{ExportKind, ExportOrder, FigureFormat, ReportFormat};
use crate::app::model::{Command, ExchangeCommand, Model};
use crate::app::view::theme;
use crate::io::{Format, has_extension};

/// Width of the dialog, of its list of kinds, and height of the options, screen points. They do not
/// depend on the kind, so that nothing moves under the cursor.
const WIDTH: f32 = 700.0;
const KINDS_WIDTH: f32 = 160.0;
const OPTIONS_HEIGHT: f32 = 310.0;

/// Time after an export during which nobody begins anything else. A failure within it opens the dialog again.
const AWAITED: Duration = Duration::from_secs(2);

/// Choices of the dialog, kept for the next time.
#[derive(Debug, Clone, Default)]
pub struct FileExport {
    pub open: bool,
    order: ExportOrder,
    path: String,
    /// Typed path of a database of COLMAP.
    database: String,
    /// Folder and stem of exports of the open images.
    images: PathBuf,
    /// Folder and stem of suggested file names: the folder of the latest typed path, and the stem of the images.
    begin: PathBuf,
    suggested: String,
    /// Path typed for each kind, in the order of [`ExportKind::all`].
    typed: [Option<PathBuf>; ExportKind::COUNT],
    /// Reason why the last export failed.
    problem: Option<String>,
    just_opened: bool,
    ordered: Option<Instant>,
}

impl FileExport {
    /// Opens the dialog, for this kind if there is one. `begin` is the folder and stem of exports of
    /// these images.
    pub fn show_with(&mut self, begin: PathBuf, what: Option<ExportKind>) {
        (self.open, self.just_opened, self.problem) = (true, true, None);
        // A folder that has gone is not proposed again.
        if begin != self.images || !has_folder(&self.begin) || !has_folder(Path::new(&self.path)) {
            (self.images, self.begin) = (begin.clone(), begin);
            self.typed = Default::default();
            self.path.clear();
        }
        self.choose(what.unwrap_or(self.order.what));
    }

    /// Closes the dialog, as its export has begun.
    pub fn close(&mut self) {
        (self.open, self.ordered) = (false, Some(Instant::now()));
    }

    /// Returns whether the last export has only just begun.
    pub fn is_awaited(&self) -> bool {
        self.ordered.is_some_and(|ordered| ordered.elapsed() < AWAITED)
    }

    /// Opens the dialog again as it was, with the reason why the export failed.
    pub fn refuse(&mut self, problem: String) {
        (self.open, self.just_opened, self.problem) = (true, true, Some(problem));
    }

    pub fn offer(&mut self, path: &Path) {
        self.path = path.display().to_string();
    }

    /// Fills in a database of COLMAP. The copy is suggested beside it.
    pub fn offer_database(&mut self, path: &Path) {
        self.database = path.display().to_string();
        self.note_typed();
        self.suggest();
    }

    /// Returns the file extension for the present choices; empty for a folder.
    fn extension(&self) -> &'static str {
        match self.order.what {
            ExportKind::Geometry | ExportKind::Plane | ExportKind::Pairs => self.order.format.extension(),
            ExportKind::Array => "npy",
            ExportKind::Report if self.order.reported == ReportFormat::Json => "json",
            ExportKind::Report => "txt",
            ExportKind::Table | ExportKind::Profile => "csv",
            ExportKind::Figure if self.order.figure.format == FigureFormat::Pdf => "pdf",
            ExportKind::Figure => "svg",
            ExportKind::Colmap => "db",
            ExportKind::View => "png",
            ExportKind::Cloud => "ply",
            ExportKind::Rectified | ExportKind::Undistorted => "",
        }
    }

    /// Keeps a typed path for its kind. Files of other kinds are suggested in the same folder.
    fn note_typed(&mut self) {
        let typed = path_of(&self.path).filter(|_| self.path != self.suggested);
        if let Some(typed) = &typed {
            self.begin = typed.with_file_name(self.images.file_name().unwrap_or_default());
        }
        self.typed[self.order.what as usize] = typed;
    }

    /// Updates the path after a choice: the path typed for this kind, or a name that no other kind
    /// has, both with the extension of the format.
    fn suggest(&mut self) {
        let kind = self.order.what.file_name();
        // MATLAB runs a script by its name, so the name must be a valid identifier.
        let separator = if self.extension() == Format::Matlab.extension() { '_' } else { '-' };
        let database = path_of(&self.database).filter(|_| self.order.what == ExportKind::Colmap);
        let begin = database.map_or_else(|| self.begin.clone(), |database| database.with_extension(""));
        let stem = begin.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let mut name = format!("{stem}{separator}{kind}");
        if separator == '_' {
            name = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
            if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
                name.insert(0, 'e');
            }
        }
        let own = begin.with_file_name(name).with_added_extension(self.extension());
        self.suggested = own.display().to_string();
        self.path = match &self.typed[self.order.what as usize] {
            Some(typed) if self.extension().is_empty() => typed.display().to_string(),
            Some(typed) => typed.with_extension(self.extension()).display().to_string(),
            None => self.suggested.clone(),
        };
    }

    /// Returns the path with the extension of its kind, if it has none.
    fn completed(&self, path: PathBuf) -> PathBuf {
        if path.extension().is_some() || path.is_dir() {
            return path;
        }
        path.with_added_extension(self.extension())
    }

    /// Takes the format that the ending of the path names.
    fn follow_ending(&mut self) {
        let Some(path) = path_of(&self.path) else { return };
        let (order, ends) = (&mut self.order, |with| has_extension(&path, &[with]));
        match order.what {
            ExportKind::Geometry | ExportKind::Plane | ExportKind::Pairs => {
                order.format = Format::of_path(&path).unwrap_or(order.format);
            }
            ExportKind::Report if ends("json") => order.reported = ReportFormat::Json,
            ExportKind::Report if ends("txt") => order.reported = ReportFormat::Text,
            ExportKind::Figure if ends("pdf") => order.figure.format = FigureFormat::Pdf,
            ExportKind::Figure if ends("svg") => order.figure.format = FigureFormat::Svg,
            _ => {}
        }
    }

    fn choose(&mut self, what: ExportKind) {
        self.problem = None;
        self.note_typed();
        self.order.what = what;
        self.suggest();
    }

    pub fn show(&mut self, ctx: &egui::Context, model: &Model, commands: &mut Vec<Command>) {
        if !self.open {
            return;
        }
        if !self.order.what.is_offered(model) {
            self.choose(ExportKind::default());
        }
        let open = dialog(ctx, "Export", WIDTH, |ui| {
            // The separator takes all the height of its row.
            let row = vec2(ui.available_width(), OPTIONS_HEIGHT);
            ui.allocate_ui_with_layout(row, Layout::left_to_right(Align::Min), |ui| {
                ui.vertical(|ui| {
                    ui.set_width(KINDS_WIDTH);
                    self.kinds(ui, model);
                });
                ui.separator();
                let options = ScrollArea::vertical().id_salt(self.order.what).max_height(OPTIONS_HEIGHT);
                options
                    .min_scrolled_height(OPTIONS_HEIGHT)
                    .auto_shrink(false)
                    .show(ui, |ui| ui.vertical(|ui| self.options(ui, model, commands)));
            });
            ui.separator();
            let suggested = path_of(&self.path).unwrap_or_else(|| PathBuf::from(&self.suggested));
            let is_folder = self.order.what.is_folder();
            let (name, hint, browse, purpose) = if is_folder {
                let hint = "path of the folder, created if missing";
                ("Folder", hint, "Browse for the export folder", PickPurpose::Export)
            } else {
                ("File", "path of the file", "Browse for the export file", PickPurpose::ExportFile(suggested))
            };
            let file = PathField { name, hint, width: 500.0, browse, purpose };
            let file = file.show(ui, &mut self.path, commands);
            if self.just_opened {
                file.request_focus();
            }
            if file.changed() {
                self.problem = None;
            }
            self.follow_ending();
            let path = path_of(&self.path).map(|path| self.completed(path));
            let missing = self.order.what.missing(model);
            let missing = missing.or_else(|| other_ending(path.as_deref()?, self.extension()));
            let database = path_of(&self.database);
            let lacks_database = self.order.what == ExportKind::Colmap && database.is_none();
            let missing = missing.or(lacks_database.then_some("Choose the database that has both pictures."));
            let replaces = !is_folder && path.as_ref().is_some_and(|path| path.exists());
            let palette = theme::palette(ui.visuals());
            let note = match (&self.problem, missing) {
                (Some(problem), _) => RichText::new(problem).color(palette.bad),
                (None, Some(missing)) => RichText::new(missing),
                (None, None) if replaces => RichText::new("A file of that name exists and will be replaced.")
                    .color(palette.caution)
                    .strong(),
                (None, None) => RichText::new(""),
            };
            ui.add(Label::new(note).wrap());
            ui.add_space(6.0);
            let database = database.unwrap_or_default();
            let order = path.filter(|_| missing.is_none()).map(|path| ExportOrder {
                path,
                database,
                ..self.order.clone()
            });
            self.buttons(ui, model, order, commands);
        });
        self.just_opened = false;
        self.open &= open;
    }

    fn kinds(&mut self, ui: &mut Ui, model: &Model) {
        for what in ExportKind::all().filter(|what| what.is_offered(model)) {
            let missing = what.missing(model);
            let button = Button::selectable(self.order.what == what, what.name());
            let button = ui.add_enabled(missing.is_none(), button);
            let button = button.on_hover_text(what.tooltip());
            if button.on_disabled_hover_text(missing.unwrap_or_default()).clicked() {
                self.choose(what);
            }
        }
    }

    /// Shows the description, the options and the conventions of the chosen kind.
    fn options(&mut self, ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
        ui.add(Label::new(RichText::new(self.order.what.tooltip()).weak()).wrap());
        ui.add_space(4.0);
        let formats = |order: &ExportOrder| (order.format, order.reported, order.figure.format);
        let before = (formats(&self.order), self.database.clone());
        options::options(ui, &mut self.order, &mut self.database, model, commands);
        if before != (formats(&self.order), self.database.clone()) {
            self.problem = None;
            self.note_typed();
            self.suggest();
        }
        ui.add_space(4.0);
        conventions::conventions(ui, &self.order, model);
        conventions::trust(ui, self.order.what, model);
    }

    fn buttons(&self, ui: &mut Ui, model: &Model, order: Option<ExportOrder>, commands: &mut Vec<Command>) {
        let command = order.map(|order| ExchangeCommand::Export(order).into());
        ui.horizontal(|ui| {
            let described = ExchangeCommand::Export(self.order.clone()).into();
            let text = match self.order.what {
                ExportKind::Rectified => "Export rectified pair",
                ExportKind::Undistorted => "Export pictures",
                _ => "Export file",
            };
            ending(ui, text, command, described, commands);
            copy_fundamental_menu(ui, model, commands);
        });
    }
}

/// Tells that a new file or folder would have the ending of another kind of file. A folder has no ending of its own.
fn other_ending(path: &Path, own: &str) -> Option<&'static str> {
    let others = ["csv", "db", "mat", "npy", "npz", "pdf", "ply", "png", "svg", "tiff", "xml", "yaml"];
    let files: Vec<&str> = Format::ALL.into_iter().map(Format::extension).chain(others).collect();
    let is_own = has_extension(path, &[own]) || Format::of_path(path).is_some_and(|of| of.extension() == own);
    if !has_extension(path, &files) || is_own || path.is_dir() {
        return None;
    }
    Some(if own.is_empty() {
        "This export is a folder, and this name ends like that of a file. Choose another kind on the left, or a \
         name without this ending."
    } else {
        "The ending of the name belongs to another kind of file. Choose another ending, or another kind on the \
         left."
    })
}

/// Returns whether a file can be created at a path, as far as its folder matters.
fn has_folder(path: &Path) -> bool {
    path.parent().is_none_or(|folder| folder.as_os_str().is_empty() || folder.is_dir())
}
