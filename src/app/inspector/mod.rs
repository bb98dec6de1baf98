//! The window: its state, threads and view, and the application of commands.
//!
//! The order of one frame: store results of the threads, apply commands from keys, draw (panes and
//! panels return commands), apply these, send new requests to the threads.

mod apply;
mod exchange;
mod opening;
mod session;

use std::time::Duration;

use egui::Ui;

use super::Start;
use super::model::command::PickPurpose;
use super::model::exchange::PendingImport;
use super::model::focus::Focus;
use super::model::look::Look;
use super::model::messages::MessageKind;
use super::model::recents::Recents;
use super::model::{Command, Document, Model};
use super::tasks::{Picked, Services, Tasks, Wanted};
use super::view::{KeyboardState, View, makes_sense, pressed};
use crate::estimate::Estimate;
use crate::geometry::PointPair;
use crate::io::sources;

/// Message where the file dialog of the system cannot open.
const NO_FILE_DIALOG: &str = if cfg!(all(unix, not(target_os = "macos"))) {
    "The file dialog could not be opened here. It needs the service xdg-desktop-portal or the program zenity: install one \
     of them. Until then, type a path, or drop the files on this window."
} else {
    "The file dialog could not be opened here. Type a path, or drop the files on this window."
};

pub struct Inspector {
    model: Model,
    tasks: Tasks,
    view: View,
    /// Point pairs to place once the first pictures are open.
    start_pairs: Vec<PointPair>,
}

impl Inspector {
    /// Creates a window that opens the contents of `start`.
    pub fn new(start: Start, services: Services) -> Self {
        let mut tasks = Tasks::new(services);
        tasks.loader.open(Wanted::Opening(start.opening));
        let mut model = Model::default();
        model.imports.extend(sources(start.imports).into_iter().map(PendingImport::from));
        let mut inspector = Self { model, tasks, view: View::default(), start_pairs: start.pairs };
        inspector.tell_of_missing_copies();
        inspector.offer_left_behind();
        inspector
    }

    pub fn model(&self) -> &Model {
        &self.model
    }

    pub fn document(&self) -> &Document {
        &self.model.document
    }

    /// Returns hovered and selected things.
    pub fn focus(&self) -> &Focus {
        &self.model.open.focus
    }

    /// Returns the latest estimate, even while a newer one is being computed.
    pub fn estimate(&self) -> Option<&Estimate> {
        self.model.open.computation.result().map(|(estimate, _)| estimate)
    }

    /// Returns visible overlays, tabs and panels, for keeping between runs.
    pub fn look(&self) -> &Look {
        &self.model.look
    }

    /// Restores visible overlays, tabs and panels of an earlier run.
    pub fn set_look(&mut self, look: Look) {
        self.model.look = look;
    }

    /// Returns the recently opened files, for keeping between runs.
    pub fn recents(&self) -> &Recents {
        &self.model.recents
    }

    /// Restores the recently opened files of an earlier run.
    pub fn set_recents(&mut self, recents: Recents) {
        self.model.recents = recents;
    }

    /// Returns whether any work is in progress: opening, estimating, comparing, searching or
    /// writing.
    pub fn is_busy(&self) -> bool {
        self.model.open.computation.is_running() || self.tasks.is_busy()
    }

