//! The actions that stand on buttons of dialogs and tables alone.

use std::path::PathBuf;

use super::action::{Action, action};
use crate::app::model::command::{Command, ExchangeCommand, SessionCommand};
use crate::app::model::document::Side;
use crate::app::model::exchange::ExportOrder;
use crate::app::model::focus::LineSource;
use crate::app::model::ids::OverlayId;
use crate::app::model::point_table::{Choosing, ChosenEdit, PointColumn, PointsCommand};
use crate::app::model::rectified::{Guides, RectifiedCommand};
use crate::app::model::session::OpenSession;
use crate::app::model::suggesting::Repair;
use crate::app::model::tones::{Rendition, TonesCommand};
use crate::io::{PictureFormat, RectifiedOptions};

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
        action(TonesCommand::Adjust(None), "Adjust", "Which of the images is adjusted."),
        action(
            TonesCommand::Set(Rendition::default()),
            "Tones",
            "Show the images brighter, darker or in other colours.",
        ),
        action(
            PointsCommand::Edit(ChosenEdit::Delete),
            "Delete chosen",
            "Remove the chosen pairs from both images.",
        ),
        action(
            PointsCommand::Edit(ChosenEdit::Use),
            "Use chosen",
            "Let the chosen pairs take part in the estimate.",
        ),
        action(
            PointsCommand::Edit(ChosenEdit::CheckOnly),
            "Check only chosen",
            "Let the chosen pairs only show how well the geometry fits.",
        ),
        action(
            PointsCommand::Edit(ChosenEdit::Exclude),
            "Leave out chosen",
            "Leave the chosen pairs out of estimate and measures.",
        ),
        action(
            PointsCommand::SortBy(PointColumn::Number),
            "Sort",
            "Sort the list; again turns the order around.",
        ),
        action(
            PointsCommand::Choose(0, Choosing::Only),
            "Choose the row",
            "Choose the row; Ctrl adds one, Shift all up to it.",
        ),
        action(PointsCommand::Rename(0, String::new()), "Name", "What you call the pair."),
        action(PointsCommand::Paste(String::new()), "Paste", "Add the point pairs of a table."),
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
            "Delete unsaved work",
            "Delete the copy of what was not saved, for good.",
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
        action(RectifiedCommand::Wipe(0.5), "Wipe", "Drag to see more of the one or the other picture."),
        action(
            RectifiedCommand::RunBlink,
            "By itself",
            "Let the two rectified pictures take turns by the clock.",
        ),
        browse(RectifiedCommand::Browse.into(), "Choose the folder in the system's dialog."),
        action(rectified, "Export rectified pair", "Write the files. Files of the same names are replaced."),
    ]
}
