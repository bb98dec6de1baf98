//! The hint about the next step.

use super::Model;
use super::document::pair_name;
use super::look::Tool;
use super::verdict::Tone;
use crate::suggest::Clarity;

/// The verdict has the reason and the advice. Any other advice could contradict it.
const NO_RESULT: &str = "There is no result. The verdict says why, and what helps.";

/// Returns a hint about the next step.
pub fn guide(model: &Model) -> String {
    let (document, computation) = (&model.document, &model.open.computation);
    if document.pictures.is_none() {
        return if model.activity.loading {
            "Opening the images.".into()
        } else {
            "Drop two images of the same scene on this window, or open them.".into()
        };
    }
    if model.drawn_moment().is_some() {
        return if model.is_live() {
            "The steps of the search are drawn as they come.".into()
        } else {
            "Space plays or pauses, comma and full stop go by a few lines, N to the next step. End shows the result."
                .into()
        };
    }
    if let Some(hint) = document.too_small() {
        return hint;
    }
    if model.tool == Tool::Inspect {
        return if model.shown().is_some() {
            "Pin tool: click to pin the epipolar lines through a place. Escape goes back.".into()
        } else {
            "Pin tool: there are no epipolar lines to pin yet. Escape goes back to placing points.".into()
        };
    }
    if model.open.crosshair.is_some() {
        return "Crosshair: arrow keys move it (Shift 10 px, Alt 0.1 px), Enter places the point, Tab changes the picture, \
                Escape gives up."
            .into();
    }
    if document.half.is_some() {
        let name = pair_name(document.pairs.len());
        let offer = match &model.open.suggestion {
            Some(Ok(found)) if found.clear().is_some() => "Enter accepts the suggested match.".to_owned(),
            Some(Ok(found)) => match found.verdict {
                Clarity::Ambiguous => "Several places look alike.",
                Clarity::NoReturn => "Searching back from the best place ends elsewhere.",
                Clarity::Weak | Clarity::Clear => "No place looks very similar.",
            }
            .to_owned(),
            Some(Err(_)) => "No match is suggested.".to_owned(),
            None => "Escape removes the point.".to_owned(),
        };
        return format!("Pair {name}: now click the same scene point in the other image. {offer}");
    }
    let needed = document.pairs_needed();
    match document.used().count() {
        _ if document.is_unclicked() && computation.is_running() => {
            "Searching automatically. Any points you add will be used.".into()
        }
        _ if document.is_unclicked() && computation.failure().is_some() => NO_RESULT.into(),
        _ if document.is_unclicked() && computation.result().is_some() => {
            // No click determines the epipole of a plane or of a turned camera.
            let is_open = model.epipole_is_open();
            let more =
                if model.tone() == Tone::Good || is_open { "" } else { " Click pairs for more certainty." };
            format!("Point at an image to see its epipolar line in the other.{more}")
        }
        0 if model.lesson().is_some() => {
            "Every point of one picture lies on a line in the other. Move the mouse over a picture to see it."
                .into()
        }
        0 => "Click a point in one image, then the same scene point in the other.".into(),
        placed if placed < needed => {
            let name = pair_name(document.pairs.len());
            format!(
                "{}: click {name} in either image, on texture and far from the others.",
                if needed - placed == 1 { "One more pair" } else { "Two more pairs" },
            )
        }
        _ if computation.is_running() => "Estimating. Points can be dragged meanwhile.".into(),
        _ if computation.failure().is_some() => NO_RESULT.into(),
        _ if computation.result().is_none() => "The estimate was stopped. F5 computes again.".into(),
        _ => "Point at an image to see its epipolar line in the other. Drag points, or press I to pin lines."
            .into(),
    }
}
