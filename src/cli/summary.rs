//! An estimate in words and numbers, for people.

use std::fmt::Write;

use crate::estimate::Estimate;
use crate::geometry::place_in_words;
use crate::image::Picture;

/// What `epiline estimate` prints. F has all its digits, so that it can be copied.
pub(super) fn summary(found: &Estimate, pictures: &[Picture; 2]) -> String {
    let mut text = String::from("Fundamental matrix F (x2ᵀ F x1 = 0):\n");
    for row in found.fundamental.rows() {
        let cells = row.map(|v| format!("{:>25}", format!("{v:e}")));
        let _ = writeln!(text, " {}", cells.join(""));
    }
    for (k, epipole) in [found.epipole1, found.epipole2].iter().enumerate() {
        let place = place_in_words(epipole, pictures[k].frame());
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

/// Numbers of the clicks, one after another.
fn list(numbers: &[usize]) -> String {
    if numbers.is_empty() {
        return "no".to_owned();
    }
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" + ")
}
