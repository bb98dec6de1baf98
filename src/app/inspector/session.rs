//! Sessions in the window: saving, opening, the program's own copy, and what a crash left behind.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use super::{Inspector, PickPurpose};
use crate::app::command::Command;
use crate::app::document::Side;
use crate::app::history::History;
use crate::app::look::Tool;
use crate::app::panels::{MessageAction, RelocateDialog, SaveDialog};
use crate::app::session::{
    Autosave, Job, OpenSession, Relocation, Restored, Saver, SessionCommand, Work, Written, suggested_path,
};
use crate::app::waker::Waker;
use crate::io::{ImageReference, SessionFile};

/// How long unsaved work may be without a copy.
const AUTOSAVE_EVERY: Duration = Duration::from_secs(2);

/// The session that is open and the copy of what is not saved.
pub(super) struct SessionState {
    /// The file, once there is one.
    path: Option<PathBuf>,
    /// What is in the file, or what was opened.
    saved: Option<Work>,
    /// When and how long the file was when it was read or written last.
    on_disk: Option<(SystemTime, u64)>,
    saver: Saver,
    autosave: Option<Autosave>,
    /// What is in the program's own copy.
    copied: Option<Work>,
    last_copy: Option<Instant>,
}

impl SessionState {
    /// Keeps copies in a folder, if there is one to be used.
    pub(super) fn new(waker: Waker, folder: Option<&Path>) -> Self {
        Self {
            path: None,
            saved: None,
            on_disk: None,
            saver: Saver::new(waker),
            autosave: folder.and_then(Autosave::begin),
            copied: None,
            last_copy: None,
        }
    }

    pub(super) fn is_busy(&self) -> bool {
        self.saver.is_busy()
    }

    /// Has something written after what was asked for before.
    pub(super) fn ask(&mut self, job: Job) {
        self.saver.ask(job);
    }
}

impl Inspector {
    /// Everything a person set, as it is saved.
    fn work(&self) -> Work {
        let views = self.panes.each_ref().map(crate::app::panes::ImagePane::view);
        Work {
            document: self.document.clone(),
            pins: self.focus.pins().iter().map(|pin| pin.source).collect(),
            views: if let [Some(left), Some(right)] = views { Some([left, right]) } else { None },
            look: self.look.clone(),
            belongs_to: None,
        }
    }

    /// Whether closing now would lose something that saving would keep.
    fn has_unsaved_work(&self) -> bool {
        let work = self.work();
        match &self.session.saved {
            Some(saved) => !work.is_same_work(saved),
            None => work.is_worth_keeping(),
        }
    }

    /// What the title of the window says about the session.
    pub(super) fn session_title(&self) -> Option<String> {
        let name = self.session.path.as_ref()?.file_name()?.to_string_lossy().into_owned();
        Some(if self.has_unsaved_work() { format!("{name} (changed)") } else { name })
    }

    /// Offers what a crash left behind.
    pub(super) fn offer_left_behind(&mut self) {
        // One that cannot be read, of a newer program say, waits for who can.
        let readable = self.session.autosave.as_ref().and_then(|autosave| {
            let mut copies = autosave.left_behind();
            copies.find_map(|path| Some((path.to_owned(), SessionFile::<Work>::read(path).ok()?)))
        });
        let Some((path, copy)) = readable else { return };
        let pairs = match copy.content.document.pairs.len() {
            0 => "Points or pinned lines".to_owned(),
            1 => "1 point pair".to_owned(),
            pairs => format!("{pairs} point pairs"),
        };
        let [left, right] = copy.images.each_ref().map(ImageReference::name);
        let session = OpenSession { path: path.clone(), recovers: true, ..OpenSession::default() };
        let action = |label, command| MessageAction { label, command: Command::Session(command) };
        self.tell_with(
            format!("{pairs} on {left} and {right} were not saved. Restore that work?"),
            vec![
                action("Restore", SessionCommand::Open(session)),
                action("Discard", SessionCommand::DiscardLeftBehind(path)),
            ],
        );
    }

