//! Files from and for other programs in the window: what is exported, and what becomes of imports.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use egui::{Context, Rect};

use super::{Inspector, PickPurpose};
use crate::app::comparison::Contestant;
use crate::app::computation::Freshness;
use crate::app::document::{Checked, Imported};
use crate::app::exchange::{
    Capturing, Content, ExchangeCommand, Found, Importing, Matrix, Order, Pending, Question, Source, What,
    content, picture, sources,
};
use crate::app::history::Step;
use crate::app::panels::ReadingDialog;
use crate::app::rectified::Matches;
use crate::app::session::{Job, suggested_path};
use crate::app::waker::Waker;
use crate::convention::FEWEST_MATCHES;
use crate::estimate::Estimate;
use crate::rectify;

/// What is under way with files of other programs.
pub(super) struct ExchangeState {
    importing: Importing,
    /// What waits to be imported, until images are open and nothing is asked.
    queue: VecDeque<Pending>,
    pub(super) capturing: Capturing,
    /// Where both images are in the window, screen points.
    pub(super) images: Option<Rect>,
    /// The imported geometry of the document in the form of a result that nobody computed.
    pub(super) imported: Option<Estimate>,
}

impl ExchangeState {
    /// Imports these files once images are open.
    pub(super) fn new(waker: Waker, imports: Vec<PathBuf>) -> Self {
        let mut state = Self {
            importing: Importing::new(waker),
            queue: VecDeque::new(),
            capturing: Capturing::default(),
            images: None,
            imported: None,
        };
        state.enqueue(imports);
        state
    }

    fn enqueue(&mut self, paths: Vec<PathBuf>) {
        let pending = |source| Pending { source, prelude: None };
        self.queue.extend(sources(paths).into_iter().map(pending));
    }

    pub(super) fn is_busy(&self) -> bool {
        self.importing.is_busy()
    }

    /// Drops what was about the images before; what waits is for those that come.
    pub(super) fn forget(&mut self) {
        self.importing.forget();
    }
}

impl Inspector {
    /// Does what a command about files of other programs says.
    pub(super) fn apply_to_exchange(&mut self, command: ExchangeCommand) {
        match command {
            ExchangeCommand::ShowExport => self.show_file_export(),
            ExchangeCommand::BrowseExport(suggested) => self.pick(PickPurpose::ExportFile(suggested)),
            ExchangeCommand::Export(order) => self.export_file(order),
            ExchangeCommand::BrowseImport => self.pick(PickPurpose::Import),
            ExchangeCommand::Import(paths) => {
                self.open_dialog.open = false;
                self.exchange.enqueue(paths);
            }
            ExchangeCommand::Accept { reading, with_pairs } => self.accept(reading, with_pairs),
            ExchangeCommand::Reject => self.reading_dialog = None,
            ExchangeCommand::RemoveImported => {
                self.edit(Step::Single, |document| document.imported = None);
                self.focus.choose_hypothesis(None);
            }
        }
    }

    /// Asks what to write and where: beside the left image, called after both.
    fn show_file_export(&mut self) {
        let Some(pictures) = &self.pictures else {
            self.tell("There is nothing to export yet: open two images first.".into());
            return;
        };
        let begin = suggested_path(pictures).with_extension("");
        self.file_export.show_with(begin);
    }

    fn export_file(&mut self, order: Order) {
        self.file_export.open = false;
        if order.what == What::View {
            self.exchange.capturing.begin(order.path, order.part);
            return;
        }
        // A polar rectification has no homographies.
        let rectified = self.to_rectify().filter(|question| question.method != rectify::Method::Polar);
        match content(&order, &self.scene(), rectified) {
            Ok((content, what)) => self.write(order.path, what, content),
            Err(problem) => self.tell(problem),
        }
    }

    fn write(&mut self, path: PathBuf, what: String, content: Content) {
        self.session.ask(Job::Export { path, what, content });
    }

    /// Asks for the picture of a view, in the frame that is about to be drawn, and has it written once it is there.
    pub(super) fn capture(&mut self, ctx: &Context) {
        self.exchange.capturing.ask(ctx, &self.waker);
        let Some(captured) = self.exchange.capturing.poll(ctx) else { return };
        let Some((screen, part)) = captured.picture else {
            self.tell("The view could not be exported: the screen gave no picture. Try again.".into());
            return;
        };
        let part = self.exchange.images.filter(|_| part == crate::app::exchange::ViewPart::Images);
        let content = picture(screen, part, ctx.pixels_per_point());
        self.write(captured.path, "the view".to_owned(), content);
    }

    /// A file that was opened as a session and is none.
    pub(super) fn import_instead(&mut self, path: &Path, problem: String) {
        if self.pictures.is_none() {
            self.tell(format!("{problem}. To import it as a geometry, open its two images first."));
            return;
        }
        let source = Source::File(path.to_owned());
        self.exchange.queue.push_back(Pending { source, prelude: Some(problem) });
    }

