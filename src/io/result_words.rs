//! Result of an estimate as text for people.

use std::fmt::Write;

use super::geometry_file::{ImageNote, TrustNote};
use super::result_file::nested;
use crate::camera::PicturesOf;
use crate::estimate::{BarcodeFigures, Estimate, LineBands, SearchTrace};
use crate::geometry::{Frame, HomogeneousPoint, finite_point};
use crate::presentation::{
    NEAR_MATCHES, epipole_in_words, interpretation_in_words, is_open_elsewhere, origin_in_words,
    pictures_in_words, probability_in_words, story_in_words, warning_in_words,
};

/// Returns the rows of a matrix with all digits, a line each.
pub(super) fn matrix_in_words(rows: [[f64; 3]; 3]) -> String {
    rows.map(|row| format!(" {}\n", row.map(|v| format!("{:>25}", format!("{v:e}"))).concat())).concat()
}

/// Describes the positions of both epipoles with their uncertainty, a line each.
fn epipoles_in_words(found: &Estimate, images: &[ImageNote; 2]) -> String {
    let mut text = String::new();
    let frames = images.each_ref().map(|image| image.frame);
    let bearings = found.epipole_bearings(frames);
    for (k, epipole) in [found.fundamental().epipole1(), found.fundamental().epipole2()].iter().enumerate() {
        let place = place_in_words(epipole, images[k].frame);
        let bearing = bearings.as_ref().map(|bearings| &bearings[k]);
        let interval = epipole_in_words(bearing, found.determined(frames));
        let interval = interval.map_or_else(String::new, |interval| format!("; {interval}"));
        let _ = writeln!(text, "Epipole in image {}: {place}{interval}", k + 1);
    }
    if let Some(LineBands { typical, worst }) = found.line_bands(frames) {
        if is_open_elsewhere(found, frames) {
            let _ = writeln!(text, "{NEAR_MATCHES}");
        }
        let _ = writeln!(
            text,
            "Epipolar lines anywhere in the images: ± {typical:.2} px, one in twenty worse than ± {worst:.2} px (95 % bands)"
        );
    }
    text
}

/// Describes an epipole in words: its position, or its direction when it is at infinity.
fn place_in_words(epipole: &HomogeneousPoint, frame: Frame) -> String {
    if let Some(p) = finite_point(epipole) {
        let side = if frame.contains(p) { "inside" } else { "outside" };
        return format!("({:.2}, {:.2}) px, {side} the image", p.x, p.y);
    }
    let angle = epipole.y.atan2(epipole.x).to_degrees().rem_euclid(180.0);
    format!("infinitely far, lines run at {angle:.2}° to the x axis (y is down)")
}

/// Describes a result in words. F has all its digits, so that it can be copied.
pub fn result_in_words(found: &Estimate, images: &[ImageNote; 2], pictures: &PicturesOf) -> String {
    let note = TrustNote::of(found, images.each_ref().map(|image| image.frame));
    judged_in_words(found, images, pictures, note.as_ref())
}

