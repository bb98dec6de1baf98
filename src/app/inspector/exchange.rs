//! Exports, imports and commands about the rectified pair.

use std::path::{Path, PathBuf};

use egui::Context;

use super::Inspector;
use crate::app::model::comparison::Contestant;
use crate::app::model::document::{AS_READ, Checked, Given, Imported};
use crate::app::model::exchange::{
    ExportContent, ExportKind, ExportOrder, ImportQuestion, PendingImport, colmap, content, trust_note,
    undistorted,
};
use crate::app::model::messages::{MessageAction, MessageKind};
use crate::app::model::rectified::{Blink, RectifiedCommand, RectifiedLayout, RectifyOrder};
use crate::app::model::session::suggested_path;
use crate::app::model::{ExchangeCommand, Side};
use crate::app::tasks::saver;
use crate::app::view::{Destination, ImagePane, ReadingDialog, WantedView, excerpt, figure, screen_as_png};
use crate::io::{
    ImportFound, ImportSource, ImportedFile, ImportedMatrix, PairOrigin, RectifiedOptions, sources,
};
use crate::rectify::RectifyMethod;

const NOTHING_TO_EXPORT: &str = "There is nothing to export yet: open two images first.";

impl Inspector {
    /// Applies a command about files of other programs.
    pub(super) fn apply_to_exchange(&mut self, ctx: &Context, command: ExchangeCommand) {
        match command {
            ExchangeCommand::ShowExport(what) => self.show_file_export(what),
            ExchangeCommand::Export(order) => self.export_file(order),
            ExchangeCommand::CopyFundamental(notation) => {
                if let Some(shown) = self.model.geometry_to_write() {
                    let (pictures, trust) = (self.model.open.pictures_of(), trust_note(&self.model));
                    ctx.copy_text(notation.text(shown.fundamental, &pictures, trust.as_ref()));
                    let of =
                        if pictures.is_undistorted() { " of the pictures without distortion" } else { "" };
                    self.model.open.done.tell(format!("Copied F{of} as {}", notation.name()));
                }
            }
            ExchangeCommand::Import(paths) => self.import(paths),
            ExchangeCommand::Accept { reading, with_pairs } => self.accept(reading, with_pairs),
            ExchangeCommand::Reject => self.view.dialogs.reading = None,
            ExchangeCommand::RemoveGiven => self.model.edit(|document| document.given = None),
            ExchangeCommand::EditGiven => self.model.edit_given(),
            ExchangeCommand::GiveImported(file) => self.model.give_imported(&file),
            ExchangeCommand::RemoveImported => {
                self.model.edit(|document| document.imported = None);
                self.model.open.focus.choose_hypothesis(None);
            }
        }
    }

    /// Shows the export dialog. It suggests a path beside the left image, named after both images.
    fn show_file_export(&mut self, what: Option<ExportKind>) {
        let Some(pictures) = &self.model.open.pictures else {
            return self.model.messages.tell(NOTHING_TO_EXPORT);
        };
        self.view.dialogs.export.show_with(suggested_path(pictures).with_extension(""), what);
    }

    fn export_file(&mut self, order: ExportOrder) {
        self.view.dialogs.export.close();
        if order.what == ExportKind::View {
            self.view.capture = Some(WantedView::new(Destination::File(order.path)));
            return;
        }
        if order.what == ExportKind::Rectified {
            return self.export_rectified(order.path, order.rectified);
        }
        if order.what == ExportKind::Undistorted {
            let work = undistorted(&self.model, order.path.clone());
            return self.write_by(order.path, work);
        }
        if order.what == ExportKind::Colmap {
            let work = colmap(&order, &self.model, self.image_files());
            return self.write_by(order.path, work);
        }
        if order.what == ExportKind::Figure {
            let panes = self.view.panes.each_ref().map(ImagePane::place);
            return match figure(&self.model, panes, &order.figure) {
                Some(content) => self.write(order.path, "the figure".to_owned(), content),
                None => self.model.messages.tell(NOTHING_TO_EXPORT),
            };
        }
        // A polar rectification has no homographies.
        let rectified = self.model.rectify_question();
        let rectified = rectified.filter(|question| question.method != RectifyMethod::Polar);
        match content(&order, &self.model, rectified) {
            Ok((content, what)) => self.write(order.path, what, content),
            Err(problem) => self.model.messages.tell(problem),
        }
    }

