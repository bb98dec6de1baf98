//! Words for signs that a calibration belongs to other pictures.

use crate::camera::{CameraDoubt, CameraModel};
use crate::geometry::Frame;

/// Returns the doubts about the cameras of both images of these sizes, each with its sentences.
pub fn camera_doubts(cameras: [(&CameraModel, Frame); 2]) -> Vec<(CameraDoubt, String)> {
    let of_side = |((camera, frame), side): ((&CameraModel, Frame), &'static str)| {
        let told = move |doubt| (doubt, camera_doubt_in_words(&doubt, side));
        camera.doubts(frame).into_iter().map(told)
    };
    cameras.into_iter().zip(["left", "right"]).flat_map(of_side).collect()
}

/// Describes a doubt about the camera of an image, `left` or `right`.
fn camera_doubt_in_words(doubt: &CameraDoubt, side: &str) -> String {
    match *doubt {
        CameraDoubt::PrincipalPoint { x, y, width, height, is_outside, larger } => {
            let place = if is_outside { "outside" } else { "far from the middle of" };
            let fact = format!(
                "The principal point ({x:.1}, {y:.1}) of the {side} camera lies {place} the picture of {width}×{height} px"
            );
            match larger {
                Some(by) => format!(
                    "{fact}. The calibration is probably for pictures {by:.2} times as large. \
                     Scale it, or use the calibration of this size."
                ),
                None => format!(
                    "{fact}. The calibration may be for pictures of another size, or for other pictures. \
                     Check that it belongs to these."
                ),
            }
        }
        CameraDoubt::Folds { share } => format!(
            "The lens of the {side} camera folds back inside the picture, so {:.0} % of the picture shows no ray. \
             That part is left out. Check the distortion and the size that the calibration is for.",
            (100.0 * share).max(1.0)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_doubt_names_the_fact_the_consequence_and_the_action() {
        let point = |larger| CameraDoubt::PrincipalPoint {
            x: 634.9,
            y: 379.8,
            width: 320,
            height: 240,
            is_outside: true,
            larger,
        };
        assert_eq!(
            camera_doubt_in_words(&point(Some(2.0)), "left"),
            "The principal point (634.9, 379.8) of the left camera lies outside the picture of 320×240 px. \
             The calibration is probably for pictures 2.00 times as large. Scale it, or use the calibration of this size."
        );
        for doubt in [point(None), CameraDoubt::Folds { share: 0.25 }] {
            assert_eq!(camera_doubt_in_words(&doubt, "right").split(". ").count(), 3);
        }
    }
}
