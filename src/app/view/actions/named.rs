//! Actions listed among all commands, without keyboard shortcuts.

use super::action::{Action, action};
use crate::app::model::command::PickPurpose;
use crate::app::model::comparison::Contestant;
use crate::app::model::dock::DockEdge;
use crate::app::model::exchange::ExportKind;
use crate::app::model::point_table::PointsCommand;
use crate::app::model::recording::PlayerCommand;
use crate::app::model::rectified::{RectifiedCommand, RectifiedLayout};
use crate::app::model::replay::ReplayCommand;
use crate::app::model::verdict::USE_LENS;
use crate::app::model::{Command, ExchangeCommand, MethodStep, Model, Side};
use crate::estimate::{Method, Preset, Search};
use crate::io::Notation;
use crate::rectify::RectifyMethod;
use crate::synthetic::Sample;

/// Returns the actions that are listed among all commands and have no shortcuts.
#[expect(clippy::too_many_lines, reason = "it is a table")]
pub fn by_name() -> Vec<Action> {
    let methods = "Choose how many point pairs the published search uses. Three pairs are faster and more \
                   stable than two.";
    let presets = "Robust is best on real images. As published follows the paper exactly (--preset paper).";
    let layouts = "Show the rectified pictures side by side, alternating, or as disparities.";
    let layout = |layout| {
        action(RectifiedCommand::LayOut(layout), "Layout of the rectified pair", layouts)
            .when(|model| model.open.rectified.is_some())
    };
    let method = |method| {
        action(Command::SetMethod(method), "Published method", methods)
            .when(|model| model.document.parameters.search == Search::Lines)
    };
    let preset = |preset| action(Command::SetPreset(preset), "Preset", presets);
    let place = "Put the dock at the bottom or at the right, or where it costs the pictures least.";
    let dock = |edge| action(Command::PlaceDock(edge), "Place of the dock", place);
    let copy = |notation: Notation, tooltip| {
        action(ExchangeCommand::CopyFundamental(notation), notation.name(), tooltip)
            .when(|model| model.shown().is_some())
    };
    let turn = |side: Side| {
        action(
            Command::TurnView(side),
            "Turn clockwise by 90°",
            "Turn the image on the screen clockwise. Its coordinates stay as they are.",
        )
        .when(|model| model.document.pictures.is_some())
    };
    vec![
        turn(Side::Left).listed(|_| "Turn the left view clockwise by 90°"),
        turn(Side::Right).listed(|_| "Turn the right view clockwise by 90°"),
        action(
            Command::SwapImages,
            "Swap the images",
            "Exchange the left and the right image, with all points. The result is computed again.",
        )
        .listed(|_| "Swap the images")
        .when(|model| model.document.is_of_files()),
        copy(Notation::NumPy, "Copy F of the shown geometry as Python code that makes a NumPy array.")
            .listed(|_| "Copy F, the fundamental matrix, as NumPy"),
        copy(Notation::Cpp, "Copy F of the shown geometry as C++ code that makes a cv::Matx33d.")
            .listed(|_| "Copy F as C++ (OpenCV)"),
        copy(
            Notation::Matlab,
            "Copy F of the shown geometry as MATLAB code. MATLAB counts pixels from 1, and so does this F.",
        )
        .listed(|_| "Copy F as MATLAB"),
        copy(Notation::Latex, "Copy F of the shown geometry as a LaTeX matrix, rounded to six digits.")
            .listed(|_| "Copy F as LaTeX"),
        copy(Notation::Json, "Copy F of the shown geometry as JSON, which Epiline reads, too.")
            .listed(|_| "Copy F as JSON"),
        action(
            ExchangeCommand::ShowExport(Some(ExportKind::Colmap)),
            "Export to COLMAP…",
            "Add the shown geometry and its matches to a copy of a database of COLMAP.",
        )
        .listed(|_| "Export to a COLMAP database…")
        .when(|model| ExportKind::Colmap.missing(model).is_none()),
        action(
            Command::CopyView,
            "Copy the view",
            "Copy a picture of both images with their overlays, as on the screen.",
        )
        .listed(|_| "Copy the view as a picture")
        .when(|model| model.document.pictures.is_some()),
        action(
            Command::OpenSample(Sample::Alley),
            "Sample",
            "Open the built-in image pair of an alley: a step forward, with the epipoles in view.",
        )
        .listed(|_| "Open the sample images"),
        action(
            Command::OpenSample(Sample::Courtyard),
            "Second sample",
            "Open the built-in image pair of a courtyard: a step aside, with the epipoles far outside.",
        )
        .listed(|_| "Open the second sample images"),
        action(
            ReplayCommand::Play(MethodStep::default()),
            "Replay a step",
            "Replay this step of the search alone, and pause at its end.",
        ),
        action(
            Command::OpenSampleSequences,
            "Sample sequences",
            "Open the built-in sequences: flying balls, seen by two fixed cameras far apart.",
        )
        .listed(|_| "Open the sample sequences"),
        action(
            PlayerCommand::Exchange,
            "Frames or search",
            "Exchange the player of the frames and the replay of the search.",
        )
        .listed(|model| {
            if model.shows_player() {
                "Sequences: show the replay of the search"
            } else {
                "Sequences: show the player of the frames"
            }
        })
        .when(Model::has_sequences),
        action(
            PlayerCommand::FindOffset,
            "Find offset",
            "Find the time offset at which the two sequences agree best, up to 50 frames either way.",
        )
        .listed(|_| "Sequences: find their offset in time")
        .when(|model| model.has_sequences() && !model.activity.aligning),
        action(
            Command::FindWithoutClicks,
            "Find without clicks",
            "Let Epiline find the geometry on its own, from similar features of both images. A single \
             point pair takes part; more of them then only check the result.",
        )
        .listed(|_| "Find the geometry without clicks")
        .when(Model::can_find_without_clicks),
        action(
            Command::Browse(PickPurpose::Folder),
            "Browse",
            "Choose the file or the folder in the system dialog.",
        ),
        action(
            Command::Browse(PickPurpose::Import),
            "Browse",
            "Choose a file with point pairs, matches, a fundamental matrix, two cameras or a calibration of the \
             lens distortion in the system dialog.",
        )
        .listed(|_| "Import a file…")
        .when(|model| model.document.pictures.is_some()),
        action(
            Command::JudgeRows,
            "Is the pair rectified?",
            "Compare the rows of the matches over the whole picture, and tell by how much they differ.",
        )
        .listed(|_| "Is the pair rectified?")
        .when(|model| model.document.pictures.is_some()),
        action(
            Command::ShowFocalLengths,
            "Focal lengths…",
            "Give the focal lengths of pictures without a calibration, for 3-D points and the pose of the cameras.",
        )
        .listed(|_| "Focal lengths… (for 3-D points)")
        .when(|model| model.open.takes_focal_lengths()),
        action(
            Command::UseLens,
            USE_LENS,
            "Correct the radial distortion that explains the matches clearly better, and estimate again. The pictures \
             stay as they are; their epipolar lines are curves then.",
        )
        .listed(|_| USE_LENS)
        .when(|model| model.offered_lens().is_some()),
        action(
            Command::RemoveCalibration,
            "Remove the lens correction",
            "Take the pictures as they are, without the lens and the focal lengths that were given or fitted.",
        )
        .listed(|_| "Remove the lens correction")
        .when(|model| model.open.views().is_some()),
        action(
            Command::KeepMatches,
            "Turn matches into point pairs",
            "Turn up to nine matches, spread over the images, into point pairs, to inspect and correct them. \
             They only check the geometry until you use them.",
        )
        .listed(|_| "Turn matches into point pairs")
        .when(Model::can_keep_matches),
        action(
            Command::PlaceAtMark,
            "Add a pair at the mark",
            "Place the left point of a new pair where it narrows the geometry most.",
        )
        .listed(|_| "Add a pair where it helps most")
        .when(|model| matches!(model.open.next_click, Some(Some(_)))),
        action(
            Command::ToggleUnreliableLines,
            "Show lines anyway",
            "Draw the epipolar lines although the geometry is unreliable, or hide them again.",
        )
        .listed(
            |model| if model.open.lines_anyway { "Hide unreliable lines" } else { "Show unreliable lines" },
        )
        .when(|model| model.lines_switch().is_some()),
        action(ReplayCommand::NextSpeed, "Speed", "Change the speed of the replay: ¼, ½, 1, 2 or 4 times.")
            .listed(|_| "Replay: next speed"),
        action(
            ReplayCommand::ToggleStill,
            "Still steps",
            "Show only the last moment of each step, without motion, or play the steps again.",
        )
        .listed(|model| if model.look.still_steps { "Replay: play the steps" } else { "Replay: still steps" }),
        dock(None).listed(|_| "Dock: automatic place"),
        dock(Some(DockEdge::Bottom)).listed(|_| "Dock: at the bottom"),
        dock(Some(DockEdge::Right)).listed(|_| "Dock: at the right"),
        action(Command::ClearPairs, "Remove all pairs", "Remove all point pairs. Undo brings them back.")
            .listed(|_| "Remove all point pairs")
            .when(|model| !model.document.pairs.is_empty() || model.document.half.is_some()),
        action(
            Command::ToggleStretch,
            "Stretch brightness",
            "Show the darkest pixels of each image black and the brightest white, or both images as in their files. \
             Computations are not affected.",
        )
        .listed(|model| {
            if model.open.stretched.is_some() {
                "Brightness: as in the files"
            } else {
                "Stretch brightness from black to white"
            }
        })
        .when(|model| model.document.pictures.is_some()),
        action(
            PointsCommand::Copy,
            "Copy",
            "Copy all point pairs as a table for a spreadsheet (Ctrl+C).",
        )
        .listed(|_| "Copy the point pairs as a table")
        .when(|model| !model.document.pairs.is_empty()),
        action(
            PointsCommand::RequestPaste,
            "Paste",
            "Add the point pairs of a copied table: rows of x1 y1 x2 y2, optionally with a name in front \
             (Ctrl+V).",
        )
        .listed(|_| "Paste point pairs")
        .when(|model| model.document.pictures.is_some()),
        action(Command::Stop, "Stop", "Stop the computation. A first result is kept.")
            .listed(|_| "Stop the computation")
            .when(|model| model.open.computation.is_running()),
        action(Command::UnpinAll, "Unpin all", "Remove all pinned line pairs from the images.")
            .listed(|_| "Unpin all lines")
            .when(|model| !model.document.pins.is_empty()),
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
        action(
            ExchangeCommand::RemoveGiven,
            "Remove the given matches",
            "Search without the imported matches. Undo brings them back.",
        )
        .listed(|_| "Remove the given matches")
        .when(|model| model.document.given.is_some()),
        action(
            ExchangeCommand::EditGiven,
            "Make point pairs",
            "Turn the given matches into point pairs, each of which can be dragged. Their weights are lost. Undo brings \
             them back.",
        )
        .listed(|_| "Turn the given matches into point pairs")
        .when(Model::can_edit_given),
        action(
            ExchangeCommand::GiveImported("the point pairs".to_owned()),
            "Make given matches",
            "Turn the imported point pairs into given matches, which nobody has to edit. Pairs that you moved stay. Undo \
             goes back.",
        )
        .listed(|_| "Turn the imported point pairs into given matches")
        .when(Model::can_give_imported),
        method(Method::TwoPoint).listed(|_| "Published search: two-point method"),
        method(Method::ThreePoint).listed(|_| "Published search: three-point method"),
        preset(Preset::Robust).listed(|_| "Preset: robust"),
        preset(Preset::Paper).listed(|_| "Preset: paper"),
        action(
            RectifiedCommand::SetMethod(RectifyMethod::Auto),
            "Rectification method",
            "Planar if that distorts the images little, otherwise polar. The reason is given below.",
        )
        .listed(|_| "Rectify: choose the method automatically"),
        action(
            RectifiedCommand::SetMethod(RectifyMethod::Planar),
            "Rectification method",
            "One homography per image: straight lines stay straight. Impossible with an epipole inside an \
             image.",
        )
        .listed(|_| "Rectify: planar method"),
        action(
            RectifiedCommand::SetMethod(RectifyMethod::Polar),
            "Rectification method",
            "One row per pair of half epipolar lines. Works wherever the epipoles are, but bends straight \
             lines.",
        )
        .listed(|_| "Rectify: polar method"),
        layout(RectifiedLayout::SideBySide).listed(|_| "Rectified pair side by side"),
        layout(RectifiedLayout::Blink).listed(|_| "Rectified pair alternating (blink)"),
        layout(RectifiedLayout::Disparity).listed(|_| "Rectified pair: disparities"),
        action(
            RectifiedCommand::Shift(0.0),
            "No shift",
            "Show the rectified pictures without a shift. A click on a point aligns them at its depth.",
        )
        .listed(|_| "Rectified pair: no shift")
        .when(|model| model.open.viewing.shift != 0.0),
        action(
            RectifiedCommand::View(None),
            "Fit the rectified pair",
            "Show the rectified pictures completely. A double click does the same.",
        )
        .listed(|_| "Fit the rectified pair")
        .when(|model| model.open.rectified.is_some()),
        action(RectifiedCommand::StopExport, "Stop", "Stop writing the rectified pair.")
            .listed(|_| "Stop the export of the rectified pair")
            .when(|model| model.activity.writing.is_some()),
    ]
}
