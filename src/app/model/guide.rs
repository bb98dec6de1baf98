//! The hint about the next step.

use super::Model;
use super::document::{Side, pair_name};
use super::look::Tool;

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
    if model.tool == Tool::Inspect {
        return if model.shown().is_some() {
            "Pin tool: click in an image to pin the pair of epipolar lines through that place. Escape goes back.".into()
        } else {
            "Pin tool: there are no epipolar lines to pin yet. Escape goes back to placing points.".into()
        };
    }
    if model.tool == Tool::Measure {
        return "Measure tool: click two places in one image. Escape removes the measurement.".into();
    }
    if let Some(half) = document.half {
        let name = pair_name(document.pairs.len());
        let other = half.side.other().name();
        let offer = match &model.open.suggestion {
            Some(Ok(found)) if found.clear().is_some() => "Enter accepts the suggested match.".to_owned(),
            Some(Ok(found)) => {
                format!("{}: click the match yourself, or press Escape to remove the point.", found.verdict)
            }
            Some(Err(_)) => "No match is suggested.".to_owned(),
            None => "Escape removes the point.".to_owned(),
        };
        return format!("Pair {name}: now click the same scene point in the {other} image. {offer}");
    }
    let needed = document.pairs_needed();
    match document.used().count() {
        _ if document.is_unclicked() && computation.is_running() => {
            "Searching automatically. Any points you add will be used.".into()
        }
        _ if document.is_unclicked() && computation.failure().is_some() => {
            "Click a distinct point in the left image, then its match in the right one. Two such \
             pairs fix the geometry."
                .into()
        }
        _ if document.is_unclicked() && computation.result().is_some() => {
            "Move the cursor over an image to see its epipolar line in the other, or click pairs \
             to make the geometry more certain."
                .into()
        }
        0 => "Click a point in the left image, then the same scene point in the right one. \
             Two such pairs give the epipolar geometry."
            .into(),
        placed if placed < needed => {
            let name = pair_name(document.pairs.len());
            format!(
                "{}: click pair {name} in the {} image, far from the others and in a textured place.",
                if needed - placed == 1 { "One more pair" } else { "Two more pairs" },
                Side::Left.name(),
            )
        }
        _ if computation.is_running() => "Estimating. Points can be dragged meanwhile.".into(),
        _ if computation.failure().is_some() => {
            "Drag the points to better places, or delete a pair and click another.".into()
        }
        _ if computation.result().is_none() => "The estimate was stopped. F5 computes again.".into(),
        _ => "Move the cursor over an image to see its epipolar line in the other. Drag points to \
              correct them, click more pairs to make the geometry more certain, or press I to pin \
              lines."
            .into(),
    }
}
