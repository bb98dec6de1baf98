//! Words for relative poses.

use std::fmt::Write;

use nalgebra::Vector3;

use crate::camera::{PoseDifference, PoseFit, RelativePose, ViewPair};

/// Why a result that is limited to one plane or a rotation of the camera has no pose.
pub const NO_BASELINE: &str = "The epipole is not determined, so there is no baseline and no depth.";

/// Describes a relative pose: rotation, place of camera 2, parallax, each on a line of its own.
pub fn pose_in_words(fit: &PoseFit) -> String {
    let PoseFit { pose, noise, matches, in_front, parallax, uncertainty, .. } = fit;
    let deviation = |radians: f64| format!(" ± {:.2}°", radians.to_degrees());
    let [turn_error, place_error] = match uncertainty {
        Some(u) => [deviation(u.rotation), deviation(u.translation)],
        None => [String::new(), String::new()],
    };
    let mut text = String::from("Relative pose (x2 = R x1 + t, |t| = 1; ± is a standard deviation):\n");
    text += &turned(pose, &turn_error);
    let _ = writeln!(
        text,
        "  It lies in the direction {}{place_error} from camera 1 (x right, y down, z forwards)",
        triple(&pose.position2())
    );
    let _ = writeln!(
        text,
        "  Matches: parallax {:.2}° (median), {noise:.3} px from their epipolar lines (median), {in_front} of {matches} \
         in front of both cameras",
        parallax.to_degrees()
    );
    text
}

/// Names the focal lengths that a pose rests on, on a line; empty if they are unknown.
pub fn focal_lengths_in_words(views: &ViewPair) -> String {
    let [Some(left), Some(right)] = views.views.each_ref().map(|view| view.camera().focal_length()) else {
        return String::new();
    };
    let deviation = 100.0 * views.focal_deviation();
    let known =
        if deviation > 0.0 { format!("guesses, known to {deviation:.0} %") } else { "calibrated".into() };
    format!("Focal lengths: {:.1} and {:.1} px, {known}\n", left.pixels, right.pixels)
}

/// Describes the rotation of a relative pose, on a line.
pub fn turn_in_words(pose: &RelativePose) -> String {
    turned(pose, "")
}

fn turned(pose: &RelativePose, deviation: &str) -> String {
    let axis = pose.rotation.axis().map_or_else(String::new, |axis| format!(" about {}", triple(&axis)));
    let angle = pose.angle().to_degrees();
    format!("  Camera 2 is turned by {angle:.2}°{deviation}{axis}\n")
}

/// Describes how far the pose of a calibration is from the pose that the matches show, if they show one.
pub fn pose_difference_in_words(difference: Option<&PoseDifference>) -> String {
    let Some(difference) = difference else { return format!("The pose cannot be judged. {NO_BASELINE}") };
    let PoseDifference { rotation, translation, uncertainty, is_significant } = difference;
    let [rotation, translation, turn_error, place_error] =
        [*rotation, *translation, uncertainty.rotation, uncertainty.translation].map(f64::to_degrees);
    let sense = if *is_significant { "more than chance explains" } else { "which may be chance" };
    format!(
        "The pose that fits the matches best differs from the calibration by {rotation:.2}° ± {turn_error:.2}° in \
         rotation and {translation:.2}° ± {place_error:.2}° in the direction of the baseline, {sense}."
    )
}

fn triple(v: &Vector3<f64>) -> String {
    format!("({:.4}, {:.4}, {:.4})", v.x, v.y, v.z)
}
