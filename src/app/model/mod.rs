//! State of the window: plain data, testable without a window.
//!
//! | module | contents |
//! |---|---|
//! | [`document`], [`history`] | the edited state; undo and redo |
//! | [`point_table`] | the list of point pairs: names, copying and pasting |
//! | [`open_pair`] | state that belongs to the open pictures |
//! | [`album`] | work on the other pairs of the folder |
//! | [`computation`] | progress and result of the estimate |
//! | [`comparison`], [`inspection`], [`suggesting`], [`rectified`] | other questions with their
//! answers |
//! | [`focus`] | hovered and selected things |
//! | [`look`], [`ids`], [`dock`] | visible things, kept between runs; place of the dock |
//! | [`crosshair`] | points placed by the keyboard |
//! | [`recording`] | two sequences in place of two pictures: frames and time offset |
//! | [`scene`] | scene points of a calibrated pair, and a view of them |
//! | [`shown`] | the geometry shown by the whole window |
//! | [`command`] | all commands |
//! | [`questions`] | requests to the tasks, made from the current state |
//! | [`verdict`], [`step`], [`guide`], [`residuals`] | the state in words and figures |
//! | [`glossary`] | terms of the field |
//! | [`replay`] | the course of a search, drawn slowly |
//! | [`recents`] | recently opened files |
//! | [`session`], [`exchange`] | saved work; files from and for other programs |

pub mod album;
pub mod command;
pub mod comparison;
pub mod computation;
pub mod crosshair;
pub mod dock;
pub mod document;
pub mod exchange;
pub mod focus;
pub mod glossary;
pub mod guide;
pub mod history;
pub mod ids;
pub mod inspection;
pub mod left_behind;
pub mod look;
pub mod messages;
pub mod open_pair;
pub mod pane_view;
pub mod picture;
mod playing;
pub mod point_table;
mod pointing;
pub mod questions;
pub mod recents;
pub mod recording;
pub mod rectified;
mod repairing;
pub mod replay;
mod replaying;
pub mod residuals;
pub mod revision;
pub mod sample;
pub mod scene;
pub mod session;
pub mod shared;
pub mod shown;
pub mod step;
pub mod suggesting;
pub mod truth;
mod turning;
mod unclicked;
pub mod verdict;

pub use command::{Command, ExchangeCommand, SessionCommand};
pub use document::{Document, LineSource, PointRef, Role, Side, pair_name};
pub use focus::Target;
pub use ids::{MethodStep, OverlayId, StageId, TabId};

use album::Album;
use document::PictureIdentity;
use exchange::PendingImport;
use history::{EditKey, History};
use ids::Visibility;
use left_behind::LeftBehind;
use look::{Look, Tool};
use messages::{MessageKind, Messages};
use open_pair::OpenPair;
use pane_view::PaneView;
use picture::Opened;
use recents::Recents;
use rectified::WritingProgress;
use session::{SessionState, Work};
use truth::KnownTruth;

use crate::estimate::{Estimate, Preset};
use crate::geometry::{PointPair, Vector};
use crate::judge::{ROW_LIMIT, RowMatches, judge_rows};
use crate::presentation::rows_in_words;
use crate::similarity::LineMeasure;

/// Work in progress that the window shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Activity {
    pub loading: bool,
    /// Whether another rectified pair is being made.
    pub rectifying: bool,
    /// Whether the time offset of two sequences is being searched for.
    pub aligning: bool,
    /// Progress of writing a rectified pair.
    pub writing: Option<WritingProgress>,
}

/// State of the window. Panes and panels read it; commands change it.
#[derive(Default)]
pub struct Model {
    pub document: Document,
    /// Earlier states, for undo.
    pub history: History,
    /// The pictures and everything that belongs to them.
    pub open: OpenPair,
    /// Visible overlays, tabs and panels.
    pub look: Look,
    /// Effect of a click in an image.
    pub tool: Tool,
    /// The folder of the pictures, with the work on its other pairs.
    pub album: Option<Album>,
    pub session: SessionState,
    pub messages: Messages,
    pub activity: Activity,
    /// Imports that wait until images are open and no dialog is open.
    pub imports: std::collections::VecDeque<PendingImport>,
    /// Views of the folder that are being opened.
    pub wanted: Option<[usize; 2]>,
    pub recents: Recents,
    /// Copies of unsaved work that can be restored, newest first.
    pub left_behind: Vec<LeftBehind>,
}