    /// Forgets what waits to be imported: its images could not be opened.
    pub(super) fn forget_imports(&mut self) {
        self.exchange.queue.clear();
    }

    /// Begins the next import, once nothing else is to be done before, and takes in what was read.
    pub(super) fn take_imports(&mut self) {
        if let Some(answer) = self.exchange.importing.poll() {
            match answer {
                Ok(found) => self.take_found(found),
                Err(problem) => self.tell(problem),
            }
        }
        let waits =
            self.loader.is_busy() || self.exchange.importing.is_busy() || self.reading_dialog.is_some();
        if waits {
            return;
        }
        let Some(pending) = self.exchange.queue.pop_front() else { return };
        let Some(pictures) = &self.document.pictures else {
            let name = pending.source.name();
            self.tell(format!("To import {name}, open the two images that it is about first."));
            return;
        };
        let frames = pictures.each_ref().map(|picture| picture.frame);
        let matches = self.matches_at_hand();
        self.exchange.importing.begin(Question { pending, frames, matches });
    }

    /// The matches that can tell what a matrix means: known ones, else those that a person clicked, else those of the
    /// result. That known ones are used shows nothing of them.
    fn matches_at_hand(&self) -> Matches {
        if let Some(known) = self.known.as_ref().filter(|known| known.truth.matches.len() >= FEWEST_MATCHES) {
            return Matches::True(std::sync::Arc::clone(&known.truth));
        }
        let document = &self.document;
        let clicked = document.pairs.iter().enumerate().filter(|(k, _)| !document.excluded.contains(k));
        let clicked: Vec<_> = clicked.map(|(_, pair)| *pair).collect();
        let found = self.computation.result().filter(|(_, freshness)| *freshness == Freshness::Final);
        match found {
            Some((estimate, _))
                if clicked.len() < FEWEST_MATCHES && estimate.matches().len() >= FEWEST_MATCHES =>
            {
                Matches::Found(estimate.matches().iter().map(|found| found.pair).collect())
            }
            _ => Matches::Clicked(clicked),
        }
    }

    /// Point pairs are placed at once; a matrix is asked about.
    fn take_found(&mut self, mut found: Found) {
        for note in std::mem::take(&mut found.notes) {
            self.tell(note);
        }
        if let Some(matrix) = found.matrix.take() {
            let has_pairs = !self.document.pairs.is_empty();
            self.reading_dialog = Some(ReadingDialog::new(found, matrix, has_pairs));
            return;
        }
        let count = found.pairs.len();
        self.edit(Step::Single, |document| document.set_pairs(found.pairs));
        let plural = if count == 1 { "" } else { "s" };
        self.done = Some(format!("Imported {count} point pair{plural} from {}", found.name));
    }

    /// Takes the matrix that is asked about.
    fn accept(&mut self, reading: Option<usize>, with_pairs: bool) {
        let Some(dialog) = self.reading_dialog.take() else { return };
        let Matrix { fundamental, check, matches, .. } = dialog.matrix();
        let name = dialog.found().name.clone();
        let ranked = check.as_ref().and_then(|check| match reading {
            Some(place) => check.readings.get(place),
            None => check.as_read(),
        });
        let checked = check.as_ref().zip(ranked).map(|(check, ranked)| Checked {
            matches: check.matches,
            of: (*matches).to_owned(),
            // Infinity is no number of a session file.
            median: ranked.median.min(1e9),
            fits: ranked.median <= check.limit,
        });
        let imported = Imported {
            fundamental: ranked.map_or(*fundamental, |ranked| ranked.fundamental),
            file: name.clone(),
            reading: ranked.map_or_else(|| "as read".to_owned(), |ranked| ranked.reading.to_string()),
            check: checked,
        };
        let pairs = with_pairs.then(|| dialog.found().pairs.clone()).filter(|pairs| !pairs.is_empty());
        let what = pairs.as_ref().map_or(String::new(), |pairs| format!(" and {} point pairs", pairs.len()));
        self.edit(Step::Single, |document| {
            document.imported = Some(imported);
            if let Some(pairs) = pairs {
                document.set_pairs(pairs);
            }
        });
        self.focus.choose_contestant(Contestant::Imported);
        self.done = Some(format!("Imported a geometry{what} from {name}"));
    }

    /// Brings the imported geometry that is drawn in line with the document.
    pub(super) fn follow_imported(&mut self) {
        let wanted = self.document.imported.as_ref().map(|imported| imported.fundamental);
        let own = self.exchange.imported.as_ref().map(|estimate| *estimate.fundamental());
        if wanted != own {
            self.exchange.imported = wanted.map(Estimate::from);
        }
    }
}
