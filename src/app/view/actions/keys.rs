//! Actions with keyboard shortcuts.

use egui::{Key, Modifiers};

use super::action::{Action, action, tab};
use crate::app::model::crosshair::CrosshairCommand;
use crate::app::model::recording::PlayerCommand;
use crate::app::model::rectified::RectifiedCommand;
use crate::app::model::replay::ReplayCommand;
use crate::app::model::{Command, ExchangeCommand, Model, SessionCommand, StageId, TabId};

const NONE: Modifiers = Modifiers::NONE;
const COMMAND: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Groups of actions, in the order of the list of keys.
pub const GROUPS: [&str; 7] = ["Points", "Result", "Replay", "Files", "Display", "Panels", "Program"];

/// Returns the actions with shortcuts, in the order of the list of keys. A shortcut with Shift
/// comes before the same key without Shift, which would consume both.
#[expect(clippy::too_many_lines, reason = "it is a table")]
pub fn with_keys() -> Vec<Action> {
    let points = vec![
        action(
            Command::AcceptSuggestion,
            "Accept the suggested match",
            "Place the second point of the pair at the suggested match, or a point at the crosshair.",
        )
        .key(NONE, Key::Enter)
        .when(|model| model.accepted_suggestion().is_some() || model.open.crosshair.is_some()),
        action(
            CrosshairCommand::Toggle,
            "Crosshair",
            "Place points with the keyboard: arrow keys move the crosshair, Enter places a point, Tab changes the \
             picture, Escape gives up.",
        )
        .key(NONE, Key::P)
        .listed(|_| "Crosshair: place points with the keyboard")
        .when(|model| model.document.pictures.is_some()),
        action(CrosshairCommand::ChangePicture, "Crosshair to the other picture", "Put the crosshair into the other picture.")
            .key(NONE, Key::Tab)
            .when(|model| model.open.crosshair.is_some()),
        action(
            Command::ShowMe,
            "Show me how the lines are found",
            "Place two point pairs on the sample and show the geometry they give.",
        )
        .key(NONE, Key::S)
        .listed(|_| "Show me: place two pairs on the sample")
        .when(|model| model.open.show_me.is_some()),
        action(Command::Redo, "Redo", "Redo the last undone step.")
            .key(COMMAND_SHIFT, Key::Z)
            .key(COMMAND, Key::Y)
            .when(|model| model.history.can_redo()),
        action(Command::Undo, "Undo", "Undo the last step. A drag is one step.")
            .key(COMMAND, Key::Z)
            .when(|model| model.history.can_undo()),
        action(
            Command::DeleteSelected,
            "Delete the selected pair",
            "Remove the selected pair from both images. With the pin tool, remove the pinned line pair.",
        )
        .key(NONE, Key::Delete)
        .key(NONE, Key::Backspace)
        .when(|model| model.document.selection.is_some() || model.document.inspected_pin().is_some()),
    ];
    let result = vec![
        action(
            Command::ToggleTruth,
            "Ground truth",
            "Compare with the true geometry: its lines and matches in white, and the error of the result.",
        )
        .key(NONE, Key::G)
        .listed(|model| {
            if model.truth().is_some() { "Hide the ground truth" } else { "Compare with the ground truth" }
        })
        .when(|model| model.open.known().is_some()),
        action(Command::Recompute, "Compute again", "Run the estimate again from the same points.")
            .key(NONE, Key::F5)
            .when(|model| model.document.used_pairs().is_some()),
        action(
            Command::ChooseHypothesis(None),
            "Back to the result",
            "Show the result of the estimate in the whole window again.",
        )
        .key(NONE, Key::R)
        .when(Model::shows_another),
    ];
    let replay = vec![
        action(ReplayCommand::PlaySlowly, "Play slowly", "Replay the search at half speed, or pause.")
            .key(SHIFT, Key::Space)
            .listed(|_| "Replay: play at half speed")
            .when(Model::has_record),
        action(ReplayCommand::TogglePlay, "Play or pause", "Replay how the lines were found, or pause.")
            .key(NONE, Key::Space)
            .listed(|_| "Replay: play or pause how the lines were found")
            .when(Model::has_record),
        action(ReplayCommand::Step { forward: false }, "Previous step", "Replay the previous step alone.")
            .key(SHIFT, Key::N)
            .listed(|_| "Replay: previous step")
            .when(|model| model.document.pictures.is_some()),
        action(ReplayCommand::Step { forward: true }, "Next step", "Replay the next step alone.")
            .key(NONE, Key::N)
            .listed(|_| "Replay: next step")
            .when(|model| model.document.pictures.is_some()),
        action(
            ReplayCommand::Nudge { forward: false },
            "Back a little",
            "Go back by a few lines or a crossing of the replay. The player of sequences goes back by one frame.",
        )
        .key(NONE, Key::Comma)
        .listed(|_| "Replay: back by a few lines or a frame")
        .when(|model| model.has_record() || model.has_sequences()),
        action(
            ReplayCommand::Nudge { forward: true },
            "On a little",
            "Go on by a few lines or a crossing of the replay. The player of sequences goes on by one frame.",
        )
        .key(NONE, Key::Period)
        .listed(|_| "Replay: on by a few lines or a frame")
        .when(|model| model.has_record() || model.has_sequences()),
        action(ReplayCommand::Begin, "Beginning", "Show the beginning of the search.")
            .key(NONE, Key::Home)
            .listed(|_| "Replay: beginning")
            .when(Model::has_record),
        action(ReplayCommand::Finish, "Result", "Leave the replay and show the result.")
            .key(NONE, Key::End)
            .listed(|_| "Replay: result")
            .when(|model| model.replayed().is_some()),
    ];
    let files = vec![
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
            "Save points, parameters, pinned lines and views in one JSON file.",
        )
        .key(COMMAND, Key::S),
        action(
            Command::StepPair { forward: false },
            "Previous pair",
            "Open the previous pair of the folder.",
        )
        .key(NONE, Key::PageUp)
        .when(|model| model.has_neighbour(false)),
        action(
            Command::StepPair { forward: true },
            "Next pair",
            "Open the next pair of the folder. In a series of views, the two stay equally far apart.",
        )
        .key(NONE, Key::PageDown)
        .when(|model| model.has_neighbour(true)),
        action(
            RectifiedCommand::ShowExport,
            "Export rectified pair…",
            "Write the rectified pair at full size into a folder, with its homographies or tables and its \
             quality measures.",
        )
        .key(COMMAND_SHIFT, Key::E)
        .listed(|_| "Export rectified pair…")
        .when(|model| model.shown().is_some() && model.activity.writing.is_none()),
        action(
            ExchangeCommand::ShowExport(None),
            "Export…",
            "Write the geometry, the point pairs, the result, a profile or the view as a file for other programs.",
        )
        .key(COMMAND, Key::E)
        .listed(|_| "Export… (geometry, point pairs, report, profile, view)")
        .when(|model| model.document.pictures.is_some()),
    ];
    let display = vec![
        action(
            Command::TogglePinTool,
            "Pin tool",
            "Pin the epipolar lines through each place you click. Escape returns to placing points.",
        )
        .key(NONE, Key::I)
        .listed(|_| "Pin tool: pin line pairs")
        .when(|model| model.document.pictures.is_some()),
        action(
            Command::ToggleLink,
            "Link views",
            "Zoom and move both images together, each about the match of the other. Alt moves one alone.",
        )
        .key(NONE, Key::L),
        action(
            Command::ToggleStacked,
            "Stack vertically",
            "Show the images one above the other, or side by side. Wide images have more room when stacked.",
        )
        .key(NONE, Key::V)
        .listed(|_| "Stack the images vertically or show them side by side"),
        action(PlayerCommand::TogglePlay, "Play or pause", "Play the two sequences together, or pause.")
            .key(NONE, Key::K)
            .listed(|_| "Sequences: play or pause")
            .when(Model::has_sequences),
        action(
            PlayerCommand::ToggleSilhouettes,
            "Show motion",
            "Highlight everything that moves in front of the background. Motion barcodes are computed from \
             it.",
        )
        .key(NONE, Key::W)
        .listed(|_| "Sequences: show motion")
        .when(Model::has_sequences),
        action(Command::FitAll, "Fit", "Show both images completely. A double click fits one image.")
            .key(NONE, Key::F)
            .listed(|_| "Fit both images (zoom out)"),
        action(RectifiedCommand::Swap, "Swap", "Show the other rectified picture instead.")
            .key(NONE, Key::X)
            .listed(|_| "Rectified pair: show the other picture (blink)")
            .when(|model| model.stage() == StageId::Rectified),
    ];
    let panels = vec![
        action(
            Command::FoldDock,
            "Hide or show the dock",
            "Fold the dock to one line with the verdict, or unfold it.",
        )
        .key(NONE, Key::B),
        action(
            Command::ToggleAlone,
            "Pictures alone",
            "Show the pictures without bars and dock. Escape brings everything back.",
        )
        .key(NONE, Key::H)
        .key(NONE, Key::F11),
        tab(TabId::Step, Key::Num1, "The hypotheses of the search, or the chart of the step that is shown."),
        tab(TabId::Profiles, Key::Num2, "Intensities along one line pair, and the matching of its samples."),
        tab(TabId::Residuals, Key::Num3, "Distances of points from their epipolar lines."),
        tab(
            TabId::Compare,
            Key::Num4,
            "The result beside the 7-point and 8-point geometries, an imported one and the truth.",
        ),
        action(Command::ShowStage(StageId::Pictures), "Pictures", "Show the two pictures as opened.")
            .key(NONE, Key::Num5),
        action(
            Command::ShowStage(StageId::Rectified),
            "Rectified",
            "Show both images redrawn with corresponding points in the same row.",
        )
        .key(NONE, Key::Num6)
        .when(Model::can_rectify),
        action(
            Command::ShowStage(StageId::Scene),
            "3-D",
            "Show both cameras and the triangulated matches. This needs a calibration or the focal lengths.",
        )
        .key(NONE, Key::Num7)
        .listed(|_| "3-D: cameras and triangulated matches")
        .when(|model| model.can_rectify() && !model.compares_barcodes()),
    ];
    let program = vec![
        action(Command::TogglePalette, "Commands", "Search for any command by name and run it.")
            .key(COMMAND, Key::K)
            .key(COMMAND, Key::P)
            .while_typing(),
        action(
            Command::Cancel,
            "Cancel",
            "Cancel a drag or the first click of a pair, or close a dialog or the topmost message.",
        )
        .key(NONE, Key::Escape)
        .while_typing(),
        action(Command::ToggleTheme, "Light or dark theme", "Switch between the light and the dark theme.")
            .key(NONE, Key::T),
        action(Command::ToggleShortcuts, "Keys", "Show the keys and mouse actions.")
            .key(NONE, Key::Questionmark)
            .key(NONE, Key::F1)
            .listed(|_| "List of keys"),
        action(Command::Quit, "Quit", "Close the window.").key(COMMAND, Key::Q).while_typing(),
    ];
    let groups = [points, result, replay, files, display, panels, program];
    let named = GROUPS.into_iter().zip(groups);
    named.flat_map(|(group, own)| own.into_iter().map(move |action| Action { group, ..action })).collect()
}
