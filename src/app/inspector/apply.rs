//! Applies commands.

use egui::{Theme, ThemePreference};

use super::Inspector;
use crate::app::model::dock::DockLook;
use crate::app::model::document::counted;
use crate::app::model::history::{EditKey, LensChange};
use crate::app::model::look::Tool;
use crate::app::model::messages::MessageKind;
use crate::app::model::pane_view::QuarterTurns;
use crate::app::model::point_table::PointsCommand;
use crate::app::model::recording::PlayerCommand;
use crate::app::model::{Command, Document, LineSource, Side, StageId, TabId, pair_name};
use crate::app::tasks::{Opening, Wanted};
use crate::app::view::{Destination, WantedView};
use crate::geometry::symmetric_epipolar_distance;
use crate::io::PairOrigin;

/// The way to a rectified pair.
const NO_RECTIFIED: &str = "There is no rectified pair yet. Find the geometry first.";
/// The way to a scene.
const NO_SCENE: &str =
    "There are no 3-D points yet. They need a geometry with at least 10 matches. Find the geometry first.";
const IS_FINAL: &str = "The result is final: the same points would give it again";

impl Inspector {
    #[expect(clippy::too_many_lines, reason = "it is a table")]
    pub(super) fn apply(&mut self, ctx: &egui::Context, command: Command) {
        let (model, dialogs) = (&mut self.model, &mut self.view.dialogs);
        match command {
            Command::ShowOpenDialog => dialogs.open.show_empty(),
            Command::TogglePalette => dialogs.palette.toggle(),
            Command::ToggleShortcuts => dialogs.shortcuts = !dialogs.shortcuts,
            Command::OpenSample(sample) => self.open(Wanted::Opening(Opening::Sample(sample))),
            Command::OpenSampleSequences => self.open(Wanted::Opening(Opening::SampleSequences)),
            Command::OpenFiles(paths) => self.open_files(paths),
            Command::OpenFolder(path) => self.open_folder(path),
            Command::OpenViews(views) => self.open_views(views),
            Command::StepPair { forward } => self.step_pair(forward),
            Command::Browse(purpose) => self.pick(purpose),
            Command::ToggleTruth => self.toggle_truth(),
            Command::Session(command) => self.apply_to_session(command),
            Command::Exchange(command) => self.apply_to_exchange(ctx, command),
            Command::Rectified(command) => self.apply_to_rectified(ctx, command),
            Command::ShowMe => {
                if let Some(pairs) = model.open.show_me {
                    model.edit(|document| document.set_pairs(pairs.to_vec(), PairOrigin::TrueMatch));
                    model.open.replay.await_result();
                }
            }
            Command::FindWithoutClicks => model.edit(Document::leave_to_the_images),
            Command::KeepMatches => {
                let matches = model.telling_matches();
                model.edit(|document| document.keep_as_checks(&matches));
            }
            Command::Undo => self.travel(ctx, true),
            Command::Redo => self.travel(ctx, false),
            Command::DeleteSelected => model.delete_selected(),
            Command::DeletePair(pair) => model.edit(|document| document.remove(pair)),
            Command::SetRole(pair, role) => model.set_role(pair, role),
            Command::Points(command) => self.apply_to_points(ctx, command),
            Command::Refine(pair) => {
                if let Some(question) = model.repair_question(pair) {
                    self.tasks.repairing.ask(question);
                }
            }
            Command::MoveToMatch(pair) => model.move_to_match(pair),
            Command::ClearPairs => model.edit(|document| document.set_pairs(Vec::new(), PairOrigin::Clicked)),
            Command::Cancel => self.cancel(),
            Command::TurnView(side) => self.view.panes[side.index()].turn(),
            Command::SwapImages => self.swap_images(ctx),
            Command::FitAll => self.fit_all(),
            Command::FitAfterDoubleClick(side) => self.fit_after_double_click(side),
            Command::ToggleTheme => {
                let dark = ctx.theme() == Theme::Dark;
                ctx.set_theme(if dark { ThemePreference::Light } else { ThemePreference::Dark });
            }
            Command::JudgeRows => {
                let text = model.judged_rows();
                model.messages.say(MessageKind::Answer, text, Vec::new());
            }
            Command::Stop => self.tasks.estimating.stop(&mut model.open.computation),
            Command::Recompute if model.open.computation.is_final() => model.open.done.tell(IS_FINAL),
            Command::Recompute => model.open.computation.restart(),
            Command::Place(side, point) => {
                model.open.crosshair = None;
                let before = model.document.clone();
                let result = model.settled().copied();
                let is_moved = before.half.is_some_and(|half| half.side == side);
                model.edit(|document| document.place(side, point));
                if is_moved {
                    let (name, other) = (pair_name(before.pairs.len()), side.other().name());
                    model.open.done.tell(format!("Moved {name}. Click its match in the {other} image"));
                }
                // The pair took no part in that result, so its distance is an independent test.
                let added = model.document.pairs.get(before.pairs.len());
                if let Some((f, pair)) = result.zip(added) {
                    let (name, distance) =
                        (pair_name(before.pairs.len()), symmetric_epipolar_distance(&f, pair));
                    let text =
                        format!("Pair {name} added, {distance:.1} px from the lines of the previous result");
                    model.open.done.tell(text);
                }
                model.open.placed = (before != model.document).then(|| model.document.clone());
            }
            Command::Drag(at, point) => {
                model.edit_run(EditKey::Drag(at), |document| document.move_to(at, point));
            }
            Command::EndDrag => model.history.close_step(),
            Command::Crosshair(command) => model.apply_to_crosshair(command),
            Command::Nudge(by) => {
                // An arrow key moves the point that way on the screen.
                let own = model.open.crosshair.map(|own| own.side);
                let side = own.or(model.document.selection.map(|at| at.side)).unwrap_or(Side::Left);
                let turn =
                    self.view.panes[side.index()].view().map_or_else(QuarterTurns::default, |view| view.turn);
                let by = turn.inverse().turned(by);
                if !model.move_crosshair(by) {
                    model.nudge(by);
                }
            }
            Command::Select(at) => model.select(at),
            Command::SetMethod(method) => model.edit(|document| document.parameters.method = method),
            Command::SetPreset(preset) => model.set_preset(preset),
            Command::SetParameters { setting, to } => {
                model.edit_run(EditKey::Parameter(setting), |document| document.parameters = *to);
            }
            Command::ResetParameters => model.set_preset(model.document.parameters.preset),
            // `Inspector::show` collects these, as only the targets of this frame count.
            Command::PointAt(_) => {}
            Command::ChooseHypothesis(number) => model.choose_hypothesis(number),
            Command::ChooseContestant(contestant) => model.open.focus.choose_contestant(contestant),
            Command::Compare(subject) => model.look.compared = subject,
            Command::Pin(source) => model.pin(source),
            Command::Inspect(number) => model.document.inspected = Some(number),
            Command::Unpin(number) => model.edit(|document| document.unpin(number)),
            Command::UnpinAll => model.edit(|document| document.pins.clear()),
            Command::TogglePinTool => {
                model.tool = if model.tool == Tool::Inspect { Tool::Points } else { Tool::Inspect };
            }
            Command::CopyPosition(point) => {
                let text = format!("{:.2}, {:.2}", point.x, point.y);
                model.open.done.tell(format!("Copied {text}"));
                ctx.copy_text(text);
            }
            Command::CopyView => {
                self.view.capture = Some(WantedView::new(Destination::Clipboard));
            }
            Command::ToggleLink => {
                model.look.linked = !model.look.linked;
                self.view.link(model, Side::Left);
            }
            Command::ToggleStretch => model.open.toggle_stretch(),
            Command::Player(PlayerCommand::FindOffset) => {
                if let Some(recordings) = model.recordings() {
                    self.tasks.aligning.ask(recordings);
                }
            }
            Command::Player(command) => model.apply_to_player(command),
            Command::Replay(command) => model.apply_to_replay(command),
            Command::ToggleStacked => {
                let now = self.view.placement.is_some_and(|placement| placement.stacked);
                model.look.stacked = if model.look.stacked.is_some() { None } else { Some(!now) };
                self.fit_all();
            }
            Command::AcceptSuggestion => {
                let suggested = model.accepted_suggestion();
                if let Some((side, point)) = model.marked_by_crosshair() {
                    if suggested == Some((side, point)) {
                        model.edit(|document| document.accept(side, point));
                    } else {
                        self.apply(ctx, Command::Place(side, point));
                    }
                    self.model.advance_crosshair((side, point));
                } else if let Some((side, point)) = suggested {
                    model.edit(|document| document.accept(side, point));
                } else {
                    let text =
                        "Several places look alike, or none does, so Enter places nothing. Click the match";
                    model.open.done.tell(text);
                }
            }
            Command::ShowStage(StageId::Scene) if !model.offers_scene() => {
                // Like the switch: focal lengths alone give no scene before there is a geometry.
                let may_ask = model.can_rectify() || model.compares_barcodes();
                if may_ask && model.open.posed_views().is_none() {
                    self.apply(ctx, Command::ShowFocalLengths);
                } else {
                    model.open.done.tell(NO_SCENE);
                }
            }
            Command::UseLens => self.use_lens(),
            Command::RemoveCalibration => self.change_lens(LensChange::default()),
            Command::ShowFocalLengths => self.ask_for_focal_lengths(),
            Command::SetFocalLengths(lengths) => self.set_focal_lengths(lengths),
            Command::ShowStage(StageId::Rectified) if !model.can_rectify() => {
                model.open.done.tell(NO_RECTIFIED);
            }
            Command::ShowStage(stage) => model.look.stage = stage,
            Command::LookAtScene(orbit) => model.open.orbit = orbit,
            Command::ShowMatch(number) => self.show_match(number),
            Command::ShowTab(tab) => {
                if tab != TabId::Step && model.open.replay.place.is_some() {
                    model.choose_hypothesis(None);
                }
                (model.look.tab, model.look.dock.folded) = (tab, false);
                // The dock shows the figures of the rectified pair in place of tabs.
                if model.look.stage == StageId::Rectified {
                    model.look.stage = StageId::Pictures;
                }
            }
            Command::FoldDock => model.look.dock.folded = !model.look.dock.folded,
            Command::PlaceDock(edge) => model.look.dock = DockLook { edge, folded: false, ..model.look.dock },
            Command::SizeDock(edge, share) => model.look.dock.set_share(edge, share),
            Command::ToggleAlone => model.open.alone = !model.open.alone,
            Command::ToggleUnreliableLines => model.open.lines_anyway = !model.open.lines_anyway,
            Command::PlaceAtMark => {
                if let Some(Some(next)) = model.open.next_click {
                    model.look.stage = StageId::Pictures;
                    model.edit(|document| {
                        document.half = None;
                        document.place(Side::Left, next.point);
                    });
                }
            }
            Command::ToggleOverlay(overlay) => {
                let shown = &mut model.look.overlays[overlay as usize];
                *shown = !*shown;
            }
            Command::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Command::Dismiss(number) => model.messages.dismiss(number),
        }
    }

