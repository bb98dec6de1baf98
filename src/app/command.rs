//! Every action of the window: its name, its explanation and its keys in one place.
//!
//! Panels and panes return commands; [`super::Inspector`] applies them in one place.

use std::path::PathBuf;

use egui::{Key, KeyboardShortcut, Modifiers};

use super::comparison::{Contestant, Subject};
use super::document::{PointRef, Side};
use super::exchange::ExchangeCommand;
use super::focus::{LineSource, Target};
use super::panels::tabs::TABS;
use super::rectified::RectifiedCommand;
use super::session::SessionCommand;
use crate::estimate::{Method, Parameters, Preset};
use crate::evaluate::Protocol;
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
    /// Open files; `None` keeps the picture that is open.
    OpenFiles([Option<PathBuf>; 2]),
    /// Open the first pair of a folder whose geometry is known.
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
    /// Put true matches drawn at random in place of the pairs that the geometry is estimated from.
    RandomTrial(Protocol),
    /// Place two point pairs on the built-in pair.
    ShowMe,
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
    /// Show a tab of the bottom panel, by its number.
    ShowTab(usize),
    /// Fold the bottom panel away, or bring it back.
    FoldTabs,
    /// Let the bottom panel take most of the window, or not.
    EnlargeTabs,
    /// Show or hide an overlay, by its number in the list of overlays.
    ToggleOverlay(usize),
    /// Remove a message.
    Dismiss(u64),
    /// Close the window.
    Quit,
}

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

const fn key(modifiers: Modifiers, key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(modifiers, key)
}

impl Command {
    /// The actions that have keys, in the order of the list of keys. Where one key is another one's with
    /// Shift, the one with Shift comes first, or it would never be seen.
    pub fn with_keys() -> [Self; 35] {
        [
            Self::TogglePalette,
            Self::AcceptSuggestion,
            Self::ToggleInspectTool,
            Self::ToggleLink,
            Self::ToggleMap,
            Self::ShowOpenDialog,
            Self::Session(SessionCommand::SaveAs),
            Self::Session(SessionCommand::Save),
            Self::ShowMe,
            Self::StepPair { forward: false },
            Self::StepPair { forward: true },
            Self::ToggleTruth,
            Self::RandomTrial(Protocol::Paper),
            Self::RandomTrial(Protocol::WellPosed),
            Self::Redo,
            Self::Undo,
            Self::DeleteSelected,
            Self::Cancel,
            Self::FitAll,
            Self::Recompute,
            Self::EnlargeTabs,
            Self::FoldTabs,
            Self::ShowTab(0),
            Self::ShowTab(1),
            Self::ShowTab(2),
            Self::ShowTab(3),
            Self::ShowTab(4),
            Self::ShowTab(5),
            Self::Rectified(RectifiedCommand::Swap),
            Self::Rectified(RectifiedCommand::ShowExport),
            Self::Exchange(ExchangeCommand::ShowExport),
            Self::ChooseHypothesis(None),
            Self::ToggleTheme,
            Self::ToggleShortcuts,
            Self::Quit,
        ]
    }