impl Model {
    /// Starts over with other pictures. The parameters stay; everything found on the previous
    /// pictures goes.
    pub fn open(
        &mut self,
        pictures: [Opened; 2],
        known: Option<KnownTruth>,
        uses_truth: bool,
        show_me: Option<[PointPair; 2]>,
    ) {
        let identities = pictures.each_ref().map(|opened| PictureIdentity::from(&*opened.picture));
        let mut parameters = self.document.parameters.clone();
        // Sequences are opened for their motion; pictures can only be compared by intensity.
        let recorded = pictures.iter().all(|opened| opened.recording.is_some());
        parameters.similarity.measure = if recorded { LineMeasure::Barcodes } else { LineMeasure::Stereo };
        self.document = Document::new(identities, parameters);
        self.document.truth = known.as_ref().filter(|_| uses_truth).map(|known| known.source.clone());
        self.history = History::default();
        self.open = OpenPair::new(pictures, known, show_me);
        self.open.cameras_at_first = self.open.cameras();
        self.wanted = None;
        self.album = None;
        let SessionState { copied, last_copy, .. } = std::mem::take(&mut self.session);
        self.session = SessionState { copied, last_copy, ..SessionState::default() };
    }

    /// Changes the document and records the change in the history.
    pub fn edit(&mut self, change: impl FnOnce(&mut Document)) {
        self.edit_as(None, change);
    }

    /// Changes the document. Neighbouring changes with the same key are one step of the history.
    pub fn edit_run(&mut self, key: EditKey, change: impl FnOnce(&mut Document)) {
        self.edit_as(Some(key), change);
    }

    fn edit_as(&mut self, key: Option<EditKey>, change: impl FnOnce(&mut Document)) {
        let before = self.document.clone();
        change(&mut self.document);
        if before.pairs != self.document.pairs || before.excluded != self.document.excluded {
            self.messages.settle(MessageKind::OfPair);
            // The record is of the points before.
            self.open.replay.stop();
        }
        self.history.record(before, &self.document, key);
    }

    /// Undoes a step, or redoes one.
    pub fn travel(&mut self, back: bool) {
        if !(if back { self.history.can_undo() } else { self.history.can_redo() }) {
            return;
        }
        let before = std::mem::take(&mut self.document);
        let (pairs, excluded) = (before.pairs.clone(), before.excluded.clone());
        self.document = self.history.travel(back, before);
        self.open.done.tell(if back { "Undone" } else { "Redone" });
        if (pairs, excluded) != (self.document.pairs.clone(), self.document.excluded.clone()) {
            // The record is of the points before.
            self.open.replay.stop();
        }
    }

    /// Moves the selected point. A run of moves is one step.
    pub fn nudge(&mut self, by: Vector) {
        if let Some(at) = self.document.selection
            && let Some(point) = self.document.point(at)
        {
            self.edit_run(EditKey::Nudge(at), |document| document.move_to(at, point + by));
        }
    }

    /// Selects a point. This is no step of the history, but ends a run of moves.
    pub fn select(&mut self, at: Option<PointRef>) {
        self.document.selection = at.filter(|at| self.document.point(*at).is_some());
        self.history.close_step();
    }

    /// Pins a line pair and inspects it. A pinned one is only inspected, which is no step of the history.
    pub fn pin(&mut self, source: LineSource) {
        match self.document.pins.iter().find(|pin| pin.source == source) {
            Some(pin) => self.document.inspected = Some(pin.number),
            None => self.edit(|document| document.pin(source)),
        }
    }

    /// Removes the selected pinned line pair (pin tool) or point pair.
    pub fn delete_selected(&mut self) {
        if self.tool == Tool::Inspect {
            if let Some(number) = self.document.inspected_pin().map(|pin| pin.number) {
                self.edit(|document| document.unpin(number));
            }
        } else if let Some(at) = self.document.selection {
            self.edit(|document| document.remove(at.pair));
        }
    }

