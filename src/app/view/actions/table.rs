//! The entries of the table of actions.

use std::path::PathBuf;

use egui::{Key, Modifiers};

use super::{Action, action, tab};
use crate::app::model::Model;
use crate::app::model::command::{Command, ExchangeCommand, SessionCommand};
use crate::app::model::comparison::Contestant;
use crate::app::model::document::Side;
use crate::app::model::exchange::ExportOrder;
use crate::app::model::focus::LineSource;
use crate::app::model::ids::{OverlayId, TabId};
use crate::app::model::rectified::{Guides, RectifiedCommand, RectifiedLayout};
use crate::app::model::session::OpenSession;
use crate::app::model::suggesting::Repair;
use crate::estimate::{Method, Preset, Search};
use crate::evaluate::Protocol;
use crate::io::{PictureFormat, RectifiedOptions};
use crate::rectify::RectifyMethod;

const NONE: Modifiers = Modifiers::NONE;
const COMMAND: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Those with keys, in the order of the list of keys. Where one key is another one's with Shift, the one with Shift comes
/// first, or it would never be seen.
#[expect(clippy::too_many_lines, reason = "it is a table")]
pub fn with_keys() -> Vec<Action> {
    vec![
        action(Command::TogglePalette, "Commands", "List every command by name, to search and run.")
            .key(COMMAND, Key::K)
            .key(COMMAND, Key::P)
            .while_typing()
            // It closes this very list.
            .when(|_| false),
        action(
            Command::AcceptSuggestion,
            "Accept the suggested match",
            "Place the second point of the pair at the suggested match.",
        )
        .key(NONE, Key::Enter)
        .when(|model| model.accepted_suggestion().is_some()),
        action(
            Command::ToggleInspectTool,
            "Pin tool",
            "Pin the pair of epipolar lines through each place you click; Escape goes back to placing points.",
        )
        .key(NONE, Key::I)
        .listed(|_| "Pin tool: pin line pairs"),
        action(Command::ToggleLink, "Link views", "Zoom and move both images together.").key(NONE, Key::L),
        action(
            Command::ToggleMap,
            "Epipole map",
            "Show where the epipoles are, inside and far outside the images.",
        )
        .key(NONE, Key::M),
        action(
            Command::ShowOpenDialog,
            "Open images",
            "Open two images of the same scene. Dropping them on the window does the same.",
        )
        .key(COMMAND, Key::O)
        .while_typing(),
        action(SessionCommand::SaveAs, "Save session as", "Save the session in another file.")
            .key(COMMAND_SHIFT, Key::S),
        action(
            SessionCommand::Save,
            "Save session",
            "Save points, parameters, pinned lines and views in one readable file.",
        )
        .key(COMMAND, Key::S),
        action(
            Command::ShowMe,
            "Show me",
            "Place two point pairs on the sample and see the geometry they give.",
        )
        .key(NONE, Key::S)
        .listed(|_| "Show me: place two pairs on the sample")
        .when(|model| model.open.show_me.is_some()),
        action(
            Command::StepPair { forward: false },
            "Previous pair",
            "Open the pair of the folder before this one.",
        )
        .key(NONE, Key::PageUp)
        .when(|model| has_neighbour(model, false)),
        action(
            Command::StepPair { forward: true },
            "Next pair",
            "Open the next pair of the folder; of a sequence of views, the next two as far apart.",
        )
        .key(NONE, Key::PageDown)
        .when(|model| has_neighbour(model, true)),
        action(
            Command::ToggleTruth,
            "Ground truth",
            "Compare with the true geometry: its lines and matches in blue, and the error of the result.",
        )
        .key(NONE, Key::G)
        .listed(|model| {
            if model.truth().is_some() { "Hide the ground truth" } else { "Compare with the ground truth" }
        })
        .when(|model| model.open.known.is_some()),
        action(
            Command::RandomTrial(Protocol::Paper),
            "Random trial of the paper",
            "Estimate from true matches drawn as the paper does: at least 30 px apart, even if that leaves the \
             epipoles open.",
        )
        .key(SHIFT, Key::N)
        .listed(|_| "Random trial: two true matches, as in the paper")
        .when(|model| model.no_trial().is_none()),
        action(
            Command::RandomTrial(Protocol::WellPosed),
            "Random trial",
            "Estimate from true matches drawn at random, far apart and off each other's epipolar lines; others each \
             time. With Shift as the paper draws them.",
        )
        .key(NONE, Key::N)
        .listed(|_| "Random trial: two true matches, well-posed")
        .when(|model| model.no_trial().is_none()),
        action(Command::Redo, "Redo", "Make the step again that was taken back.")
            .key(COMMAND_SHIFT, Key::Z)
            .key(COMMAND, Key::Y)
            .when(|model| model.history.can_redo()),
        action(Command::Undo, "Undo", "Take the last step back; a drag is one step.")
            .key(COMMAND, Key::Z)
            .when(|model| model.history.can_undo()),
        action(
            Command::DeleteSelected,
            "Delete the selected pair",
            "Remove the pair of the selected point from both images; with the pin tool, the pinned line pair.",
        )
        .key(NONE, Key::Delete)
        .key(NONE, Key::Backspace)
        .when(|model| model.document.selection.is_some() || model.open.focus.inspected().is_some()),
        action(
            Command::Cancel,
            "Cancel",
            "Give up what is half done: a drag, a window, the topmost message, the first click of a pair.",
        )
        .key(NONE, Key::Escape)
        .while_typing()
        // So does this.
        .when(|_| false),
        action(Command::FitAll, "Fit", "Show both images whole. A double click does it for one.")
            .key(NONE, Key::F)
            .listed(|_| "Fit both images"),
        action(Command::Recompute, "Compute again", "Run the estimate again from the same points.")
            .key(NONE, Key::F5)
            .when(|model| model.document.used_pairs().is_some()),
        action(
            Command::EnlargeTabs,
            "Enlarge",
            "Let the bottom panel take most of the window, or go back to its usual height.",
        )
        .key(SHIFT, Key::B)
        .listed(|_| "Enlarge or reduce the panel"),
        action(
            Command::FoldTabs,
            "Hide or show the bottom panel",
            "Fold the bottom panel away, or bring it back.",
        )
        .key(NONE, Key::B),
        action(
            Command::FoldSide,
            "Hide or show the side panel",
            "Fold the panel with the result and the steps away, or bring it back.",
        )
        .key(NONE, Key::P)
        .listed(|_| "Hide or show the side panel"),
        action(
            Command::FoldOverlays,
            "Hide or show the overlay row",
            "Fold the row of overlays under the images away, or bring it back; the menu View has all of them, too.",
        )
        .key(NONE, Key::O)
        .listed(|_| "Hide or show the overlay row"),
        tab(
            TabId::Points,
            Key::Num1,
            "The clicked pairs, what each is for, and how far each is from the geometry.",
        ),
        tab(
            TabId::Profiles,
            Key::Num2,
            "Intensities along one line pair, and how its samples were matched.",
        ),
        tab(
            TabId::Pencils,
            Key::Num3,
            "How alike the lines through a click in one image are to those through it in the other.",
        ),
        tab(
            TabId::Hypotheses,
            Key::Num4,
            "The geometries that came nearest, with the figures they were judged by.",
        ),
        tab(
            TabId::Residuals,
            Key::Num5,
            "How far points are from the result, from 7-point and 8-point, and from the ground truth.",
        ),
        tab(
            TabId::Rectified,
            Key::Num6,
            "Both images redrawn so that corresponding points are in the same row.",
        ),
        action(
            RectifiedCommand::Swap,
            "Swap",
            "Show the other rectified picture in the place of this one.",
        )
        .key(NONE, Key::X)
        .listed(|_| "Rectified pair: show the other picture")
        .when(has_rectified),
        action(
            RectifiedCommand::ShowExport,
            "Export",
            "Write the rectified pair at full size into a folder, with its homographies or tables and its measures.",
        )
        .key(COMMAND_SHIFT, Key::E)
        .listed(|_| "Export rectified pair…")
        .when(|model| model.shown().is_some() && model.activity.writing.is_none()),
        action(
            ExchangeCommand::ShowExport,
            "Export…",
            "Write the geometry, the point pairs, the result, a profile or the view as a file for other programs.",
        )
        .key(COMMAND, Key::E)
        .listed(|_| "Export… (geometry, point pairs, report, profile, view)")
        .when(|model| model.document.pictures.is_some()),
        action(
            Command::ChooseHypothesis(None),
            "Back to the result",
            "Show the result of the estimate in the whole window again.",
        )
        .key(NONE, Key::R)
        .when(Model::shows_another),
        action(Command::ToggleTheme, "Light or dark", "Change between the light and the dark theme.")
            .key(NONE, Key::T),
        action(Command::ToggleShortcuts, "Keys", "Show the keys and mouse actions.")
            .key(NONE, Key::Questionmark)
            .key(NONE, Key::F1)
            .listed(|_| "List of keys"),
        action(Command::Quit, "Quit", "Close the window.").key(COMMAND, Key::Q).while_typing(),
    ]
}

