//! The window's state: what is open, what is edited, what is computed, and what is shown.
//!
//! One frame runs in this order: take in news from the threads, apply the commands of the keys, draw (panes
//! and panels return commands), apply these, bring the computation in line with the document.

mod apply;
mod exchange;
mod known;
mod layout;
mod news;
mod questions;
mod rectified;
mod session;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Duration;

use egui::Ui;

use super::Start;
use super::command::Command;
use super::comparison::Comparing;
use super::computation::Computation;
use super::document::{Document, PointRef, Side};
use super::focus::Focus;
use super::history::History;
use super::inspection::Matcher;
use super::keyboard::{Keyboard, pressed};
use super::loader::{Loader, Opened, Opening, Source};
use super::look::{Look, Tool};
use super::panels::{
    CommandPalette, ExportDialog, FileExport, Message, MessageAction, OpenDialog, ReadingDialog,
    RelocateDialog, SaveDialog,
};
use super::panes::ImagePane;
use super::rectified::{Rectifying, Viewing, Writing};
use super::scene::{Hover, Scene};
use super::services::{PickFn, SavePickFn, Services};
use super::session::OpenSession;
use super::suggesting::Suggesting;
use super::truth::Known;
use super::waker::Waker;
use crate::estimate::Estimate;
use crate::geometry::{AnchoredLine, PointPair};
use exchange::ExchangeState;
use session::SessionState;

/// Messages shown at most; the oldest gives way.
const MESSAGES: usize = 4;

/// Which edits are one step of the history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum EditKey {
    Drag(PointRef),
    Nudge(PointRef),
    Parameter(&'static str),
}

/// What a file dialog is open for.
#[derive(Debug, Clone, PartialEq, Eq)]
enum PickPurpose {
    /// An image to open.
    Image(Side),
    /// A folder with ground truth.
    Folder,
    /// The folder that a rectified pair is written to.
    Export,
    /// Where to save the session, with a suggestion.
    Session(PathBuf),
    /// Where to write an export, with a suggestion.
    ExportFile(PathBuf),
    /// A file to import.
    Import,
    /// An image that a session cannot find.
    Lost(Side),
}

/// A file dialog that is open.
struct Picking {
    purpose: PickPurpose,
    /// What was chosen and how long the dialog was open.
    answer: Receiver<(Option<PathBuf>, Duration)>,
}

/// The whole window: state, threads and how it is drawn.
pub struct Inspector {
    document: Document,
    history: History<Document, EditKey>,
    computation: Computation,
    loader: Loader,
    waker: Waker,
    pictures: Option<[Opened; 2]>,
    /// Counts the openings of pictures.
    opening: u64,
    /// Point pairs to place once the pictures of the start are there.
    start_pairs: Vec<PointPair>,
    show_me: Option<[PointPair; 2]>,
    /// What is known about the pictures.
    known: Option<Known>,
    /// The views of the folder that are being opened.
    wanted: Option<[usize; 2]>,
    /// The seed of the next random trial.
    next_seed: u64,
    comparing: Comparing,
    panes: [ImagePane; 2],
    hover: Option<Hover>,
    focus: Focus,
    matcher: Matcher,
    /// The line pair that was inspected when the window was last drawn.
    inspected: Option<[AnchoredLine; 2]>,
    /// The result that the chosen hypothesis belongs to.
    revision: u64,
    look: Look,
    tool: Tool,
    suggesting: Suggesting,
    rectifying: Rectifying,
    viewing: Viewing,
    writing: Writing,
    palette: CommandPalette,
    open_dialog: OpenDialog,
    save_dialog: Option<SaveDialog>,
    relocate_dialog: Option<RelocateDialog>,
    export_dialog: ExportDialog,
    file_export: FileExport,
    reading_dialog: Option<ReadingDialog>,
    shortcuts_open: bool,
    session: SessionState,
    exchange: ExchangeState,
    /// What was done last, for the status bar.
    done: Option<String>,
    messages: Vec<Message>,
    messages_shown: u64,
    pick_file: Arc<PickFn>,
    pick_folder: Arc<PickFn>,
    pick_save: Arc<SavePickFn>,
    picking: Option<Picking>,
    /// The document right after a click placed a point, for a second click to take it back.
    placed: Option<Document>,
    title: String,
}

impl Inspector {
    /// A window that opens what `start` says.
    pub fn new(start: Start, services: Services) -> Self {
        let waker = Waker::default();
        let mut loader = Loader::new(waker.clone());
        match start.opening {
            Opening::Sample => loader.open_sample(),
            Opening::Files(left, right) => loader.open([Source::File(left), Source::File(right)]),
            Opening::Folder(path) => loader.open_folder(path),
            Opening::Session(path) => {
                loader.open_session(OpenSession { path, ..OpenSession::default() });
            }
        }
        let session = SessionState::new(waker.clone(), services.copies.as_deref());
        let exchange = ExchangeState::new(waker.clone(), start.imports);
        let mut inspector = Self {
            document: Document::default(),
            history: History::default(),
            computation: Computation::new(services.estimate, waker.clone())
                .following(services.follow, waker.clone()),
            loader,
            waker: waker.clone(),
            pictures: None,
            opening: 0,
            start_pairs: start.pairs,
            show_me: None,
            known: None,
            wanted: None,
            next_seed: 0,
            comparing: Comparing::new(waker.clone()),
            panes: Side::BOTH.map(ImagePane::new),
            hover: None,
            focus: Focus::default(),
            matcher: Matcher::new(waker.clone()),
            inspected: None,
            revision: 0,
            look: Look::default(),
            tool: Tool::default(),
            suggesting: Suggesting::new(services.suggest, waker.clone()),
            rectifying: Rectifying::new(waker.clone()),
            viewing: Viewing::default(),
            writing: Writing::new(waker),
            palette: CommandPalette::default(),
            open_dialog: OpenDialog::default(),
            save_dialog: None,
            relocate_dialog: None,
            export_dialog: ExportDialog::default(),
            file_export: FileExport::default(),
            reading_dialog: None,
            shortcuts_open: false,
            session,
            exchange,
            done: None,
            messages: Vec::new(),
            messages_shown: 0,
            pick_file: services.pick_file,
            pick_folder: services.pick_folder,
            pick_save: services.pick_save,
            picking: None,
            placed: None,
            title: String::new(),
        };
        inspector.offer_left_behind();
        inspector
    }

