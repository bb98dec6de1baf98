//! Sessions: saving, opening, copies of unsaved work, and copies left behind by a crash.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::Inspector;
use crate::app::model::SessionCommand;
use crate::app::model::exchange::result_note;
use crate::app::model::history::History;
use crate::app::model::left_behind::LeftBehind;
use crate::app::model::look::Tool;
use crate::app::model::messages::{MessageAction, MessageKind};
use crate::app::model::session::{Restored, SessionOwner, Work, suggested_path};
use crate::app::tasks::saver::{self, Written};
use crate::app::view::SaveDialog;
use crate::io::Autosave;

/// Interval of copies of unsaved work. Including the time for writing, no edit stays without a copy
/// for more than two seconds.
const AUTOSAVE_EVERY: Duration = Duration::from_millis(1500);

/// Maximum time that the window waits for a disk.
const PATIENCE: Duration = Duration::from_secs(3);

impl Inspector {
    fn work(&self) -> Work {
        self.model.work(self.view.views())
    }

    /// Returns whether there is unsaved work on the user's own files. Clicks on the sample can be
    /// made again.
    fn has_own_unsaved_work(&self) -> bool {
        self.model.document.is_of_files() && self.model.has_unsaved_work()
    }

    /// Lists the copies of unsaved work. The card of the start offers the newest one, the dialog for opening all.
    pub(super) fn offer_left_behind(&mut self) {
        let copies = self.tasks.autosave.iter().flat_map(Autosave::left_behind);
        self.model.left_behind = copies.filter_map(LeftBehind::read).collect();
    }

    pub(super) fn apply_to_session(&mut self, command: SessionCommand) {
        match command {
            SessionCommand::Save => match self.model.session.path.clone() {
                Some(path) if self.model.session.is_changed_by_others(&path) => {
                    self.ask_before_replacing(path);
                }
                Some(path) => self.save(path),
                None => self.show_save_dialog(),
            },
            SessionCommand::SaveAs => self.show_save_dialog(),
            SessionCommand::SaveTo(path) => self.save(path),
            SessionCommand::Open(session) => self.open_session(session),
            SessionCommand::DiscardLeftBehind(path) => {
                self.settle_left_behind(&path);
                self.offer_left_behind();
            }
        }
    }

    /// Removes a copy that was restored or discarded.
    fn settle_left_behind(&mut self, path: &std::path::Path) {
        if let Some(autosave) = &mut self.tasks.autosave {
            autosave.remove(path);
        }
    }

    fn ask_before_replacing(&mut self, path: PathBuf) {
        let name = path.display();
        let since = match self.model.session.on_disk {
            Some(_) => "has changed since this window read it",
            None => "exists, and this window has not read it",
        };
        let text = format!("{name} {since}. Saving replaces its present contents.");
        let replace = MessageAction { label: "Replace", command: SessionCommand::SaveTo(path).into() };
        let save_as = MessageAction { label: "Save as", command: SessionCommand::SaveAs.into() };
        self.model.messages.say(MessageKind::Replace, text, vec![replace, save_as]);
    }

    /// Returns the path of the session, or a suggestion.
    fn suggested_path(&self) -> Option<PathBuf> {
        let own = self.model.session.path.clone();
        own.or_else(|| self.model.open.pictures.as_ref().map(suggested_path))
    }

    fn show_save_dialog(&mut self) {
        match self.suggested_path().filter(|_| self.model.open.pictures.is_some()) {
            Some(path) => self.view.dialogs.save = Some(SaveDialog::new(&path)),
            None => self.model.messages.tell("There is nothing to save yet: open two images first."),
        }
    }

    fn save(&mut self, path: PathBuf) {
        let work = self.work();
        let Some(pictures) = &self.model.open.pictures else { return };
        let Some(mut session) = work.to_session(pictures, &path) else {
            self.model.messages.tell("The session cannot be saved, because an image is not from a file.");
            return;
        };
        self.view.dialogs.save = None;
        // The question whether to replace the file is answered.
        self.model.messages.settle(MessageKind::Replace);
        session.fundamental = self.estimate().map(|estimate| *estimate.fundamental());
        session.pictures = self.model.open.pictures_of();
        session.trust = result_note(&self.model);
        self.tasks.saver.ask(saver::save(path, session, work, self.image_files()));
    }

    /// Returns the files of the images, which must not be replaced.
    pub(super) fn image_files(&self) -> Vec<PathBuf> {
        let pictures = self.model.open.pictures.iter().flatten();
        pictures.filter_map(|opened| opened.picture.path.clone()).collect()
    }

    /// Handles finished jobs of the writing thread.
    pub(super) fn take_written(&mut self) {
        while let Some((_, written)) = self.tasks.saver.poll() {
            let Ok(written) = written else { continue };
            match written {
                Written::Session { path, result: Ok(work) } => {
                    self.model.open.done.tell(format!("Saved {}", path.display()));
                    // The file has the work at the time of the command. Later changes are not
                    // saved.
                    self.model.session.belongs_to(path, *work);
                }
                Written::Session { result: Err(problem), .. } => self.model.messages.tell(format!(
                    "The session was not saved: {problem}. Your work is still here. Save it somewhere else."
                )),
                Written::Copy(result) => self.note_copy(result),
                Written::Export { path, result: Ok(what) } => {
                    self.model.open.done.tell(format!("Exported {what} to {}", path.display()));
                }
                Written::Export { result: Err(problem), .. } => {
                    self.refuse_export(format!("Nothing was exported: {problem}."));
                }
            }
        }
    }

