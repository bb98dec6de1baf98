//! The actions with keys.

use egui::{Key, Modifiers};

use super::action::{Action, action, tab};
use super::conditions::{has_neighbour, has_rectified, has_sequences, has_strip};
use crate::app::model::Model;
use crate::app::model::command::{Command, ExchangeCommand, SessionCommand};
use crate::app::model::ids::TabId;
use crate::app::model::recording::PlayerCommand;
use crate::app::model::rectified::RectifiedCommand;

const NONE: Modifiers = Modifiers::NONE;
const COMMAND: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;
const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Actions with keys, in the order of the list of keys. Where one key is another one's with Shift, the one with Shift comes
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
            Command::ToggleStacked,
            "Images above each other",
            "Show the images above each other, or side by side: what gives wide images more room.",
        )
        .key(NONE, Key::V)
        .listed(|_| "Images above each other or side by side"),
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
            PlayerCommand::TogglePlay,
            "Play or pause",
            "Play the two sequences together, or pause.",
        )
        .key(NONE, Key::K)
        .listed(|_| "Sequences: play or pause")
        .when(has_sequences),
        action(PlayerCommand::Step(-1), "Frame before", "Show the frame before this one.")
            .key(NONE, Key::Comma)
            .listed(|_| "Sequences: frame before")
            .when(has_sequences),
        action(PlayerCommand::Step(1), "Next frame", "Show the next frame.")
            .key(NONE, Key::Period)
            .listed(|_| "Sequences: next frame")
            .when(has_sequences),
        action(
            PlayerCommand::ToggleSilhouettes,
            "What moves",
            "Mark what moves in front of the background: what the motion barcodes of lines are made of.",
        )
        .key(NONE, Key::W)
        .listed(|_| "Sequences: mark what moves")
        .when(has_sequences),
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
        action(
            Command::FoldStrip,
            "Hide or show the images of the folder",
            "Fold the small images of the folder away, or bring them back.",
        )
        .key(NONE, Key::A)
        .when(has_strip),
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