    /// Returns the messages that the user has not dismissed.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.model.messages.list().iter().map(|message| message.text.as_str())
    }

    /// Runs one frame: stores results, draws everything and applies commands.
    pub fn show(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.tasks.waker.attach(&ctx);
        self.take_news(&ctx);
        // Keys come first, as Escape must end a drag before the panes continue it.
        let keyboard = KeyboardState {
            dialog_open: self.view.dialogs.is_open(),
            suggestion: self.model.document.half.is_some() && self.model.open.suggestion.is_some(),
            crosshair: self.model.open.crosshair.is_some(),
        };
        for command in pressed(&ctx, keyboard) {
            // Without pictures, the start panel stays as it is.
            if self.model.document.pictures.is_some() || makes_sense(&command, &self.model) {
                self.apply(&ctx, command);
            }
        }
        self.take_dropped(&ctx);
        self.model.open.follow_imported(&self.model.document);
        self.capture(&ctx);
        let passed = f64::from(ctx.input(|input| input.stable_dt));
        let [played, replayed] = [self.model.play_on(passed), self.model.replay_on(passed)];
        self.model.follow_replay();
        if played || replayed {
            ctx.request_repaint();
        }
        self.note_activity();
        if self.view.dialogs.is_open() && !self.view.had_dialog {
            // The success of an earlier task would cover the dialog.
            self.model.messages.settle(MessageKind::Done);
        }
        let mut commands = Vec::new();
        let hover = self.view.draw(ui, &self.model, &mut commands);
        if hover != self.model.open.hover {
            // The position is written in this frame and drawn in the next.
            self.model.open.hover = hover;
            ctx.request_repaint();
        }
        let now = ctx.input(|input| input.time);
        for seconds in
            [self.model.messages.retire(now), self.model.open.done.retire(now)].into_iter().flatten()
        {
            ctx.request_repaint_after(Duration::from_secs_f64(seconds));
        }
        self.point_at(&ctx, &commands);
        for command in commands {
            if !matches!(command, Command::PointAt(_)) {
                // The inspected lines change after they are drawn.
                ctx.request_repaint();
            }
            self.apply(&ctx, command);
        }
        self.model.open.follow_imported(&self.model.document);
        self.tasks.follow(&mut self.model, self.view.dialogs.export.open);
        self.keep_copy(&ctx);
        self.view.name_window(&ctx, self.model.title());
    }

    /// Stores results of the threads.
    fn take_news(&mut self, ctx: &egui::Context) {
        self.tasks.take(&mut self.model);
        if let Some(repaired) = self.tasks.repairing.latest() {
            self.model.take_repair(repaired);
        }
        match self.tasks.writing.take(&mut self.model.activity.writing) {
            Some(Ok(text)) => self.model.messages.say(MessageKind::Done, text, Vec::new()),
            Some(Err(text)) => self.refuse_export(text),
            None => {}
        }
        if let Some(found) = self.tasks.aligning.latest() {
            self.model.take_offset(found);
        }
        self.take_pictures(ctx);
        self.take_written();
        self.take_imports();
        match self.tasks.picking.poll() {
            Some((_, Ok(Picked::Path(PickPurpose::Import, path)))) if !self.view.dialogs.open.open => {
                self.import(vec![path]);
            }
            Some((_, Ok(Picked::Path(purpose, path)))) => self.view.dialogs.offer(&purpose, &path),
            Some((_, unseen @ (Ok(Picked::Unseen(_)) | Err(_)))) => {
                self.model.messages.tell(NO_FILE_DIALOG);
                // The path is typed there.
                if matches!(unseen, Ok(Picked::Unseen(PickPurpose::Import))) && !self.view.dialogs.open.open {
                    self.view.dialogs.open.show_import();
                }
            }
            Some((_, Ok(Picked::Nothing))) | None => {}
        }
    }

    /// Updates the work in progress shown by the panels.
    fn note_activity(&mut self) {
        self.model.activity.loading = self.tasks.loader.is_busy();
        self.model.activity.rectifying = self.tasks.is_rectifying();
        self.model.activity.aligning = self.tasks.aligning.is_busy();
    }

    /// Stores the thing under the cursor for the next frame.
    fn point_at(&mut self, ctx: &egui::Context, commands: &[Command]) {
        let mut targets = commands.iter().filter_map(|command| match command {
            Command::PointAt(target) => Some(*target),
            _ => None,
        });
        // Panels are drawn before the things over them, so the last target is the topmost.
        if self.model.open.focus.point_at(targets.next_back()) {
            ctx.request_repaint();
        }
    }

    /// Shows a file dialog of the system.
    fn pick(&mut self, purpose: PickPurpose) {
        if self.tasks.picking.is_busy() {
            self.model.messages.tell("A file dialog is already open. Close it first, or type a path.");
        } else {
            self.tasks.picking.ask(purpose);
        }
    }
}