    pub fn set_preset(&mut self, preset: Preset) {
        self.edit(|document| {
            document.parameters = document.parameters.with_preset(preset);
        });
    }

    /// Returns the visible tab of the dock; `None` when the dock is folded or has other content.
    pub fn tab(&self) -> Option<TabId> {
        (!self.look.dock.folded && self.stage() != StageId::Rectified).then_some(self.look.tab)
    }

    /// Returns the visible stage: the chosen one while it has content, and else the pictures.
    pub fn stage(&self) -> StageId {
        let has_content = match self.look.stage {
            StageId::Pictures => true,
            StageId::Rectified => self.can_rectify(),
            StageId::Scene => self.offers_scene(),
        };
        if has_content { self.look.stage } else { StageId::Pictures }
    }

    /// Returns whether a rectified pair exists or can be made.
    pub fn can_rectify(&self) -> bool {
        self.open.rectified.is_some() || self.geometry_to_write().is_some()
    }

    /// Returns whether nothing was placed or computed yet.
    pub fn is_at_start(&self) -> bool {
        let document = &self.document;
        document.pairs.is_empty() && document.half.is_none() && !document.unclicked && self.shown().is_none()
    }

    /// Returns whether the user can show or hide an overlay.
    pub fn offers(&self, overlay: OverlayId) -> bool {
        match overlay.visibility() {
            Visibility::Always => false,
            Visibility::AtFirst | Visibility::OnRequest => true,
            Visibility::WithTruth => self.truth().is_some(),
            Visibility::WithGiven => self.document.given.is_some(),
        }
    }

    /// Returns all work of the user in the form for saving.
    pub fn work(&self, views: Option<[PaneView; 2]>) -> Work {
        Work {
            document: self.document.clone(),
            views,
            look: self.look.clone(),
            album: self.album.clone(),
            cameras: self.open.cameras(),
            ..Work::default()
        }
    }

    /// Returns the point pairs as places in the pictures on the screen.
    pub fn pairs_in_pictures(&self) -> Vec<PointPair> {
        self.document.pairs.iter().map(|pair| self.open.pixels_of(pair)).collect()
    }

    /// Returns a sentence on whether the pictures are rectified, by the matches of the result.
    pub fn judged_rows(&self) -> String {
        let matches: Vec<PointPair> = self.matched_pairs().map(|pair| self.open.pixels_of(&pair)).collect();
        let found = self.result();
        let distinctive = found.iter().flat_map(|found| found.assessment.distinctive.iter());
        let witnesses: Vec<PointPair> = distinctive.map(|pair| self.open.pixels_of(pair)).collect();
        let is_trusted = found.is_some_and(Estimate::may_contradict);
        let by = RowMatches { matches: &matches, witnesses: &witnesses, is_trusted };
        let frame = self.open.shown_frame(Side::Right);
        let Some(judgement) = frame.and_then(|frame| judge_rows(&by, frame, ROW_LIMIT)) else {
            let text = "There are too few matches to compare rows. Click two point pairs, or find the geometry \
                        without clicks; then ask again.";
            return text.to_owned();
        };
        rows_in_words(&judgement)
    }

    /// Returns whether any work would be lost without saving.
    pub fn is_worth_keeping(&self) -> bool {
        let elsewhere = self.album.as_ref().is_some_and(|album| !album.pairs().is_empty());
        let has_own_cameras = self.open.cameras() != self.open.cameras_at_first;
        elsewhere || self.document.is_worth_keeping(false) || has_own_cameras
    }

    /// Returns whether closing now would lose work that saving would keep.
    pub fn has_unsaved_work(&self) -> bool {
        match &self.session.saved {
            Some(saved) => !self.is_same_work(saved),
            None => self.is_worth_keeping(),
        }
    }

    pub fn title(&self) -> String {
        let Some([left, right]) = &self.document.pictures else { return "Epiline".to_owned() };
        let session = self.session.path.as_ref().and_then(|path| path.file_name()).map(|name| {
            let changed = if self.has_unsaved_work() { " (changed)" } else { "" };
            format!("{}{changed} - ", name.to_string_lossy())
        });
        format!("{}{} and {} - Epiline", session.unwrap_or_default(), left.name, right.name)
    }
}
