//! Actions offered only on buttons of dialogs and tables.

use std::path::PathBuf;

use super::action::{Action, action};
use crate::app::model::exchange::ExportOrder;
use crate::app::model::rectified::RectifiedCommand;
use crate::app::model::session::OpenSession;
use crate::app::model::{Command, ExchangeCommand, LineSource, OverlayId, Role, SessionCommand};
use crate::camera::FocalLength;

/// Returns the actions offered only on buttons of dialogs and tables.
#[expect(clippy::too_many_lines, reason = "it is a table")]
pub fn in_dialogs() -> Vec<Action> {
    vec![
        action(
            Command::OpenFiles(Vec::new()),
            "Open",
            "Replace the open images by these files. Unsaved points are kept and offered again.",
        ),
        action(
            Command::OpenFolder(PathBuf::new()),
            "Open folder",
            "Open the first pair of this folder. You can choose another pair afterwards.",
        ),
        action(
            Command::SetFocalLengths([FocalLength { pixels: 1.0, deviation: 0.0 }; 2]),
            "Use",
            "Use these focal lengths. The points stay as they are. Lengths known to ± 0 % also guide the search.",
        ),
        action(Command::DeletePair(0), "Delete", "Remove this pair from both images."),
        action(
            Command::SetRole(0, Role::Excluded),
            "Leave out",
            "Leave the pair out of the estimate and of all measures.",
        ),
        action(
            Command::Refine(0),
            "Refine",
            "Align the right point to a fraction of a pixel, near its present place.",
        ),
        action(
            Command::MoveToMatch(0),
            "Move to match",
            "Move the right point to its match on the epipolar line. This takes a reliable or doubtful result, \
             and a clear match in the images; without one, drag the point or leave the pair out.",
        ),
        action(Command::SetRole(0, Role::Used), "Use", "Use the pair for the estimate."),
        action(
            Command::SetRole(0, Role::Check),
            "Check only",
            "Use the pair only to measure how well the geometry fits, not for the estimate.",
        ),
        action(
            Command::Pin(LineSource::Pair(0)),
            "Pin lines",
            "Keep this pair of epipolar lines on the images and compare their intensities.",
        ),
        action(
            Command::Unpin(0),
            "Unpin",
            "Remove this pinned line pair from the images. With the pin tool, Delete does the same.",
        ),
        action(
            Command::ToggleOverlay(OverlayId::Points),
            "Show or hide",
            "Show or hide this in both images.",
        ),
        action(Command::ResetParameters, "Reset all", "Reset all parameters to the values of the preset."),
        action(
            SessionCommand::SaveTo(PathBuf::new()),
            "Save session",
            "Save points, parameters, pinned lines and views in one JSON file.",
        ),
        action(
            SessionCommand::Open(OpenSession::default()),
            "Open session",
            "Open this session with its images and points.",
        ),
        action(
            SessionCommand::DiscardLeftBehind(PathBuf::new()),
            "Delete unsaved work",
            "Delete the unsaved work. This cannot be undone.",
        ),
        action(
            ExchangeCommand::Export(ExportOrder::default()),
            "Export file",
            "Write the file, or the files of a rectified pair. Existing files of the same names are replaced.",
        ),
        action(
            ExchangeCommand::Import(Vec::new()),
            "Import",
            "Import point pairs, a fundamental matrix or two cameras for the open images.",
        ),
        action(
            ExchangeCommand::Accept { reading: None, with_pairs: false },
            "Import matrix",
            "Import the matrix with the marked reading, or unchecked as the file has it, and show its geometry.",
        ),
        action(ExchangeCommand::Reject, "Cancel", "Import nothing from this file."),
        action(
            RectifiedCommand::ToggleGuides,
            "Guide lines",
            "Draw horizontal lines over the rectified pictures, for comparing rows, or hide them.",
        ),
        action(
            RectifiedCommand::ToggleTurned,
            "Turned to fit",
            "Show pictures that are unrolled about an epipole turned by 90°, one above the other, or as in the files.",
        ),
        action(
            RectifiedCommand::RunBlink,
            "Automatic",
            "Alternate the two rectified pictures automatically.",
        ),
    ]
}