    /// Applies a command about the list of point pairs.
    fn apply_to_points(&mut self, ctx: &egui::Context, command: PointsCommand) {
        let model = &mut self.model;
        match command {
            PointsCommand::Rename(pair, name) => model.rename_pair(pair, &name),
            PointsCommand::Copy if model.document.pairs.is_empty() => {}
            PointsCommand::Copy => {
                let text = model.copied_pairs();
                let count = counted(text.lines().count() - 1);
                model.open.done.tell(format!("Copied {count} as a table"));
                ctx.copy_text(text);
            }
            PointsCommand::RequestPaste => ctx.send_viewport_cmd(egui::ViewportCommand::RequestPaste),
            PointsCommand::Paste(text) => model.paste_pairs(&text),
        }
    }

    /// Fits the images and the rectified pair into their panes.
    fn fit_all(&mut self) {
        for pane in &mut self.view.panes {
            pane.fit();
        }
        self.model.open.viewing.view = None;
        self.model.open.orbit = None;
    }

    /// Shows a match of the result in the middle of both pictures, and pins its lines.
    fn show_match(&mut self, number: usize) {
        let model = &mut self.model;
        let Some(pair) = model.matched_pairs().nth(number) else { return };
        model.look.stage = StageId::Pictures;
        model.pin(LineSource::Through { side: Side::Left, point: pair.point1 });
        for side in Side::BOTH {
            let pixel = model.open.pixel(side, side.point(&pair));
            self.view.panes[side.index()].magnify_at(pixel);
        }
    }