    /// Does what a command about sessions says.
    pub(super) fn apply_to_session(&mut self, command: SessionCommand) {
        match command {
            SessionCommand::Save => match self.session.path.clone() {
                Some(path) if self.is_changed_by_others(&path) => self.ask_before_replacing(path),
                Some(path) => self.save(path),
                None => self.show_save_dialog(),
            },
            SessionCommand::SaveAs => self.show_save_dialog(),
            SessionCommand::SaveTo(path) => self.save(path),
            SessionCommand::BrowseSave => {
                let suggested = self.session.path.clone();
                let suggested = suggested.or_else(|| Some(suggested_path(self.pictures.as_ref()?)));
                self.pick(PickPurpose::Session(suggested.unwrap_or_default()));
            }
            SessionCommand::BrowseLost(side) => self.pick(PickPurpose::Lost(side)),
            SessionCommand::Open(session) => {
                self.relocate_dialog = None;
                self.open_dialog.open = false;
                self.loader.open_session(session);
                self.wanted = None;
            }
            SessionCommand::DiscardLeftBehind(path) => {
                self.forget_copy(&path);
                self.messages.retain(|message| message.actions.is_empty());
                self.offer_left_behind();
            }
        }
    }

    /// Whether the file of the session is not what this window read or wrote.
    fn is_changed_by_others(&self, path: &Path) -> bool {
        let now = state_on_disk(path);
        now.is_some() && now != self.session.on_disk
    }

    fn ask_before_replacing(&mut self, path: PathBuf) {
        let name = path.display();
        let text =
            format!("{name} has changed since this window read it. Saving replaces what is in it now.");
        let action = |label, command| MessageAction { label, command: Command::Session(command) };
        self.tell_with(
            text,
            vec![action("Replace", SessionCommand::SaveTo(path)), action("Save as", SessionCommand::SaveAs)],
        );
    }

    /// Before other pictures take the place of these: what is not saved is kept, to be brought back. Clicks on the
    /// sample are not, as at the end of the program.
    pub(super) fn set_aside(&mut self) -> bool {
        let own = self.document.pictures.iter().flatten().any(|picture| picture.path.is_some());
        if !(own && self.has_unsaved_work() && self.work().is_worth_keeping()) {
            return false;
        }
        self.copy_work();
        // It is read again right away, to be offered.
        self.session.saver.finish();
        let set_aside = self.session.autosave.as_mut().is_some_and(Autosave::set_aside);
        if set_aside {
            self.session.copied = None;
        }
        set_aside
    }

    fn show_save_dialog(&mut self) {
        let Some(pictures) = &self.pictures else {
            self.tell("There is nothing to save yet: open two images first.".into());
            return;
        };
        let path = self.session.path.clone().unwrap_or_else(|| suggested_path(pictures));
        self.save_dialog = Some(SaveDialog::new(&path));
    }

    fn save(&mut self, path: PathBuf) {
        let work = self.work();
        let Some(pictures) = &self.pictures else { return };
        let Some(mut session) = work.to_session(pictures, &path) else {
            self.tell(
                "The session cannot be saved: an image is not a file that could be opened again.".into(),
            );
            return;
        };
        self.save_dialog = None;
        // Whoever asked whether to replace it has the answer.
        self.messages.retain(|message| message.actions.is_empty());
        session.fundamental = self.estimate().map(|estimate| *estimate.fundamental());
        self.session.saver.ask(Job::Save { path, session: Box::new(session), work: Box::new(work) });
    }

    /// Takes in what the writing thread has done.
    pub(super) fn take_session_news(&mut self) {
        while let Some(written) = self.session.saver.poll() {
            match written {
                Written::Session { path, result: Ok(work) } => {
                    self.done = Some(format!("Saved {}", path.display()));
                    // What was written is what it was then; whatever changed since is not saved.
                    self.session.saved = Some(*work);
                    self.session.on_disk = state_on_disk(&path);
                    self.session.path = Some(whole(path));
                }
                Written::Session { result: Err(problem), .. } => self.tell(format!(
                    "The session was not saved: {problem}. Your work is still here; save it somewhere else."
                )),
                Written::Export { path, result: Ok(what) } => {
                    self.done = Some(format!("Exported {what} to {}", path.display()));
                }
                Written::Export { result: Err(problem), .. } => {
                    self.tell(format!("Nothing was exported: {problem}. Choose another place."));
                }
            }
        }
    }