    /// What is edited.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// What is pointed at and what is chosen.
    pub fn focus(&self) -> &Focus {
        &self.focus
    }

    /// The latest estimate, also while a newer one is being computed.
    pub fn estimate(&self) -> Option<&Estimate> {
        self.computation.result().map(|(estimate, _)| estimate)
    }

    /// What is drawn.
    pub fn look(&self) -> &Look {
        &self.look
    }

    /// Draws as it was done in an earlier run.
    pub fn set_look(&mut self, look: Look) {
        self.look = look;
    }

    /// Whether pictures are being opened, an estimate computed or compared, a match searched for, or a rectified
    /// pair made or written.
    pub fn is_busy(&self) -> bool {
        self.loader.is_busy()
            || self.computation.is_running()
            || self.suggesting.is_busy()
            || self.matcher.is_busy()
            || self.comparing.is_busy()
            || self.rectifying.is_busy()
            || self.writing.progress().is_some()
            || self.picking.is_some()
            || self.session.is_busy()
            || self.exchange.is_busy()
    }

    /// What the user was told and has not dismissed.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.messages.iter().map(|message| message.text.as_str())
    }

    /// One frame: takes in news, draws everything, and does what was asked for.
    pub fn show(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.waker.attach(&ctx);
        self.take_news(&ctx);
        // Keys first: Escape ends a drag before the panes can carry it on.
        let keyboard = Keyboard {
            dialog_open: self.open_dialog.open
                || self.export_dialog.open
                || self.file_export.open
                || self.palette.open
                || self.save_dialog.is_some()
                || self.relocate_dialog.is_some()
                || self.reading_dialog.is_some(),
            suggestion: self.scene().accepted_suggestion().is_some(),
        };
        let mut commands = pressed(&ctx, keyboard);
        commands.extend(Self::dropped_files(&ctx));
        for command in commands {
            self.apply(&ctx, command);
        }
        self.follow_imported();
        self.capture(&ctx);
        let mut commands = Vec::new();
        self.draw(ui, &mut commands);
        self.point_at(&ctx, &commands);
        for command in commands {
            if !matches!(command, Command::PointAt(_)) {
                // The inspected lines follow when they are drawn.
                ctx.request_repaint();
            }
            self.apply(&ctx, command);
        }
        self.follow_imported();
        self.computation.follow(self.opening, self.request());
        self.suggesting.follow(self.question());
        self.matcher.follow(self.inspection_request());
        self.comparing.follow(self.comparand());
        self.rectifying.follow(self.to_rectify().filter(|_| self.wants_rectified()));
        self.keep_copy(&ctx);
        self.name_window(&ctx);
    }

    /// Notes what is pointed at in this frame, for the next one to draw.
    fn point_at(&mut self, ctx: &egui::Context, commands: &[Command]) {
        let mut targets = commands.iter().filter_map(|command| match command {
            Command::PointAt(target) => Some(*target),
            _ => None,
        });
        // The panels are drawn before what lies over them: the last one is the topmost.
        if self.focus.point_at(targets.next_back()) {
            ctx.request_repaint();
        }
    }

    /// The state as it is drawn.
    fn scene(&self) -> Scene<'_> {
        Scene {
            document: &self.document,
            computation: &self.computation,
            hover: self.hover,
            focus: &self.focus,
            inspection: self.matcher.latest(),
            known: self.known.as_ref(),
            imported: self.exchange.imported.as_ref(),
            comparison: self.comparing.latest(),
            tab: (!self.look.tabs_folded).then_some(self.look.tab),
            rectified: self.rectifying.latest(),
            rectifying: self.rectifying.is_busy(),
            viewing: self.viewing,
            writing: self.writing.progress(),
            overlays: &self.look.overlays,
            look: &self.look,
            tool: self.tool,
            suggestion: self.suggesting.answer(),
            loading: self.loader.is_busy(),
            has_sample_points: self.show_me.is_some(),
            can_undo_redo: [self.history.can_undo(), self.history.can_redo()],
            done: self.done.as_deref(),
            messages: &self.messages,
        }
    }

    /// Tells that something went wrong.
    fn tell(&mut self, text: String) {
        self.say(text, false, Vec::new());
    }

    /// The same with buttons.
    fn tell_with(&mut self, text: String, actions: Vec<MessageAction>) {
        self.say(text, false, actions);
    }

    fn say(&mut self, text: String, good: bool, actions: Vec<MessageAction>) {
        self.messages.retain(|message| message.text != text);
        self.messages_shown += 1;
        self.messages.push(Message { number: self.messages_shown, text, good, actions });
        if self.messages.len() > MESSAGES {
            self.messages.remove(0);
        }
    }

    fn name_window(&mut self, ctx: &egui::Context) {
        let title = match (&self.document.pictures, self.session_title()) {
            (Some([left, right]), Some(session)) => {
                format!("{session} - {} and {} - Epiline", left.name, right.name)
            }
            (Some([left, right]), None) => format!("{} and {} - Epiline", left.name, right.name),
            (None, _) => "Epiline".to_owned(),
        };
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }
}