    /// Handles the outcome of a copy. A failed copy is repeated, and the user is told once.
    fn note_copy(&mut self, result: Result<(), String>) {
        let Some(autosave) = &mut self.tasks.autosave else { return };
        let was_failing = std::mem::replace(&mut autosave.is_failing, result.is_err());
        let Err(problem) = result else {
            if was_failing {
                self.model.messages.settle(MessageKind::Unprotected);
            }
            return;
        };
        self.model.session.copied = None;
        if !was_failing {
            let text = format!(
                "Unsaved work is not protected against a crash: {problem}. Save the session. The program will try the copy again."
            );
            self.model.messages.say(MessageKind::Unprotected, text, Vec::new());
        }
    }

    /// Warns if there is no place for copies of unsaved work.
    pub(super) fn tell_of_missing_copies(&mut self) {
        if let Some(problem) = self.tasks.no_autosave.take() {
            let text = format!(
                "Unsaved work is not protected against a crash, because the folder for copies \
                 cannot be used: {problem}. Save often."
            );
            self.model.messages.say(MessageKind::Unprotected, text, Vec::new());
        }
    }

    /// Restores the work of a session, once its pictures are open.
    pub(super) fn restore(&mut self, restored: Restored) {
        let Restored { session, mut work, notes } = restored;
        let model = &mut self.model;
        work.document.pictures = model.document.pictures.take();
        model.document = work.document.clone();
        model.history = History::default();
        if !model.document.pins.is_empty() {
            model.tool = Tool::Points;
        }
        model.look = work.look.clone();
        // Older sessions have no album.
        let album = work.album.take().or_else(|| model.album.take());
        work.album.clone_from(&album);
        model.album = album;
        for (pane, view) in self.view.panes.iter_mut().zip(work.views.into_iter().flatten()) {
            pane.set_view(view);
        }
        match session.owner {
            SessionOwner::Autosave => {
                // A relative path could refer to another file now.
                model.session.path = work.belongs_to.take().filter(|path| path.is_absolute());
                model.open.done.tell("Restored unsaved work");
                // The copy left behind may go only after this window has made its own.
                self.copy_work();
                self.tasks.saver.wait(PATIENCE);
                if self.tasks.autosave.as_ref().is_some_and(|autosave| autosave.path().exists()) {
                    self.settle_left_behind(&session.path);
                }
                self.offer_left_behind();
            }
            // Nothing is lost yet, and the file will not stay.
            SessionOwner::Caller => model.session.saved = Some(work),
            SessionOwner::Person => {
                model.open.done.tell(format!("Opened {}", session.path.display()));
                model.session.belongs_to(session.path, work);
            }
        }
        for note in notes {
            self.model.messages.tell(note);
        }
    }

    /// Keeps a copy of unsaved work before other pictures are shown. It is offered again, as after
    /// the end of the program. Returns whether there is such a copy.
    pub(super) fn set_aside(&mut self) -> bool {
        // Pairs placed by the program are no loss.
        let shown_me = self.model.open.show_me.is_some_and(|pairs| self.model.document.pairs == pairs);
        if shown_me || !(self.model.has_unsaved_work() && self.model.is_worth_keeping()) {
            return false;
        }
        self.copy_work();
        // The copy is read again at once, to be offered.
        self.tasks.saver.wait(PATIENCE);
        let set_aside = self.tasks.autosave.as_mut().is_some_and(Autosave::set_aside);
        if set_aside {
            self.model.session.copied = None;
        }
        set_aside
    }

    /// Copies unsaved work at intervals.
    pub(super) fn keep_copy(&mut self, ctx: &egui::Context) {
        if self.tasks.autosave.is_none() || self.model.open.pictures.is_none() {
            return;
        }
        if !self.model.has_unsaved_work() {
            self.remove_own_copy();
            return;
        }
        let session = &self.model.session;
        if session.copied.as_ref().is_some_and(|copied| self.model.is_same_work(copied)) {
            return;
        }
        let since = session.last_copy.map(|last| last.elapsed());
        match since.and_then(|since| AUTOSAVE_EVERY.checked_sub(since)) {
            Some(wait) if !wait.is_zero() => ctx.request_repaint_after(wait),
            _ => self.copy_work(),
        }
    }

    fn copy_work(&mut self) {
        let (Some(autosave), Some(pictures)) = (&self.tasks.autosave, &self.model.open.pictures) else {
            return;
        };
        let path = autosave.path().to_owned();
        let work = self.work();
        let Some(mut session) = work.to_session(pictures, &path) else { return };
        session.content.belongs_to.clone_from(&self.model.session.path);
        self.tasks.saver.ask(saver::copy(path, session));
        self.model.session.copied = Some(work);
        self.model.session.last_copy = Some(Instant::now());
    }

    fn remove_own_copy(&mut self) {
        let copied = self.model.session.copied.take().is_some();
        if let Some(autosave) = &mut self.tasks.autosave
            && (copied || std::mem::take(&mut autosave.is_failing))
        {
            self.tasks.saver.ask(saver::remove(autosave.path().to_owned()));
        }
    }

    /// Closes the window. Unsaved work on the user's own files is kept and offered again.
    pub fn close(&mut self) {
        if self.has_own_unsaved_work() {
            self.copy_work();
        } else {
            self.remove_own_copy();
        }
    }
}
