//! All commands. Panels and panes return commands, and the inspector applies them. `view::actions`
//! has their names and keys.

use std::path::PathBuf;

use super::comparison::{Contestant, Subject};
use super::dock::DockEdge;
use super::document::{PointRef, Side};
use super::exchange::ExportOrder;
use super::focus::{LineSource, Target};
use super::ids::{MethodStep, OverlayId, StageId, TabId};
use super::point_table::PointsCommand;
use super::recording::PlayerCommand;
use super::rectified::RectifiedCommand;
use super::scene::Orbit;
use super::session::OpenSession;
use super::suggesting::Repair;
use super::tones::TonesCommand;
use crate::camera::FocalLength;
use crate::estimate::{Method, Parameters, Preset};
use crate::geometry::{Point, Vector};
use crate::io::Notation;

/// A command of the user.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Show the window for opening files.
    ShowOpenDialog,
    /// Show the window for opening files with one path filled in.
    OfferFile(PathBuf),
    /// Open the built-in pair.
    OpenSample,
    /// Open the built-in sequences.
    OpenSampleSequences,
    /// Open files: two images, or a folder, a session, files to import.
    OpenFiles(Vec<PathBuf>),
    /// Open the first pair of a folder.
    OpenFolder(PathBuf),
    /// A command about sessions.
    Session(SessionCommand),
    /// A command about files of other programs.
    Exchange(ExchangeCommand),
    /// Choose a file for one side with the file dialog of the system.
    Browse(Side),
    /// Choose a folder with the file dialog of the system.
    BrowseFolder,
    /// Open two views of the open folder, by number.
    OpenViews([usize; 2]),
    /// Open the next or the previous pair of the open folder.
    StepPair {
        /// Whether to open the next pair.
        forward: bool,
    },
    /// Turn the comparison with the ground truth on or off.
    ToggleTruth,
    /// Place the two prepared point pairs on the built-in pair.
    ShowMe,
    /// Estimate the geometry without clicks.
    FindWithoutClicks,
    /// Make point pairs of the matches that replace the clicks.
    KeepMatches,
    /// Undo the last step.
    Undo,
    /// Redo the step that was undone last.
    Redo,
    /// Remove the selected pairs, or the pair of the selected point.
    DeleteSelected,
    /// Remove a pair.
    DeletePair(usize),
    /// Include or exclude a pair.
    IncludePair(usize, bool),
    /// Use a pair as a check only, or in the estimate.
    CheckOnly(usize, bool),
    /// Change the list of point pairs.
    Points(PointsCommand),
    /// Find a better place for the right point of a pair, and move the point there.
    Repair(usize, Repair),
    /// Remove all pairs.
    ClearPairs,
    /// Cancel the unfinished action.
    Cancel,
    /// Turn an image on the screen clockwise by 90°.
    TurnView(Side),
    /// Fit both images into their panes.
    FitAll,
    /// Fit an image into its pane, and remove the point placed by the first of the two clicks.
    FitAfterDoubleClick(Side),
    /// Switch between the light and the dark theme.
    ToggleTheme,
    /// Show or hide the list of keys.
    ToggleShortcuts,
    /// Tell whether the pictures are rectified.
    JudgeRows,
    /// Stop the computation.
    Stop,
    /// Compute again.
    Recompute,
    Place(Side, Point),
    /// Move a point. All moves until [`Command::EndDrag`] are one step.
    Drag(PointRef, Point),
    EndDrag,
    /// Move the selected point by an offset, px.
    Nudge(Vector),
    /// Select the point that keys act on.
    Select(Option<PointRef>),
    /// Set the method of the estimate.
    SetMethod(Method),
    /// Set the preset of the parameters.
    SetPreset(Preset),
    /// Report the thing under the cursor. Its counterparts are highlighted in the next frame.
    PointAt(Target),
    /// Show a hypothesis in the whole window, by its place in the list; `None` shows the result.
    ChooseHypothesis(Option<usize>),
    /// Show the geometry of another method, or the true one, in the whole window.
    ChooseContestant(Contestant),
    /// Set the geometry that the residuals compare.
    Compare(Subject),
    /// Pin a line pair and inspect it.
    Pin(LineSource),
    /// Inspect a pinned line pair, by its place in the list.
    Inspect(usize),
    /// Remove a pinned line pair, by its place in the list.
    Unpin(usize),
    /// Remove all pinned line pairs.
    UnpinAll,
    /// Switch between placing points and pinning line pairs.
    ToggleInspectTool,
    /// Switch between placing points and measuring.
    ToggleMeasureTool,
    /// Mark the next end of a measured distance.
    Measure(Side, Point),
    /// Measure from a place.
    MeasureFrom(Side, Point),
    /// Copy a position in an image to the clipboard.
    CopyPosition(Point),
    /// Copy the picture of both images with their overlays to the clipboard.
    CopyView,
    /// Link or unlink zoom and position of the two images.
    ToggleLink,
    /// Change brightness or colours of the pictures on the screen.
    Tones(TonesCommand),
    /// Control the open sequences.
    Player(PlayerCommand),
    /// Stack the images, or show them side by side.
    ToggleStacked,
    /// Show or hide the loupe.
    ToggleLoupe,
    /// Accept the suggested match of the first click.
    AcceptSuggestion,
    /// Show or hide the list of all commands.
    TogglePalette,
    /// Change parameters. All changes of one setting until [`Command::EndDrag`] are one step.
    SetParameters {
        /// The setting that changed.
        setting: &'static str,
        /// All parameters after the change.
        to: Box<Parameters>,
    },
    /// Reset all parameters to those of the preset.
    ResetParameters,
    /// A command about the rectified pair.
    Rectified(RectifiedCommand),
    ShowStage(StageId),
    /// Undo the distortion of the lens that was fitted to the matches.
    UseLens,
    /// Take the pictures as they are, without their calibration.
    RemoveCalibration,
    /// Ask for the focal lengths of the pictures.
    ShowFocalLengths,
    /// Give the pictures focal lengths in place of a calibration.
    SetFocalLengths([FocalLength; 2]),
    /// Look at the scene from elsewhere; `None` shows all of it.
    LookAtScene(Option<Orbit>),
    /// Show a match of the result in the middle of both pictures, and pin its lines.
    ShowMatch(usize),
    /// Show a tab of the dock.
    ShowTab(TabId),
    ShowStep(MethodStep),
    /// Show the next or the previous step of the method.
    StepMethod {
        /// Whether to show the next step.
        forward: bool,
    },
    /// Fold the dock to a strip, or unfold it.
    FoldDock,
    /// Put the dock at an edge; `None` chooses the edge that shows the pictures largest.
    PlaceDock(Option<DockEdge>),
    /// Set the size of the dock at an edge, as a share of the window; `None` takes the room that the
    /// pictures leave.
    SizeDock(DockEdge, Option<f32>),
    /// Show the pictures alone, or everything again.
    ToggleAlone,
    /// Show or hide the images of the folder.
    ToggleDrawer,
    /// Let the two pictures trade places, to compare them by blinking.
    Blink,
    /// Draw the lines of an unreliable geometry all the same, or hide them again.
    ToggleUnreliableLines,
    /// Place the left point of a new pair where one more pair would help most.
    PlaceAtMark,
    /// Keep an overlay on, or leave it to its part of the dock.
    ToggleOverlay(OverlayId),
    /// Remove a message.
    Dismiss(u64),
    /// Close the window.
    Quit,
}