/// Those that are in the list of all commands, without keys.
pub fn by_name() -> Vec<Action> {
    let methods = "The published search finds the geometry from two pairs, or from three, which is faster and steadier.";
    let presets = "Robust measured best on real images; Paper follows the published method to the letter.";
    let layouts = "Show the rectified pictures side by side, by turns, or red and cyan.";
    let layout = |layout| action(RectifiedCommand::LayOut(layout), "Layout of the rectified pair", layouts);
    vec![
        action(
            Command::ToggleLoupe,
            "Loupe",
            "Magnify the surroundings of a point while it is placed or dragged.",
        )
        .listed(|_| "Loupe while placing points"),
        action(Command::OpenSample, "Sample", "Open the built-in image pair.")
            .listed(|_| "Open the sample images"),
        action(Command::ClearPairs, "Clear points", "Remove all point pairs. Undo brings them back.")
            .listed(|_| "Clear all points")
            .when(|model| !model.document.pairs.is_empty() || model.document.half.is_some()),
        action(Command::Stop, "Stop", "Stop the computation; a first result stays.")
            .listed(|_| "Stop the computation")
            .when(|model| model.open.computation.is_running()),
        action(Command::UnpinAll, "Unpin all", "Remove all pinned line pairs from the images.")
            .listed(|_| "Unpin all lines")
            .when(|model| !model.open.focus.pins().is_empty()),
        action(
            Command::ChooseContestant(Contestant::Imported),
            "Show this geometry",
            "Show this geometry in the whole window instead of the result.",
        )
        .listed(|_| "Show the imported geometry")
        .when(|model| model.document.imported.is_some()),
        action(
            ExchangeCommand::RemoveImported,
            "Remove the imported geometry",
            "Remove the imported geometry. Undo brings it back.",
        )
        .listed(|_| "Remove the imported geometry")
        .when(|model| model.document.imported.is_some()),
        action(Command::SetMethod(Method::TwoPoint), "Published method", methods)
            .listed(|_| "Published search: two-point method")
            .when(is_published_search),
        action(Command::SetMethod(Method::ThreePoint), "Published method", methods)
            .listed(|_| "Published search: three-point method")
            .when(is_published_search),
        action(Command::SetPreset(Preset::Robust), "Preset", presets).listed(|_| "Preset: robust"),
        action(Command::SetPreset(Preset::Paper), "Preset", presets).listed(|_| "Preset: paper"),
        action(
            RectifiedCommand::SetMethod(RectifyMethod::Auto),
            "Rectification method",
            "Planar where it bends the images little, else polar; the reason is given below.",
        )
        .listed(|_| "Rectify: choose the method automatically"),
        action(
            RectifiedCommand::SetMethod(RectifyMethod::Planar),
            "Rectification method",
            "One homography an image: straight lines stay straight. Impossible with an epipole inside an image.",
        )
        .listed(|_| "Rectify: planar method"),
        action(
            RectifiedCommand::SetMethod(RectifyMethod::Polar),
            "Rectification method",
            "A row for each pair of half epipolar lines: works wherever the epipoles are, but bends straight lines.",
        )
        .listed(|_| "Rectify: polar method"),
        layout(RectifiedLayout::SideBySide).listed(|_| "Rectified pair side by side").when(has_rectified),
        layout(RectifiedLayout::Blink).listed(|_| "Rectified pair by turns (blink)").when(has_rectified),
        layout(RectifiedLayout::Anaglyph)
            .listed(|_| "Rectified pair as anaglyph, red and cyan")
            .when(has_rectified),
        action(
            RectifiedCommand::View(None),
            "Fit the rectified pair",
            "Show the rectified pictures whole; a double click does it, too.",
        )
        .listed(|_| "Fit the rectified pair")
        .when(has_rectified),
        action(RectifiedCommand::StopExport, "Stop", "Stop writing the rectified pair.")
            .listed(|_| "Stop the export of the rectified pair")
            .when(|model| model.activity.writing.is_some()),
    ]
}

