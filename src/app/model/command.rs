//! All commands. Panels and panes return commands, and the inspector applies them. `view::actions`
//! has their names and keys.

use std::path::PathBuf;

use super::comparison::{Contestant, Subject};
use super::crosshair::CrosshairCommand;
use super::dock::DockEdge;
use super::document::{LineSource, PointRef, Role, Side};
use super::exchange::{ExportKind, ExportOrder};
use super::focus::Target;
use super::ids::{OverlayId, StageId, TabId};
use super::point_table::PointsCommand;
use super::recording::PlayerCommand;
use super::rectified::RectifiedCommand;
use super::replay::ReplayCommand;
use super::session::OpenSession;
use crate::camera::{FocalLength, Orbit};
use crate::estimate::{Method, Parameters, Preset};
use crate::geometry::{Point, Vector};
use crate::io::Notation;
use crate::synthetic::Sample;

/// A command of the user. The tooltips in `view::actions` describe most of them.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    ShowOpenDialog,
    OpenSample(Sample),
    OpenSampleSequences,
    /// Open files: two images, or a folder, a session, files to import.
    OpenFiles(Vec<PathBuf>),
    OpenFolder(PathBuf),
    Session(SessionCommand),
    Exchange(ExchangeCommand),
    /// Choose a file or a folder with the dialog of the system.
    Browse(PickPurpose),
    OpenViews([usize; 2]),
    /// Open the next or the previous pair of the open folder.
    StepPair {
        forward: bool,
    },
    ToggleTruth,
    ShowMe,
    FindWithoutClicks,
    KeepMatches,
    Undo,
    Redo,
    /// Remove the selected pair, or the selected pinned lines.
    DeleteSelected,
    DeletePair(usize),
    SetRole(usize, Role),
    Points(PointsCommand),
    /// Find a better place for the right point of a pair, and move the point there.
    Refine(usize),
    /// Move the right point of a pair to its match, if the images show it clearly.
    MoveToMatch(usize),
    ClearPairs,
    Cancel,
    TurnView(Side),
    /// Open the pictures in the other order, with the same points.
    SwapImages,
    FitAll,
    /// Fit an image into its pane, and remove the point placed by the first of the two clicks.
    FitAfterDoubleClick(Side),
    ToggleTheme,
    ToggleShortcuts,
    /// Tell whether the pictures are rectified.
    JudgeRows,
    Stop,
    Recompute,
    Place(Side, Point),
    /// Move a point. All moves until [`Command::EndDrag`] are one step.
    Drag(PointRef, Point),
    EndDrag,
    /// Move the selected point by an offset, px.
    Nudge(Vector),
    Crosshair(CrosshairCommand),
    Select(Option<PointRef>),
    SetMethod(Method),
    SetPreset(Preset),
    /// Report the thing under the cursor. Its counterparts are highlighted in the next frame.
    PointAt(Target),
    /// Show a hypothesis in the whole window, by its place in the list; `None` shows the result.
    ChooseHypothesis(Option<usize>),
    /// Show the geometry of another method, or the true one, in the whole window.
    ChooseContestant(Contestant),
    Compare(Subject),
    Pin(LineSource),
    /// Inspect a pinned line pair, by its number.
    Inspect(usize),
    /// Remove a pinned line pair, by its number.
    Unpin(usize),
    UnpinAll,
    /// Take up the pin tool, or lay it down.
    TogglePinTool,
    CopyPosition(Point),
    CopyView,
    ToggleLink,
    /// Show both pictures from black to white, or as in their files.
    ToggleStretch,
    Player(PlayerCommand),
    Replay(ReplayCommand),
    ToggleStacked,
    AcceptSuggestion,
    TogglePalette,
    /// Change parameters. All changes of one setting until [`Command::EndDrag`] are one step.
    SetParameters {
        setting: &'static str,
        to: Box<Parameters>,
    },
    ResetParameters,
    Rectified(RectifiedCommand),
    ShowStage(StageId),
    UseLens,
    RemoveCalibration,
    ShowFocalLengths,
    SetFocalLengths([FocalLength; 2]),
    /// Look at the scene from elsewhere; `None` shows all of it.
    LookAtScene(Option<Orbit>),
    /// Show a match of the result in the middle of both pictures, and pin its lines.
    ShowMatch(usize),
    ShowTab(TabId),
    FoldDock,
    /// Put the dock at an edge; `None` chooses the edge that shows the pictures largest.
    PlaceDock(Option<DockEdge>),
    /// Set the size of the dock at an edge, as a share of the window; `None` takes the room that the
    /// pictures leave.
    SizeDock(DockEdge, Option<f32>),
    ToggleAlone,
    /// Draw the lines of an unreliable geometry all the same, or hide them again.
    ToggleUnreliableLines,
    /// Place the left point of a new pair where one more pair would help most.
    PlaceAtMark,
    /// Keep an overlay on, or leave it to its part of the dock.
    ToggleOverlay(OverlayId),
    Dismiss(u64),
    Quit,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SessionCommand {
    /// Save to the file of the session, or ask for a file.
    Save,
    SaveAs,
    SaveTo(PathBuf),
    Open(OpenSession),
    DiscardLeftBehind(PathBuf),
}

/// A command about a file of another program.
#[derive(Debug, Clone, PartialEq)]
pub enum ExchangeCommand {
    /// Open the export dialog, for this kind if there is one.
    ShowExport(Option<ExportKind>),
    Export(ExportOrder),
    CopyFundamental(Notation),
    Import(Vec<PathBuf>),
    Accept {
        /// Reading to use, by its place in the list of the convention check. `None` takes the
        /// matrix as it is.
        reading: Option<usize>,
        /// Whether the point pairs of the file replace those of the document.
        with_pairs: bool,
    },
    Reject,
    RemoveImported,
    RemoveGiven,
    /// Turn the given matches into point pairs.
    EditGiven,
    /// Turn the imported point pairs into given matches of this file.
    GiveImported(String),
}

/// Purpose of an open file dialog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PickPurpose {
    /// An image to open.
    Image(Side),
    /// A folder with ground truth.
    Folder,
    /// A folder for a rectified pair.
    Export,
    /// A file for the session. The dialog suggests this path.
    Session(PathBuf),
    /// A file for an export. The dialog suggests this path.
    ExportFile(PathBuf),
    /// A database of COLMAP to export to.
    Database,
    Import,
    /// A missing image of a session.
    Lost(Side),
}

/// Makes a [`Command`] of the commands about a part of the window.
macro_rules! commands_about {
    ($($part:ident($command:ty)),*) => {
        $(impl From<$command> for Command {
            fn from(command: $command) -> Self {
                Self::$part(command)
            }
        })*
    };
}

commands_about!(
    Rectified(RectifiedCommand),
    Player(PlayerCommand),
    Replay(ReplayCommand),
    Crosshair(CrosshairCommand),
    Points(PointsCommand),
    Session(SessionCommand),
    Exchange(ExchangeCommand)
);