    /// Tells that an export failed: in its dialog, or in a message once the user may be doing something else.
    pub(super) fn refuse_export(&mut self, problem: String) {
        let dialogs = &mut self.view.dialogs;
        if dialogs.export.is_awaited() && !dialogs.is_open() {
            return dialogs.export.refuse(problem);
        }
        let again =
            MessageAction { label: "Export again", command: ExchangeCommand::ShowExport(None).into() };
        self.model.messages.say(MessageKind::Problem, problem, vec![again]);
    }

    fn write(&mut self, path: PathBuf, what: String, content: ExportContent) {
        self.tasks.saver.ask(saver::export(path, what, content, self.image_files()));
    }

    /// Runs work that writes by itself.
    fn write_by(
        &mut self,
        path: PathBuf,
        work: Option<impl FnOnce() -> Result<String, String> + Send + 'static>,
    ) {
        match work {
            Some(work) => {
                self.tasks.saver.ask(saver::export_by(path, work));
            }
            None => self.model.messages.tell(NOTHING_TO_EXPORT),
        }
    }

    /// Requests the picture of a view in the next frame, and writes the picture once it is there.
    pub(super) fn capture(&mut self, ctx: &Context) {
        let Some((to, picture)) = WantedView::poll(&mut self.view.capture, ctx) else { return };
        let Some(screen) = picture else {
            let text = "The picture could not be made, because the screen could not be read. Try again.";
            return self.model.messages.tell(text);
        };
        let (part, scale) = (self.view.images, ctx.pixels_per_point());
        match to {
            Destination::File(path) => {
                let content = screen_as_png(screen, part, scale, trust_note(&self.model));
                self.write(path, "the view".to_owned(), content);
            }
            Destination::Clipboard => {
                ctx.copy_image(excerpt(&screen, part, scale));
                self.model.open.done.tell("Copied the view");
            }
        }
    }

    /// Queues files for import. They wait until images are open and no dialog is open.
    pub(super) fn import(&mut self, paths: Vec<PathBuf>) {
        self.model.imports.extend(sources(paths).into_iter().map(PendingImport::from));
    }

    /// Imports a file that was opened as a session but is none.
    pub(super) fn import_instead(&mut self, path: &Path, problem: String) {
        if self.model.open.pictures.is_none() {
            return self
                .refuse(format!("{problem}. To import the file as a geometry, open its two images first."));
        }
        let source = ImportSource::File(path.to_owned());
        self.model.imports.push_back(PendingImport { source, prelude: Some(problem) });
    }

    /// Handles a finished import, and begins the next one once nothing else comes first.
    pub(super) fn take_imports(&mut self) {
        let failed = |panic| Err(format!("The file could not be imported: {panic}. Nothing was changed."));
        match self.tasks.importing.poll().map(|(_, answer)| answer.unwrap_or_else(failed)) {
            Some(Ok(ImportedFile::Geometry(found))) => self.take_found(*found),
            Some(Ok(ImportedFile::Calibration { name, cameras })) => self.calibrate(&name, &cameras),
            Some(Err(problem)) => self.refuse(problem),
            None => {}
        }
        let asks = self.view.dialogs.reading.is_some();
        if self.tasks.loader.is_busy() || self.tasks.importing.is_busy() || asks {
            return;
        }
        let Some(pending) = self.model.imports.pop_front() else { return };
        let Some(frames) = self.model.document.frames() else {
            return self.refuse(format!("To import {}, open its two images first.", pending.source.name()));
        };
        let matches = self.model.matches_for_import();
        let shown = self.model.open.pictures.as_ref();
        let shown = shown.map_or(frames, |pictures| pictures.each_ref().map(|opened| opened.shown().frame()));
        let views = self.model.open.undistorted();
        self.tasks.importing.ask(ImportQuestion { pending, frames, shown, views, matches });
    }

    pub(super) fn apply_to_rectified(&mut self, ctx: &Context, command: RectifiedCommand) {
        let model = &mut self.model;
        let shown = model.open.viewing.blink.shown(ctx.input(|input| input.time)).0;
        match command {
            RectifiedCommand::SetMethod(method) => {
                model.edit(|document| document.rectification = method);
            }
            RectifiedCommand::LayOut(layout) => model.look.rectified.layout = layout,
            RectifiedCommand::ToggleTurned => model.look.rectified.as_in_the_file ^= true,
            RectifiedCommand::ToggleGuides => model.look.rectified.hides_guides ^= true,
            RectifiedCommand::View(view) => model.open.viewing.view = view,
            RectifiedCommand::Shift(shift) => model.open.viewing.shift = shift,
            RectifiedCommand::Swap if model.wants_rectified() => {
                // From other layouts, the first press shows the left picture and the next the right
                // one.
                let blinks = model.look.rectified.layout == RectifiedLayout::Blink;
                model.open.viewing.blink = Blink::Still(if blinks { shown.other() } else { Side::Left });
                model.look.rectified.layout = RectifiedLayout::Blink;
            }
            RectifiedCommand::Swap => {}
            RectifiedCommand::RunBlink => {
                model.open.viewing.blink = match model.open.viewing.blink {
                    Blink::Running => Blink::Still(shown),
                    Blink::Still(_) => Blink::Running,
                };
            }
            RectifiedCommand::ShowExport => self.show_file_export(Some(ExportKind::Rectified)),
            RectifiedCommand::StopExport => self.tasks.writing.stop(),
        }
    }