/// What stands on buttons of dialogs and tables alone.
#[expect(clippy::too_many_lines, reason = "it is a table")]
pub fn in_dialogs() -> Vec<Action> {
    let browse = |command: Command, tooltip| action(command, "Browse", tooltip);
    let accept = |reading| ExchangeCommand::Accept { reading, with_pairs: false };
    let options = RectifiedOptions { format: PictureFormat::Png, guide_spacing: 0, maps: false };
    let rectified = RectifiedCommand::Export { folder: PathBuf::new(), options };
    vec![
        action(
            Command::OpenFiles(Vec::new()),
            "Open",
            "Open these files in place of those that are open. Points that are not saved are kept aside and offered again.",
        ),
        action(
            Command::OpenFolder(PathBuf::new()),
            "Open folder",
            "Open the first pair of this folder; any two of its images can be chosen then.",
        ),
        browse(Command::Browse(Side::Left), "Choose the file in the system's file dialog."),
        browse(Command::BrowseFolder, "Choose the folder in the system's dialog."),
        action(Command::DeletePair(0), "Delete", "Remove this pair from both images."),
        action(
            Command::IncludePair(0, true),
            "Include or leave out",
            "A pair left out counts neither for the estimate nor for the summary.",
        ),
        action(
            Command::Repair(0, Repair::Refine),
            "Refine",
            "Align the right point to a fraction of a pixel around where it is.",
        ),
        action(
            Command::Repair(0, Repair::Rematch),
            "Move to match",
            "Move the right point to the best match on its epipolar line. It takes a result that is not called unreliable.",
        ),
        action(Command::CheckOnly(0, false), "Use", "Let the pair take part in the estimate."),
        action(
            Command::CheckOnly(0, true),
            "Check only",
            "Keep the pair out of the estimate: it only shows how well the geometry fits.",
        ),
        action(Command::Select(None), "Select a point", "Select this point for the arrow keys and Delete."),
        action(
            Command::Pin(LineSource::Pair(0)),
            "Pin lines",
            "Keep this pair of epipolar lines on the images and compare their intensities.",
        ),
        action(
            Command::Unpin(0),
            "Unpin",
            "Remove the chosen line pair from the images; Delete does it with the pin tool.",
        ),
        action(
            Command::ToggleOverlay(OverlayId::Points),
            "Show or hide",
            "Show or hide this in both images.",
        ),
        action(Command::ResetParameters, "Reset all", "Take all parameters back to those of the preset."),
        action(
            SessionCommand::SaveTo(PathBuf::new()),
            "Save session",
            "Save points, parameters, pinned lines and views in one readable file.",
        ),
        browse(SessionCommand::BrowseSave.into(), "Choose where to save in the system's dialog."),
        action(
            SessionCommand::Open(OpenSession::default()),
            "Open session",
            "Open this session with its images and points.",
        ),
        browse(SessionCommand::BrowseLost(Side::Left).into(), "Choose the file in the system's file dialog."),
        action(
            SessionCommand::DiscardLeftBehind(PathBuf::new()),
            "Discard",
            "Remove the copy of what was not saved.",
        ),
        browse(
            ExchangeCommand::BrowseExport(PathBuf::new()).into(),
            "Choose where to write in the system's dialog.",
        ),
        action(
            ExchangeCommand::Export(ExportOrder::default()),
            "Export this",
            "Write the file; one of the same name is replaced.",
        ),
        browse(
            ExchangeCommand::BrowseImport.into(),
            "Choose a file with point pairs or a fundamental matrix in the system's dialog.",
        ),
        action(
            ExchangeCommand::Import(Vec::new()),
            "Import",
            "Import point pairs, a fundamental matrix or two cameras for the images that are open.",
        ),
        action(
            accept(Some(0)),
            "Use this reading",
            "Take the matrix in the reading that is marked, and show its geometry in the whole window.",
        ),
        action(accept(None), "As it is", "Take the matrix as its file has it, whatever the matches say."),
        action(ExchangeCommand::Reject, "Cancel", "Import nothing of this file."),
        action(
            RectifiedCommand::SetGuides(Guides::Automatic),
            "Guide lines",
            "Horizontal lines over the rectified pictures, to compare rows by.",
        ),
        action(
            RectifiedCommand::RunBlink,
            "By itself",
            "Let the two rectified pictures take turns by the clock.",
        ),
        browse(RectifiedCommand::Browse.into(), "Choose the folder in the system's dialog."),
        action(rectified, "Export rectified pair", "Write the files. Files of the same names are replaced."),
    ]
}

fn has_neighbour(model: &Model, forward: bool) -> bool {
    model.folder().is_some_and(|(folder, pair)| folder.neighbour(pair, forward).is_some())
}

fn is_published_search(model: &Model) -> bool {
    model.document.parameters.search == Search::Lines
}

fn has_rectified(model: &Model) -> bool {
    model.open.rectified.is_some()
}