/// A command about a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SessionCommand {
    /// Save to the file of the session, or ask for a file.
    Save,
    /// Ask for a file to save to.
    SaveAs,
    /// Save to a file.
    SaveTo(PathBuf),
    /// Choose the file to save to with the file dialog of the system.
    BrowseSave,
    Open(OpenSession),
    /// Choose a missing image of a session with the file dialog of the system.
    BrowseLost(Side),
    /// Remove the program's copy of unsaved work.
    DiscardLeftBehind(PathBuf),
}

/// A command about a file of another program.
#[derive(Debug, Clone, PartialEq)]
pub enum ExchangeCommand {
    /// Show the window for exporting.
    ShowExport,
    /// Show the window for exporting, with the homography of the plane.
    ShowPlaneExport,
    /// Choose the file of the export with the file dialog of the system, which suggests this path.
    BrowseExport(PathBuf),
    /// Write a file.
    Export(ExportOrder),
    /// Copy F of the shown geometry to the clipboard.
    CopyFundamental(Notation),
    /// Choose a file to import with the file dialog of the system.
    BrowseImport,
    /// Import files.
    Import(Vec<PathBuf>),
    /// Accept the matrix that is being imported.
    Accept {
        /// Reading to use, by its place in the list of the convention check. `None` takes the
        /// matrix as it is.
        reading: Option<usize>,
        /// Whether the point pairs of the file replace those of the document.
        with_pairs: bool,
    },
    /// Discard the matrix that is being imported.
    Reject,
    /// Remove the imported geometry.
    RemoveImported,
    /// Remove the matches from elsewhere.
    RemoveGiven,
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
    /// A file to import.
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
    Tones(TonesCommand),
    Points(PointsCommand),
    Session(SessionCommand),
    Exchange(ExchangeCommand)
);