    /// What it is called on buttons and in lists.
    pub fn name(&self) -> &'static str {
        match self {
            Self::ShowOpenDialog | Self::OfferFile(_) => "Open images",
            Self::OpenSample => "Sample",
            Self::OpenFiles(_) => "Open",
            Self::OpenFolder(_) => "Open folder",
            Self::Session(command) => command.name(),
            Self::Exchange(command) => command.name(),
            Self::Browse(_) | Self::BrowseFolder => "Browse",
            Self::OpenViews(_) => "Open these views",
            Self::StepPair { forward: true } => "Next pair",
            Self::StepPair { forward: false } => "Previous pair",
            Self::ToggleTruth => "Ground truth",
            Self::RandomTrial(Protocol::Paper) => "Random trial of the paper",
            Self::RandomTrial(_) => "Random trial",
            Self::ShowMe => "Show me",
            Self::Undo => "Undo",
            Self::Redo => "Redo",
            Self::DeleteSelected => "Delete the selected pair",
            Self::DeletePair(_) => "Delete",
            Self::IncludePair(..) => "Include or leave out",
            Self::ClearPairs => "Clear points",
            Self::Cancel => "Cancel",
            Self::FitAll | Self::FitAfterDoubleClick(_) => "Fit",
            Self::ToggleTheme => "Light or dark",
            Self::ToggleShortcuts => "Keys",
            Self::Stop => "Stop",
            Self::Recompute => "Compute again",
            Self::Place(..) => "Place a point",
            Self::Drag(..) | Self::EndDrag => "Drag a point",
            Self::Nudge(_) => "Nudge the selected point",
            Self::Select(_) => "Select a point",
            Self::SetMethod(_) => "Pairs used",
            Self::SetPreset(_) => "Preset",
            Self::PointAt(_) => "Point at something",
            Self::ChooseHypothesis(None) => "Back to the result",
            Self::ChooseHypothesis(Some(_)) => "Show a hypothesis",
            Self::ChooseContestant(_) => "Show this geometry",
            Self::Compare(_) => "Choose what is compared",
            Self::Pin(_) => "Pin a line pair",
            Self::Inspect(_) => "Inspect a pinned line pair",
            Self::Unpin(_) => "Unpin",
            Self::UnpinAll => "Unpin all lines",
            Self::ToggleInspectTool => "Inspect",
            Self::ToggleLink => "Link views",
            Self::ToggleMap => "Epipole map",
            Self::ToggleLoupe => "Loupe",
            Self::AcceptSuggestion => "Accept the suggested match",
            Self::TogglePalette => "Commands",
            Self::SetParameters { .. } => "Change a parameter",
            Self::ResetParameters => "Reset all parameters",
            Self::Rectified(command) => command.name(),
            Self::ShowTab(number) => TABS[*number].title,
            Self::FoldTabs => "Hide or show the panel",
            Self::EnlargeTabs => "Enlarge",
            Self::ToggleOverlay(_) => "Show or hide",
            Self::Dismiss(_) => "Dismiss message",
            Self::Quit => "Quit",
        }
    }

    /// One sentence about what it does.
    pub fn tooltip(&self) -> &'static str {
        match self {
            Self::ShowOpenDialog | Self::OfferFile(_) => {
                "Open two images of the same scene. Dropping them on the window does the same."
            }
            Self::OpenSample => "Open the built-in image pair.",
            Self::OpenFiles(_) => "Open these files. Point pairs of the images before are removed.",
            Self::OpenFolder(_) => {
                "Open a folder whose geometry is known, in the VGG layout or one of pairs with true matches."
            }
            Self::Session(command) => command.tooltip(),
            Self::Exchange(command) => command.tooltip(),
            Self::Browse(_) => "Choose the file in the system's file dialog.",
            Self::BrowseFolder => "Choose the folder in the system's dialog.",
            Self::OpenViews(_) => {
                "Open these two views of the folder. Point pairs of the images before are removed."
            }
            Self::StepPair { forward: true } => {
                "Open the next pair of the folder; of a sequence of views, the next two as far apart."
            }
            Self::StepPair { forward: false } => "Open the pair of the folder before this one.",
            Self::ToggleTruth => {
                "Compare with the true geometry: its lines and matches in blue, and the error of the result."
            }
            Self::RandomTrial(Protocol::Paper) => {
                "Estimate from true matches drawn as the paper does: at least 30 px apart, even if that leaves the epipoles open."
            }
            Self::RandomTrial(_) => {
                "Estimate from true matches drawn at random, far apart and off each other's epipolar lines; others each \
                 time. With Shift as the paper draws them."
            }
            Self::ShowMe => "Place two point pairs on the sample and see the geometry they give.",
            Self::Undo => "Take the last step back; a drag is one step.",
            Self::Redo => "Make the step again that was taken back.",
            Self::DeleteSelected => {
                "Remove the pair of the selected point from both images; with the inspect tool, the pinned line pair."
            }
            Self::DeletePair(_) => "Remove this pair from both images.",
            Self::IncludePair(..) => {
                "A pair left out counts neither for the estimate nor for the summary; the next one takes its place."
            }
            Self::ClearPairs => "Remove all point pairs. Undo brings them back.",
            Self::Cancel => "Give up what is half done: a drag, the first click of a pair, a window.",
            Self::FitAll => "Show both images whole. A double click does it for one.",
            Self::FitAfterDoubleClick(_) => "Show this image whole.",
            Self::ToggleTheme => "Change between the light and the dark theme.",
            Self::ToggleShortcuts => "Show the keys and mouse actions.",
            Self::Stop => "Stop the computation; a first result stays.",
            Self::Recompute => "Run the estimate again from the same points.",
            Self::Place(..) => "Click a scene point in one image, then the same point in the other.",
            Self::Drag(..) | Self::EndDrag => "Move a point; the geometry follows.",
            Self::Nudge(_) => "Arrow keys move the selected point by 0.1 px, with Shift by 1 px.",
            Self::Select(_) => "Select this point for the arrow keys and Delete.",
            Self::SetMethod(_) => {
                "Estimate from two pairs (p and q), or from three (p, q and r), which is faster and steadier."
            }
            Self::SetPreset(_) => {
                "Robust measured best on real images; Paper follows the published method to the letter."
            }
            Self::PointAt(_) => "What is under the cursor lights up everywhere else.",
            Self::ChooseHypothesis(None) => "Show the result of the estimate in the whole window again.",
            Self::ChooseHypothesis(Some(_)) => {
                "Show this hypothesis in the whole window instead of the result."
            }
            Self::ChooseContestant(_) => "Show this geometry in the whole window instead of the result.",
            Self::Compare(_) => "Choose the points, the distance, and what the other methods are fitted to.",
            Self::Pin(_) => "Keep these two lines on the images and compare their intensities.",
            Self::Inspect(_) => "Compare the intensities of this line pair.",
            Self::Unpin(_) => "Remove this line pair from the images.",
            Self::UnpinAll => "Remove all pinned line pairs from the images.",
            Self::ToggleInspectTool => {
                "Pin the pair of epipolar lines through each place you click; Escape goes back to placing points."
            }
            Self::ToggleLink => "Zoom and move both images together.",
            Self::ToggleMap => "Show where the epipoles are, inside and far outside the images.",
            Self::ToggleLoupe => "Magnify the surroundings of a point while it is placed or dragged.",
            Self::AcceptSuggestion => "Place the second point of the pair at the suggested match.",
            Self::TogglePalette => "List every command by name, to search and run.",
            Self::SetParameters { .. } => "Change a parameter of the estimate.",
            Self::ResetParameters => "Take all parameters back to those of the preset.",
            Self::ShowTab(number) => TABS[*number].tooltip,
            Self::FoldTabs => "Fold the bottom panel away, or bring it back.",
            Self::EnlargeTabs => {
                "Let the bottom panel take most of the window, or go back to its usual height."
            }
            Self::Rectified(command) => command.tooltip(),
            Self::ToggleOverlay(_) => "Show or hide this in both images.",
            Self::Dismiss(_) => "Remove this message.",
            Self::Quit => "Close the window.",
        }
    }

    /// Its keys, the first one being the one that is shown.
    pub fn shortcuts(&self) -> &'static [KeyboardShortcut] {
        match self {
            Self::ShowOpenDialog => const { &[key(Modifiers::COMMAND, Key::O)] },
            Self::Session(SessionCommand::Save) => const { &[key(Modifiers::COMMAND, Key::S)] },
            Self::Session(SessionCommand::SaveAs) => const { &[key(COMMAND_SHIFT, Key::S)] },
            Self::ShowMe => const { &[key(Modifiers::NONE, Key::S)] },
            Self::Undo => const { &[key(Modifiers::COMMAND, Key::Z)] },
            Self::Redo => const { &[key(COMMAND_SHIFT, Key::Z), key(Modifiers::COMMAND, Key::Y)] },
            Self::DeleteSelected => {
                const { &[key(Modifiers::NONE, Key::Delete), key(Modifiers::NONE, Key::Backspace)] }
            }
            Self::StepPair { forward: true } => const { &[key(Modifiers::NONE, Key::PageDown)] },
            Self::StepPair { forward: false } => const { &[key(Modifiers::NONE, Key::PageUp)] },
            Self::ToggleTruth => const { &[key(Modifiers::NONE, Key::G)] },
            Self::RandomTrial(Protocol::WellPosed) => const { &[key(Modifiers::NONE, Key::N)] },
            Self::RandomTrial(Protocol::Paper) => const { &[key(Modifiers::SHIFT, Key::N)] },
            Self::Quit => const { &[key(Modifiers::COMMAND, Key::Q)] },
            Self::Cancel => const { &[key(Modifiers::NONE, Key::Escape)] },
            Self::FitAll => const { &[key(Modifiers::NONE, Key::F)] },
            Self::ToggleInspectTool => const { &[key(Modifiers::NONE, Key::I)] },
            Self::ToggleLink => const { &[key(Modifiers::NONE, Key::L)] },
            Self::ToggleMap => const { &[key(Modifiers::NONE, Key::M)] },
            Self::AcceptSuggestion => const { &[key(Modifiers::NONE, Key::Enter)] },
            Self::TogglePalette => {
                const { &[key(Modifiers::COMMAND, Key::K), key(Modifiers::COMMAND, Key::P)] }
            }
            Self::Recompute => const { &[key(Modifiers::NONE, Key::F5)] },
            Self::FoldTabs => const { &[key(Modifiers::NONE, Key::B)] },
            Self::EnlargeTabs => const { &[key(Modifiers::SHIFT, Key::B)] },
            Self::ShowTab(0) => const { &[key(Modifiers::NONE, Key::Num1)] },
            Self::ShowTab(1) => const { &[key(Modifiers::NONE, Key::Num2)] },
            Self::ShowTab(2) => const { &[key(Modifiers::NONE, Key::Num3)] },
            Self::ShowTab(3) => const { &[key(Modifiers::NONE, Key::Num4)] },
            Self::ShowTab(4) => const { &[key(Modifiers::NONE, Key::Num5)] },
            Self::ShowTab(5) => const { &[key(Modifiers::NONE, Key::Num6)] },
            Self::Rectified(command) => command.shortcuts(),
            Self::Exchange(command) => command.shortcuts(),
            Self::ChooseHypothesis(None) => const { &[key(Modifiers::NONE, Key::R)] },
            Self::ToggleTheme => const { &[key(Modifiers::NONE, Key::T)] },
            Self::ToggleShortcuts => {
                const { &[key(Modifiers::NONE, Key::Questionmark), key(Modifiers::NONE, Key::F1)] }
            }
            _ => &[],
        }
    }

    /// Whether its keys work while a text field or a dialog has the keyboard.
    pub(super) fn works_while_typing(&self) -> bool {
        matches!(self, Self::ShowOpenDialog | Self::TogglePalette | Self::Cancel | Self::Quit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_two_commands_share_a_key_and_each_has_a_name_and_a_tooltip() {
        let mut seen = HashSet::new();
        for command in Command::with_keys() {
            assert!(!command.shortcuts().is_empty(), "{command:?}");
            assert!(!command.name().is_empty() && command.tooltip().ends_with('.'), "{command:?}");
            for shortcut in command.shortcuts() {
                assert!(seen.insert(*shortcut), "{shortcut:?} twice");
            }
        }
    }

    #[test]
    fn longer_shortcuts_come_before_the_ones_they_contain() {
        let mut seen: Vec<KeyboardShortcut> = Vec::new();
        for shortcut in Command::with_keys().iter().flat_map(Command::shortcuts) {
            let hidden = seen.iter().any(|earlier| {
                earlier.logical_key == shortcut.logical_key
                    && shortcut.modifiers.matches_logically(earlier.modifiers)
            });
            assert!(!hidden, "{shortcut:?} would never be seen");
            seen.push(*shortcut);
        }
    }
}