    /// Starts over with pictures that were opened, and with what a session brings.
    pub(super) fn begin_session(&mut self, restored: Option<Box<Restored>>) {
        self.session.path = None;
        self.session.saved = None;
        self.session.on_disk = None;
        let Some(restored) = restored else { return };
        let Restored { session, mut work, notes } = *restored;
        work.document.pictures = self.document.pictures.take();
        self.document = work.document.clone();
        self.history = History::default();
        for pin in &work.pins {
            self.focus.pin(*pin);
        }
        if !work.pins.is_empty() {
            self.tool = Tool::Points;
        }
        self.look = work.look.clone();
        for (pane, view) in self.panes.iter_mut().zip(work.views.into_iter().flatten()) {
            pane.set_view(view);
        }
        if session.recovers {
            // A path that depends on where the program is started would be another file now.
            self.session.path = work.belongs_to.take().filter(|path| path.is_absolute());
            self.messages.retain(|message| message.actions.is_empty());
            // The next copy is this window's own, at once; only then the one left behind may go.
            self.copy_work();
            self.forget_copy(&session.path);
            self.done = Some("Restored what was not saved".to_owned());
            self.offer_left_behind();
        } else {
            self.session.saved = Some(work);
            self.done = Some(format!("Opened {}", session.path.display()));
            self.session.on_disk = state_on_disk(&session.path);
            self.session.path = Some(whole(session.path));
        }
        for note in notes {
            self.tell(note);
        }
    }

    /// Asks for images that a session cannot find.
    pub(super) fn ask_for_images(&mut self, relocation: Relocation) {
        self.relocate_dialog = Some(RelocateDialog::new(relocation));
    }

    /// Fills in an image that was chosen for a session.
    pub(super) fn offer_lost(&mut self, side: Side, path: &Path) {
        if let Some(dialog) = &mut self.relocate_dialog {
            dialog.offer(side, path);
        }
    }

    /// Keeps a copy of unsaved work, now and then.
    pub(super) fn keep_copy(&mut self, ctx: &egui::Context) {
        if self.session.autosave.is_none() || self.pictures.is_none() {
            return;
        }
        if !self.has_unsaved_work() {
            if self.session.copied.take().is_some() {
                self.remove_own_copy();
            }
            return;
        }
        let work = self.work();
        if self.session.copied.as_ref().is_some_and(|copied| copied.is_same_work(&work)) {
            return;
        }
        let since = self.session.last_copy.map(|last| last.elapsed());
        match since.and_then(|since| AUTOSAVE_EVERY.checked_sub(since)) {
            Some(wait) if !wait.is_zero() => ctx.request_repaint_after(wait),
            _ => self.copy_work(),
        }
    }

    fn copy_work(&mut self) {
        let (Some(autosave), Some(pictures)) = (&self.session.autosave, &self.pictures) else { return };
        let path = autosave.path().to_owned();
        let mut work = self.work();
        let Some(mut session) = work.to_session(pictures, &path) else { return };
        session.content.belongs_to.clone_from(&self.session.path);
        work.belongs_to = None;
        self.session.saver.ask(Job::Autosave { path, session: Box::new(session) });
        self.session.copied = Some(work);
        self.session.last_copy = Some(Instant::now());
    }

    fn remove_own_copy(&mut self) {
        if let Some(autosave) = &self.session.autosave {
            self.session.saver.ask(Job::Remove(autosave.path().to_owned()));
        }
    }

    fn forget_copy(&mut self, path: &Path) {
        if let Some(autosave) = &mut self.session.autosave {
            autosave.remove(path);
        }
    }

    /// The window closes: unsaved work on files of one's own is kept and offered again, clicks on the sample are not.
    pub fn close(&mut self) {
        let own = self.document.pictures.iter().flatten().any(|picture| picture.path.is_some());
        if own && self.has_unsaved_work() {
            self.copy_work();
        } else if self.session.copied.take().is_some() {
            self.remove_own_copy();
        }
    }
}

/// A path that means the same wherever the program is started.
fn whole(path: PathBuf) -> PathBuf {
    std::path::absolute(&path).unwrap_or(path)
}

/// When a file was changed last and how long it is.
fn state_on_disk(path: &Path) -> Option<(SystemTime, u64)> {
    let found = path.metadata().ok()?;
    Some((found.modified().ok()?, found.len()))
}
