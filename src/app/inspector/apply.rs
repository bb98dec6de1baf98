//! The one place where commands are applied.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Instant;

use egui::{Theme, ThemePreference};

use super::{EditKey, Inspector, PickPurpose, Picking};
use crate::app::command::Command;
use crate::app::document::{Document, PointRef, Side};
use crate::app::exchange::{ExchangeCommand, is_importable};
use crate::app::history::Step;
use crate::app::loader::Source;
use crate::app::look::Tool;
use crate::app::session::{OpenSession, SessionCommand, has_session_extension};
use crate::estimate::{Parameters, Preset};
use crate::geometry::Vector;

impl Inspector {
    /// Does what a command says.
    pub(super) fn apply(&mut self, ctx: &egui::Context, command: Command) {
        match command {
            Command::ShowOpenDialog => self.open_dialog.show_empty(),
            Command::OfferFile(path) => self.offer(&path),
            Command::OpenSample => {
                self.loader.open_sample();
                self.wanted = None;
            }
            Command::OpenFiles(paths) => self.open_files(paths),
            Command::Browse(side) => self.pick(PickPurpose::Image(side)),
            Command::OpenFolder(_)
            | Command::BrowseFolder
            | Command::OpenViews(_)
            | Command::StepPair { .. }
            | Command::ToggleTruth
            | Command::RandomTrial(_) => self.apply_to_known(command),
            Command::Session(command) => self.apply_to_session(command),
            Command::Exchange(command) => self.apply_to_exchange(command),
            Command::ShowMe => {
                if let Some(pairs) = self.show_me {
                    self.edit(Step::Single, |document| document.set_pairs(pairs.to_vec()));
                }
            }
            Command::Undo => self.travel(true),
            Command::Redo => self.travel(false),
            Command::DeleteSelected => self.delete_selected(),
            Command::DeletePair(pair) => self.edit(Step::Single, |document| document.remove(pair)),
            Command::IncludePair(pair, included) => {
                self.edit(Step::Single, |document| document.include(pair, included));
            }
            Command::ClearPairs => self.edit(Step::Single, |document| document.set_pairs(Vec::new())),
            Command::Cancel => self.cancel(),
            Command::FitAll => self.fit_all(),
            Command::FitAfterDoubleClick(side) => self.fit_after_double_click(side),
            Command::ToggleTheme => {
                let dark = ctx.theme() == Theme::Dark;
                ctx.set_theme(if dark { ThemePreference::Light } else { ThemePreference::Dark });
            }
            Command::ToggleShortcuts => self.shortcuts_open = !self.shortcuts_open,
            Command::Stop => self.computation.stop(),
            Command::Recompute => self.computation.restart(),
            Command::Place(side, point) => {
                let before = self.document.clone();
                self.edit(Step::Single, |document| document.place(side, point));
                self.placed = (before != self.document).then(|| self.document.clone());
            }
            Command::Drag(at, point) => {
                self.edit(Step::Merged(EditKey::Drag(at)), |document| document.move_to(at, point));
            }
            Command::EndDrag => self.history.close_step(),
            Command::Nudge(by) => self.nudge(by),
            Command::Select(at) => self.select(at),
            Command::SetMethod(method) => {
                self.edit(Step::Single, |document| document.parameters.method = method);
            }
            Command::SetPreset(preset) => self.set_preset(preset),
            // Collected by `Inspector::show`, since only what is pointed at in this frame counts.
            Command::PointAt(_) => {}
            Command::ChooseHypothesis(number) => self.focus.choose_hypothesis(number),
            Command::ChooseContestant(contestant) => self.focus.choose_contestant(contestant),
            Command::Compare(subject) => self.look.compared = subject,
            Command::Pin(source) => self.focus.pin(source),
            Command::Inspect(number) => self.focus.inspect(number),
            Command::Unpin(number) => self.focus.unpin(number),
            Command::UnpinAll => self.focus.unpin_all(),
            Command::ToggleInspectTool => {
                self.tool = if self.tool == Tool::Inspect { Tool::Points } else { Tool::Inspect };
            }
            Command::ToggleLink => {
                self.look.linked = !self.look.linked;
                self.link_views(Side::Left);
            }
            Command::ToggleMap => self.look.map = !self.look.map,
            Command::ToggleLoupe => self.look.loupe = !self.look.loupe,
            Command::AcceptSuggestion => {
                if let Some((side, point)) = self.scene().accepted_suggestion() {
                    self.edit(Step::Single, |document| document.place(side, point));
                }
            }
            Command::TogglePalette => {
                if self.palette.open {
                    self.palette.open = false;
                } else {
                    self.palette.show_empty();
                }
            }
            Command::SetParameters { setting, to } => {
                self.edit(Step::Merged(EditKey::Parameter(setting)), |document| document.parameters = *to);
            }
            Command::ResetParameters => self.set_preset(self.document.parameters.preset),
            Command::Rectified(command) => self.apply_to_rectified(ctx, command),
            Command::ShowTab(_) | Command::FoldTabs | Command::EnlargeTabs => self.arrange_tabs(&command),
            Command::ToggleOverlay(number) => {
                if let Some(shown) = self.look.overlays.get_mut(number) {
                    *shown = !*shown;
                }
            }
            Command::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Command::Dismiss(number) => self.messages.retain(|message| message.number != number),
        }
    }

