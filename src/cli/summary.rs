//! An estimate in words and numbers, for people.

use std::fmt::Write;

use crate::estimate::Estimate;
use crate::geometry::{Frame, HomogeneousPoint, finite_point};
use crate::image::Picture;

/// What `epiline estimate` prints. F has all its digits, so that it can be copied.
pub(super) fn summary(found: &Estimate, pictures: &[Picture; 2]) -> String {
    let mut text = String::from("Fundamental matrix F (x2ᵀ F x1 = 0):\n");
    for row in found.fundamental.rows() {
        let cells = row.map(|v| format!("{:>25}", format!("{v:e}")));
        let _ = writeln!(text, " {}", cells.join(""));
    }
    for (k, epipole) in [found.epipole1, found.epipole2].iter().enumerate() {
        let place = place(epipole, pictures[k].frame());
        let _ = writeln!(text, "Epipole in image {}: {place}", k + 1);
    }
    if let Some(trust) = &found.trust {
        let _ = writeln!(text, "Verdict: {}", trust.verdict.label());
        for reason in &trust.reasons {
            let _ = writeln!(text, "  {reason}");
        }
    }
    if found.refined {
        let _ = writeln!(text, "Refined on {} patches matched along the epipolar lines", found.matches.len());
    }
    let _ = writeln!(text, "Score: {:.4} (lower is better)", found.score);
    let _ = writeln!(text, "Round trip: {:.3} px between lines and their return", found.round_trip_area);
    let _ = match found.margin {
        Some(margin) => writeln!(text, "Margin to the best clearly different geometry: {margin:.3}"),
        None => writeln!(text, "Margin: no clearly different geometry was found"),
    };
    for warning in &found.warnings {
        let _ = writeln!(text, "Warning: {warning}");
    }
    let counts = &found.counts;
    let _ = writeln!(
        text,
        "Examined: {} and {} lines, {} candidate line pairs, {} hypotheses, {} validated",
        list(&counts.lines1),
        list(&counts.lines2),
        list(&counts.candidates),
        counts.hypotheses,
        counts.validated
    );
    let stages: Vec<_> = found
        .timings
        .iter()
        .map(|t| format!("{} {:.3} s", t.stage.label().to_lowercase(), t.seconds))
        .collect();
    let _ = writeln!(text, "Time: {:.3} s, first F after {:.3} s", found.seconds, found.first_seconds);
    if !stages.is_empty() {
        let _ = writeln!(text, "      {}", stages.join(", "));
    }
    text
}

/// Where an epipole is: a position, or a direction when it is infinitely far.
fn place(epipole: &HomogeneousPoint, frame: Frame) -> String {
    if let Some(p) = finite_point(epipole) {
        let side = if frame.contains(p) { "inside" } else { "outside" };
        format!("({:.2}, {:.2}) px, {side} the image", p.x, p.y)
    } else {
        let angle = epipole.y.atan2(epipole.x).to_degrees().rem_euclid(180.0);
        format!("infinitely far, lines run at {angle:.2}° to the x axis (y is down)")
    }
}

/// Numbers of the clicks, one after another.
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
        let told = |x, y, z| place(&HomogeneousPoint::new(x, y, z), frame);
        assert_eq!(told(20.0, 10.0, 2.0), "(10.00, 5.00) px, inside the image");
        assert_eq!(told(-1000.0, 10.0, 1.0), "(-1000.00, 10.00) px, outside the image");
        assert!(told(-1.0, 0.0, 0.0).contains("0.00° to the x axis"));
        assert!(told(0.0, -1.0, 0.0).contains("90.00°"));
    }
}
