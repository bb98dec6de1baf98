//! Taking in what the threads have done.

use std::sync::mpsc::TryRecvError;
use std::time::Duration;

use super::{Inspector, PickPurpose};
use crate::app::document::{Document, PictureIdentity, Side};
use crate::app::history::History;
use crate::app::loader::{Failure, Pair};
use crate::app::rectified::Viewing;

/// A system dialog that returns sooner than this cannot have been seen by anybody.
const DIALOG_UNSEEN: Duration = Duration::from_millis(150);

impl Inspector {
    pub(super) fn take_news(&mut self, ctx: &egui::Context) {
        self.computation.take_news();
        self.matcher.take_news();
        self.comparing.take_news();
        self.rectifying.take_news();
        if let Some(ending) = self.writing.poll() {
            match ending {
                Ok(text) => self.say(text, true, Vec::new()),
                Err(text) => self.tell(text),
            }
        }
        if self.revision != self.computation.revision() {
            // Numbers of hypotheses belong to one result.
            self.revision = self.computation.revision();
            self.focus.forget_hypothesis();
        }
        match self.loader.poll() {
            Some(Ok(pair)) => self.show_pictures(ctx, pair),
            Some(Err(failure)) => {
                self.start_pairs.clear();
                self.forget_imports();
                self.wanted = None;
                match failure {
                    Failure::Text(text) => self.tell(text),
                    Failure::NoSession { path, problem } => self.import_instead(&path, problem),
                    Failure::Relocate(relocation) => self.ask_for_images(*relocation),
                }
            }
            None => {}
        }
        self.take_session_news();
        self.take_imports();
        let picked =
            self.picking.as_ref().map(|picking| (picking.purpose.clone(), picking.answer.try_recv()));
        match picked {
            None | Some((_, Err(TryRecvError::Empty))) => return,
            Some((purpose, Ok((Some(path), _)))) => match purpose {
                PickPurpose::Image(side) => {
                    self.open_dialog.offer(&path, Some(side));
                }
                PickPurpose::Folder => self.open_dialog.offer_folder(&path),
                PickPurpose::Export => self.export_dialog.offer(&path),
                PickPurpose::ExportFile(_) => self.file_export.offer(&path),
                PickPurpose::Import => self.open_dialog.offer_import(&path),
                PickPurpose::Session(_) => {
                    if let Some(dialog) = &mut self.save_dialog {
                        dialog.offer(&path);
                    }
                }
                PickPurpose::Lost(side) => self.offer_lost(side, &path),
            },
            Some((_, Ok((None, elapsed)))) if elapsed > DIALOG_UNSEEN => {}
            Some(_) => self.tell(
                "The file dialog could not be opened here. Type a path, or drop the files on this window."
                    .into(),
            ),
        }
        self.picking = None;
    }

    /// Takes opened pictures in: a new document, with the parameters as they were.
    pub(super) fn show_pictures(&mut self, ctx: &egui::Context, pair: Pair) {
        let set_aside = self.set_aside();
        for (pane, opened) in self.panes.iter_mut().zip(&pair.pictures) {
            pane.set_picture(ctx, opened);
        }
        let identities =
            pair.pictures.each_ref().map(|opened| PictureIdentity::from(opened.picture.as_ref()));
        self.document = Document::new(identities, self.document.parameters.clone());
        self.document.truth =
            pair.known.as_ref().filter(|_| pair.uses_truth).map(|known| known.source.clone());
        self.known = pair.known;
        self.wanted = None;
        self.comparing.forget();
        self.rectifying.forget();
        self.exchange.forget();
        self.reading_dialog = None;
        self.viewing = Viewing::default();
        self.history = History::default();
        self.pictures = Some(pair.pictures);
        self.show_me = pair.show_me;
        self.opening += 1;
        self.hover = None;
        self.focus.clear();
        self.placed = None;
        let pairs = std::mem::take(&mut self.start_pairs);
        let (inside, outside): (Vec<_>, Vec<_>) = pairs.into_iter().partition(|pair| {
            let [frame1, frame2] = Side::BOTH.map(|side| self.document.frame(side));
            pair.is_finite()
                && frame1.is_some_and(|frame| frame.contains(pair.point1))
                && frame2.is_some_and(|frame| frame.contains(pair.point2))
        });
        if !outside.is_empty() {
            self.tell(format!(
                "{} of the point pairs given lie outside the images and were left out. Click them instead.",
                outside.len()
            ));
        }
        self.document.set_pairs(inside);
        self.begin_session(pair.restored);
        if set_aside {
            self.offer_left_behind();
        }
    }
}