    /// Shows another tab, or the tabs at another height.
    fn arrange_tabs(&mut self, command: &Command) {
        let look = &mut self.look;
        match command {
            Command::ShowTab(number) => (look.tab, look.tabs_folded) = (*number, false),
            Command::FoldTabs => look.tabs_folded = !look.tabs_folded,
            Command::EnlargeTabs => {
                (look.tabs_enlarged, look.tabs_folded) = (!look.tabs_enlarged || look.tabs_folded, false);
            }
            _ => {}
        }
    }

    /// Shows the images whole, and the rectified ones.
    fn fit_all(&mut self) {
        self.panes.iter_mut().for_each(super::ImagePane::fit);
        self.viewing.view = None;
    }

    /// Changes the document and notes it in the history.
    pub(super) fn edit(&mut self, step: Step<EditKey>, change: impl FnOnce(&mut Document)) {
        let before = self.document.clone();
        change(&mut self.document);
        self.history.record(before, &self.document, step);
    }

    /// Moves the selected point; a run of moves is one step.
    fn nudge(&mut self, by: Vector) {
        if let Some(at) = self.document.selection
            && let Some(point) = self.document.point(at)
        {
            self.edit(Step::Merged(EditKey::Nudge(at)), |document| document.move_to(at, point + by));
        }
    }

    /// Choosing a point is no step of its own, but ends a run of moves.
    fn select(&mut self, at: Option<PointRef>) {
        self.document.selection = at.filter(|at| self.document.point(*at).is_some());
        self.history.close_step();
    }

    fn travel(&mut self, back: bool) {
        let current = std::mem::take(&mut self.document);
        let travelled = if back { self.history.undo(current) } else { self.history.redo(current) };
        self.document = travelled.unwrap_or_else(|unchanged| unchanged);
        for pane in &mut self.panes {
            pane.let_go();
        }
    }

    /// The tool in hand says whether it is a point pair or a pinned line pair.
    fn delete_selected(&mut self) {
        if self.tool == Tool::Inspect {
            let inspected = self.focus.inspected().copied();
            if let Some(number) = self.focus.pins().iter().position(|pin| Some(*pin) == inspected) {
                self.focus.unpin(number);
            }
        } else if let Some(at) = self.document.selection {
            self.edit(Step::Single, |document| document.remove(at.pair));
        }
    }

    /// Gives up what is half done, the most recent thing first.
    fn cancel(&mut self) {
        let dragging = self.panes.iter_mut().any(super::ImagePane::let_go);
        if dragging {
            // A point that was pressed but not moved has nothing to take back.
            if let Some(before) = self.history.revert_run(|key| matches!(key, EditKey::Drag(_))) {
                self.document = before;
            }
        } else if self.palette.open {
            self.palette.open = false;
        } else if self.relocate_dialog.take().is_some() || self.save_dialog.take().is_some() {
            // Closing one of them is all there is to do.
        } else if self.open_dialog.open {
            self.open_dialog.open = false;
        } else if self.reading_dialog.take().is_some() {
            // So is this.
        } else if self.export_dialog.open {
            self.export_dialog.open = false;
        } else if self.file_export.open {
            self.file_export.open = false;
        } else if self.shortcuts_open {
            self.shortcuts_open = false;
        } else if self.document.half.is_some() {
            self.edit(Step::Single, |document| document.remove(document.pairs.len()));
        } else if self.tool == Tool::Inspect {
            self.tool = Tool::Points;
        } else {
            self.select(None);
        }
    }

    /// Lets the other image show the same part as this one, if the views are linked.
    pub(super) fn link_views(&mut self, leader: Side) {
        if self.look.linked {
            let [left, right] = &mut self.panes;
            match leader {
                Side::Left => right.follow(left),
                Side::Right => left.follow(right),
            }
        }
    }

    /// The first of the two clicks has placed a point that nobody wanted.
    fn fit_after_double_click(&mut self, side: Side) {
        if self.placed.take().is_some_and(|placed| placed == self.document)
            && let Some(before) = self.history.revert()
        {
            self.document = before;
        }
        self.panes[side.index()].fit();
    }

