//! Everything that can be done. Panels and panes return commands; they are applied in one place. What each is called, its
//! keys and where it is offered is `view::actions`.

use std::path::PathBuf;

use super::comparison::{Contestant, Subject};
use super::document::{PointRef, Side};
use super::exchange::ExportOrder;
use super::focus::{LineSource, Target};
use super::ids::{OverlayId, TabId};
use super::point_table::PointsCommand;
use super::recording::PlayerCommand;
use super::rectified::RectifiedCommand;
use super::session::OpenSession;
use super::suggesting::Repair;
use super::tones::TonesCommand;
use crate::estimate::{Method, Parameters, Preset};
use crate::geometry::{Point, Vector};

/// Something to do.
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
    /// Something about sessions.
    Session(SessionCommand),
    /// Something about files of other programs.
    Exchange(ExchangeCommand),
    /// Choose a file for one side with the system's dialog.
    Browse(Side),
    /// Choose a folder with the system's dialog.
    BrowseFolder,
    /// Open two views of the folder that is open, by their numbers.
    OpenViews([usize; 2]),
    /// Open the next pair of the folder that is open, or the one before.
    StepPair {
        /// The next one.
        forward: bool,
    },
    /// Compare with the ground truth, or not.
    ToggleTruth,
    /// Place two point pairs on the built-in pair.
    ShowMe,
    /// Look for a geometry without clicks.
    FindWithoutClicks,
    /// Make point pairs of the matches that stand in for clicks.
    KeepMatches,
    /// Take the last step back.
    Undo,
    /// Make the step again that was taken back.
    Redo,
    /// Remove the pair of the selected point.
    DeleteSelected,
    /// Remove a pair.
    DeletePair(usize),
    /// Leave a pair out, or take it in again.
    IncludePair(usize, bool),
    /// Let a pair only check the geometry, or take part in the estimate.
    CheckOnly(usize, bool),
    /// Do something with the list of point pairs.
    Points(PointsCommand),
    /// Look for a better place for the right point of a pair, and move it there.
    Repair(usize, Repair),
    /// Remove all pairs.
    ClearPairs,
    /// Give up what is half done.
    Cancel,
    /// Show both images whole.
    FitAll,
    /// Show an image whole, taking back the point that the first of two clicks placed.
    FitAfterDoubleClick(Side),
    /// Change between light and dark.
    ToggleTheme,
    /// Show or hide the list of keys.
    ToggleShortcuts,
    /// Stop the computation.
    Stop,
    /// Compute again.
    Recompute,
    /// Place a point.
    Place(Side, Point),
    /// Move a point; all moves until [`Command::EndDrag`] are one step.
    Drag(PointRef, Point),
    /// The drag is over.
    EndDrag,
    /// Move the selected point a little, px.
    Nudge(Vector),
    /// Make a point the one that keys act on.
    Select(Option<PointRef>),
    /// Choose how the geometry is found.
    SetMethod(Method),
    /// Choose whose parameters to use.
    SetPreset(Preset),
    /// Something is under the cursor; its counterparts light up in the next frame.
    PointAt(Target),
    /// Show a hypothesis in the whole window, by its place in the list, or the result again.
    ChooseHypothesis(Option<usize>),
    /// Show the geometry of another method, or the true one, in the whole window.
    ChooseContestant(Contestant),
    /// Choose what the residuals compare.
    Compare(Subject),
    /// Keep a line pair on the images and look at it closely.
    Pin(LineSource),
    /// Look closely at a pinned line pair, by its place in the list.
    Inspect(usize),
    /// Remove a pinned line pair, by its place in the list.
    Unpin(usize),
    /// Remove all pinned line pairs.
    UnpinAll,
    /// Change between placing points and pinning line pairs.
    ToggleInspectTool,
    /// Let both images zoom and move together, or not.
    ToggleLink,
    /// Show or hide the map of the epipoles.
    ToggleMap,
    /// Show the pictures brighter, darker or in other colours.
    Tones(TonesCommand),
    /// Do something with the sequences that are open.
    Player(PlayerCommand),
    /// Show the images above each other, or side by side.
    ToggleStacked,
    /// Show or hide the loupe.
    ToggleLoupe,
    /// Take the suggested match of the first click.
    AcceptSuggestion,
    /// Show or hide the list of all commands.
    TogglePalette,
    /// Change parameters, at the setting of this name; all changes of one until [`Command::EndDrag`] are one step.
    SetParameters {
        /// The setting that was changed.
        setting: &'static str,
        /// All parameters, with the change.
        to: Box<Parameters>,
    },
    /// Take all parameters back to those of the preset.
    ResetParameters,
    /// Do something with the rectified pair.
    Rectified(RectifiedCommand),
    /// Show a tab of the bottom panel.
    ShowTab(TabId),
    /// Fold the bottom panel away, or bring it back.
    FoldTabs,
    /// Fold the side panel away, or bring it back.
    FoldSide,
    /// Fold the row of overlays away, or bring it back.
    FoldOverlays,
    /// Fold the small images of the folder away, or bring them back.
    FoldStrip,
    /// Let the bottom panel take most of the window, or not.
    EnlargeTabs,
    /// Show or hide an overlay.
    ToggleOverlay(OverlayId),
    /// Remove a message.
    Dismiss(u64),
    /// Close the window.
    Quit,
}

/// Something to do with a session.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SessionCommand {
    /// Save in the file of the session, or ask where.
    Save,
    /// Ask where to save.
    SaveAs,
    /// Save in a file.
    SaveTo(PathBuf),
    /// Choose where to save with the system's dialog.
    BrowseSave,
    /// Open a session.
    Open(OpenSession),
    /// Choose an image that a session cannot find with the system's dialog.
    BrowseLost(Side),
    /// Remove the program's own copy of work that was not saved.
    DiscardLeftBehind(PathBuf),
}

/// Something to do with a file of another program.
#[derive(Debug, Clone, PartialEq)]
pub enum ExchangeCommand {
    /// Show the window for exporting.
    ShowExport,
    /// Choose the file of the export with the system's dialog, which suggests this path.
    BrowseExport(PathBuf),
    /// Write a file.
    Export(ExportOrder),
    /// Choose a file to import with the system's dialog.
    BrowseImport,
    /// Import files.
    Import(Vec<PathBuf>),
    /// Take the matrix that is being imported, in the reading of this number of the list; without a number as it is.
    Accept {
        /// Place in the list of the convention check.
        reading: Option<usize>,
        /// Whether the point pairs of its file take the place of those of the document.
        with_pairs: bool,
    },
    /// Do without the matrix that is being imported.
    Reject,
    /// Remove the imported geometry.
    RemoveImported,
}

/// What a file dialog is open for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PickPurpose {
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

impl From<RectifiedCommand> for Command {
    fn from(command: RectifiedCommand) -> Self {
        Self::Rectified(command)
    }
}

impl From<PlayerCommand> for Command {
    fn from(command: PlayerCommand) -> Self {
        Self::Player(command)
    }
}

impl From<TonesCommand> for Command {
    fn from(command: TonesCommand) -> Self {
        Self::Tones(command)
    }
}

impl From<PointsCommand> for Command {
    fn from(command: PointsCommand) -> Self {
        Self::Points(command)
    }
}

impl From<SessionCommand> for Command {
    fn from(command: SessionCommand) -> Self {
        Self::Session(command)
    }
}

impl From<ExchangeCommand> for Command {
    fn from(command: ExchangeCommand) -> Self {
        Self::Exchange(command)
    }
}