/// Describes a result in words, with this verdict.
pub(super) fn judged_in_words(
    found: &Estimate,
    images: &[ImageNote; 2],
    pictures: &PicturesOf,
    note: Option<&TrustNote>,
) -> String {
    let mut text = String::from("Fundamental matrix F (x2ᵀ F x1 = 0):\n");
    text += &matrix_in_words(found.fundamental().rows());
    if pictures.is_undistorted() {
        let _ = writeln!(text, "{}", pictures_in_words(pictures, 0.0).join("\n"));
    }
    text += &epipoles_in_words(found, images);
    let assessment = &found.assessment;
    if let Some(note) = note {
        let frames = images.each_ref().map(|image| image.frame);
        // The figures of the lines may have told a reason already.
        let is_new = |reason: &&String| !text.contains(reason.trim_end_matches('.'));
        let reasons: Vec<&String> = note.reasons.iter().filter(is_new).collect();
        let _ = writeln!(text, "Verdict: {}", note.verdict);
        for reason in reasons {
            let _ = writeln!(text, "  {reason}");
        }
        if let Some(probability) = probability_in_words(found, frames) {
            let _ = writeln!(text, "{probability}");
        }
    }
    if let Some(plane) = &assessment.plane {
        let _ = writeln!(
            text,
            "Homography of the plane (x2 ∝ H x1), {:.2} px from {} of the matches ({:.0} %):",
            plane.residual,
            plane.matches,
            100.0 * plane.share
        );
        text += &matrix_in_words(nested(&plane.homography21));
    }
    if found.trace.as_ref().is_some_and(|trace| !trace.clicks.chosen().is_empty()) {
        text.push_str("Found without two clicks: two matches found by the program took their place\n");
    }
    if let Some(origin) = &found.origin {
        let _ = writeln!(text, "Proposed by {}", origin_in_words(origin));
    }
    let matches = found.matches().len();
    if assessment.of_given {
        let _ = writeln!(text, "Fitted to the given matches alone; {matches} patches match along its lines");
    } else if found.is_refined() {
        let _ = writeln!(text, "Refined on {matches} patches matched along the epipolar lines");
    }
    if let Some(barcodes) = &assessment.barcodes {
        let BarcodeFigures { correlation, by_chance, deviation, frames, .. } = *barcodes;
        let lines = barcodes.whole_lines();
        let _ = writeln!(
            text,
            "Motion barcodes of {frames} frames: corresponding lines correlate by {correlation:.3} (by chance up to {by_chance:.3}), {lines} of them independently"
        );
        if let Some(deviation) = deviation {
            let _ = writeln!(
                text,
                "Standard deviation of the epipolar lines where objects move: {deviation:.2} px"
            );
        }
    }
    if let Some(score) = found.line_score() {
        let _ = writeln!(text, "Score: {score:.4} (lower is better)");
    }
    if let Some(area) = assessment.lines.as_ref().and_then(|lines| lines.round_trip_area) {
        let _ = writeln!(text, "Round trip: {area:.3} px between the lines and their return");
    }
    let _ = match assessment.margin {
        Some(margin) => {
            writeln!(text, "Lead over the rival, the best clearly different geometry: {margin:.3}")
        }
        None => writeln!(text, "Lead over the rival: no clearly different geometry was found"),
    };
    if let Some(margin) = assessment.refined_margin {
        let _ = writeln!(text, "Lead with the other geometries refined too: {margin:.3}");
    }
    for warning in &assessment.warnings {
        let _ = writeln!(text, "Warning: {}", warning_in_words(warning));
    }
    if let Some(trace) = &found.trace {
        text += &trace_in_words(trace, images);
    }
    text
}

/// Describes the search of a result in words.
fn trace_in_words(trace: &SearchTrace, images: &[ImageNote; 2]) -> String {
    let mut text = String::new();
    let counts = &trace.counts;
    // With features only, no lines are compared.
    if !counts.lines1.is_empty() {
        // Lines through stand-ins for clicks are compared to look at, and propose nothing.
        let proposed = match counts.hypotheses {
            0 => String::new(),
            of => format!(", {of} hypotheses, {} validated", counts.validated),
        };
        let _ = writeln!(
            text,
            "Examined: {} and {} lines, {} candidate line pairs{proposed}",
            list(&counts.lines1),
            list(&counts.lines2),
            list(&counts.candidates)
        );
    }
    if counts.left_out > 0 {
        let _ = writeln!(
            text,
            "Left out: {} corners at the same position in both images, such as captions or a logo",
            counts.left_out
        );
    }
    for (k, image) in images.iter().enumerate() {
        if let Some(words) = interpretation_in_words(&image.interpretation) {
            let _ = writeln!(text, "Image {}: {words}", k + 1);
        }
    }
    let stages: Vec<_> = trace
        .timings
        .iter()
        .map(|t| format!("{} {:.3} s", t.stage.label().to_lowercase(), t.seconds))
        .collect();
    let _ = writeln!(text, "Time: {:.3} s, first F after {:.3} s", trace.seconds, trace.first_seconds);
    if !stages.is_empty() {
        let _ = writeln!(text, "      {}", stages.join(", "));
    }
    let story = story_in_words(&trace.events);
    if !story.is_empty() {
        text.push_str("Course of the search:\n");
    }
    for line in story {
        let _ = writeln!(text, "  {line}");
    }
    text
}

/// Lists the counts of the clicks.
fn list(numbers: &[usize]) -> String {
    if numbers.is_empty() {
        return "no".to_owned();
    }
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" + ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn epipoles_are_places_or_directions() {
        let frame = Frame::new(100, 50);
        let told = |x, y, z| place_in_words(&HomogeneousPoint::new(x, y, z), frame);
        assert_eq!(told(20.0, 10.0, 2.0), "(10.00, 5.00) px, inside the image");
        assert_eq!(told(-1000.0, 10.0, 1.0), "(-1000.00, 10.00) px, outside the image");
        assert!(told(-1.0, 0.0, 0.0).contains("0.00° to the x axis"));
        assert!(told(0.0, -1.0, 0.0).contains("90.00°"));
    }
}