    fn set_preset(&mut self, preset: Preset) {
        self.edit(Step::Single, |document| {
            let Parameters { method, seed, .. } = document.parameters;
            document.parameters = Parameters { method, seed, ..Parameters::from(preset) };
        });
    }

    /// A dropped or chosen file: two of them open, the first one waits in the dialog. A folder opens at once.
    fn offer(&mut self, path: &std::path::Path) {
        if path.is_dir() {
            self.open_folder(path.to_owned());
            return;
        }
        if let Some(dialog) = &mut self.relocate_dialog {
            dialog.offer_dropped(path);
            return;
        }
        if has_session_extension(path) {
            self.open_session(path.to_owned());
            return;
        }
        if is_importable(path) {
            self.apply_to_exchange(ExchangeCommand::Import(vec![path.to_owned()]));
            return;
        }
        if let Some([left, right]) = self.open_dialog.offer(path, None) {
            self.open_files([Some(left), Some(right)]);
        }
    }

    fn open_files(&mut self, paths: [Option<PathBuf>; 2]) {
        if let Some(folder) = paths.iter().flatten().find(|path| path.is_dir()) {
            self.open_folder(folder.clone());
            return;
        }
        if let Some(session) = paths.iter().flatten().find(|path| has_session_extension(path)) {
            self.open_session(session.clone());
            return;
        }
        let (imports, images): (Vec<_>, Vec<_>) =
            paths.iter().flatten().partition(|path| is_importable(path));
        if !imports.is_empty() {
            let images: Vec<_> = images.into_iter().cloned().collect();
            self.apply_to_exchange(ExchangeCommand::Import(imports.into_iter().cloned().collect()));
            for image in &images {
                self.offer(image);
            }
            return;
        }
        let [left, right] = paths;
        let kept = |side: Side| self.pictures.as_ref().map(|pictures| pictures[side.index()].clone());
        let source =
            |path: Option<PathBuf>, side| path.map(Source::File).or_else(|| kept(side).map(Source::Keep));
        if let (Some(left), Some(right)) = (source(left, Side::Left), source(right, Side::Right)) {
            self.loader.open([left, right]);
            self.wanted = None;
            self.open_dialog.open = false;
        } else {
            self.tell("Two images are needed: name a left and a right one.".into());
        }
    }

    fn open_session(&mut self, path: PathBuf) {
        self.apply_to_session(SessionCommand::Open(OpenSession { path, ..OpenSession::default() }));
    }

    /// Shows the system's dialog in a thread of its own, since it returns only when it is closed.
    pub(super) fn pick(&mut self, purpose: PickPurpose) {
        if self.picking.is_some() {
            self.tell("A file dialog is open already. Finish it first, or type a path.".into());
            return;
        }
        let (sender, answer) = channel();
        let pick: Box<dyn FnOnce() -> Option<PathBuf> + Send> = match &purpose {
            PickPurpose::Image(_) | PickPurpose::Lost(_) | PickPurpose::Import => {
                let pick = Arc::clone(&self.pick_file);
                Box::new(move || pick())
            }
            PickPurpose::Folder | PickPurpose::Export => {
                let pick = Arc::clone(&self.pick_folder);
                Box::new(move || pick())
            }
            PickPurpose::Session(suggested) | PickPurpose::ExportFile(suggested) => {
                let (pick, suggested) = (Arc::clone(&self.pick_save), suggested.clone());
                Box::new(move || pick(&suggested))
            }
        };
        let waker = self.waker.clone();
        let thread = std::thread::Builder::new().name("file dialog".into()).spawn(move || {
            let start = Instant::now();
            let picked = pick();
            // Nobody waits for it any more when the window has closed.
            let _ = sender.send((picked, start.elapsed()));
            waker.wake();
        });
        // Without a thread the sender is gone, which is reported like a dialog that could not open.
        drop(thread);
        self.picking = Some(Picking { purpose, answer });
    }

    /// Files dropped on the window since the last frame.
    pub(super) fn dropped_files(ctx: &egui::Context) -> Vec<Command> {
        let files = ctx.input(|input| {
            input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect::<Vec<_>>()
        });
        // A session brings its own images: beside images such a file can only be a geometry.
        let has_images = files.iter().any(|path| !is_importable(path));
        let (imports, files): (Vec<_>, Vec<_>) = files
            .into_iter()
            .partition(|path| is_importable(path) && (has_images || !has_session_extension(path)));
        let mut commands = match <[PathBuf; 2]>::try_from(files) {
            Ok(both) => vec![Command::OpenFiles(both.map(Some))],
            Err(files) => files.into_iter().take(2).map(Command::OfferFile).collect(),
        };
        if !imports.is_empty() {
            commands.push(Command::Exchange(ExchangeCommand::Import(imports)));
        }
        commands
    }
}