    fn export_rectified(&mut self, folder: PathBuf, options: RectifiedOptions) {
        let Some(question) = self.model.rectify_question() else { return };
        let trust = trust_note(&self.model);
        if let Some(progress) = self.tasks.writing.begin(RectifyOrder { question, folder, options, trust }) {
            self.model.activity.writing = Some(progress);
        } else {
            let text = "A rectified pair is already being written. Wait for it, or stop it.";
            self.model.messages.tell(text);
        }
    }

    /// Places imported point pairs at once, and shows the dialog for a matrix.
    fn take_found(&mut self, mut found: ImportFound) {
        self.view.dialogs.open.open = false;
        self.model.messages.remark(std::mem::take(&mut found.notes));
        let given = std::mem::take(&mut found.matches);
        if !given.is_empty() {
            self.model.take_given(Given::new(found.name.clone(), given));
        }
        if let Some(matrix) = found.matrix.take() {
            let has_pairs = !self.model.document.pairs.is_empty();
            self.view.dialogs.reading = Some(ReadingDialog::new(found, matrix, has_pairs));
            return;
        }
        if !found.pairs.is_empty() {
            self.model.take_pairs(&found.name, found.pairs);
        }
    }

    /// Accepts the matrix of the dialog.
    fn accept(&mut self, reading: Option<usize>, with_pairs: bool) {
        let Some(dialog) = self.view.dialogs.reading.take() else { return };
        let ImportedMatrix { fundamental, cameras, check, matches, .. } = dialog.matrix();
        let name = dialog.found().name.clone();
        let ranked = check.as_ref().zip(reading).and_then(|(check, place)| check.readings.get(place));
        let checked = check.as_ref().zip(ranked).map(|(check, ranked)| Checked {
            matches: check.matches,
            of: (*matches).to_owned(),
            // Session files cannot store infinity.
            median: ranked.median.min(1e9),
            fits: ranked.median <= check.limit,
        });
        let read = ranked.map_or(*fundamental, |ranked| ranked.fundamental);
        let imported = Imported {
            fundamental: read,
            // In another convention the matrix no longer belongs to the cameras.
            cameras: cameras.filter(|_| read == *fundamental),
            file: name.clone(),
            reading: ranked.map_or_else(|| AS_READ.to_owned(), |ranked| ranked.reading.to_string()),
            check: checked,
        };
        let pairs = with_pairs.then(|| dialog.found().pairs.clone()).filter(|pairs| !pairs.is_empty());
        let has_pairs = pairs.is_some();
        self.model.edit(|document| {
            document.imported = Some(imported);
            if let Some(pairs) = pairs {
                document.set_pairs(pairs, PairOrigin::Imported);
            }
        });
        if has_pairs {
            self.model.tell_of_pairs(&name);
        }
        // Without a result, the imported geometry is shown anyway, until there is a first result.
        if self.model.result().is_some() {
            self.model.open.focus.choose_contestant(Contestant::Imported);
        }
        self.model.open.done.tell(format!("Imported a geometry from {name}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Start;
    use crate::app::tasks::Services;

    #[test]
    fn an_export_that_fails_late_waits_in_a_message() {
        let mut inspector = Inspector::new(Start::default(), Services::default());
        inspector.view.dialogs.export.close();
        inspector.refuse_export("At once.".into());
        assert!(inspector.view.dialogs.export.open && inspector.messages().next().is_none());
        inspector.view.dialogs.export.open = false;
        inspector.view.dialogs.palette.open = true;
        inspector.refuse_export("Late.".into());
        assert!(!inspector.view.dialogs.export.open);
        let told = inspector.model.messages.on_top().next().unwrap();
        assert_eq!((&*told.text, told.actions[0].label), ("Late.", "Export again"));
    }
}