    /// Cancels the most recent unfinished action.
    fn cancel(&mut self) {
        let model = &mut self.model;
        if self.view.let_go() {
            // A point that was pressed but not moved leaves nothing to revert.
            if let Some(before) = model.history.revert_run(|key| matches!(key, EditKey::Drag(_))) {
                model.document = before;
            }
        } else if self.view.dialogs.close_top() {
            // The dialog is closed.
        } else if std::mem::take(&mut model.open.alone) {
            // The bars and the dock are back, and messages with them.
        } else if model.messages.dismiss_top() {
            // The message is dismissed.
        } else if model.open.crosshair.take().is_some() {
            // The crosshair is away.
        } else if model.tool != Tool::Points {
            // The pin tool places no points, so it must not remove one either.
            model.tool = Tool::Points;
        } else if model.document.half.is_some() {
            model.edit(|document| document.remove(document.pairs.len()));
        } else {
            model.select(None);
        }
    }

    /// Fits an image, and removes the unwanted point that the first click of the double click
    /// placed.
    fn fit_after_double_click(&mut self, side: Side) {
        let model = &mut self.model;
        if model.open.placed.take().is_some_and(|placed| placed == model.document)
            && let Some(before) = model.history.revert()
        {
            model.document = before;
        }
        self.view.panes[side.index()].fit();
    }
}
