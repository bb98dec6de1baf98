//! The intensities along the inspected line pair as a table for other programs.

use std::fmt::Write;

use crate::app::model::inspection::Inspection;
use crate::io::TrustNote;

/// What the columns mean, a sentence a line.
pub const CONVENTION: [&str; 3] = [
    "Pixels: x to the right, y down; the centre of the upper left pixel is (0, 0). Intensities go from 0 to 255.",
    "A row is a sample of the left line, in equal steps; distance is along that line from its anchor, px.",
    "x2, y2 and right_matched are of the sample of the right line that was matched; they are empty outside the image.",
];

/// Comma-separated values, one row a sample of the left line. Comment lines begin with `#`.
pub fn csv(inspection: &Inspection, trust: Option<&TrustNote>) -> String {
    let mut text = String::from("# Intensities along two lines, written by epiline ");
    text.push_str(env!("CARGO_PKG_VERSION"));
    text.push('\n');
    for sentence in CONVENTION {
        let _ = writeln!(text, "# {sentence}");
    }
    if let Some(trust) = trust {
        let _ = writeln!(text, "# The geometry shown, which the lines may come from, is {}.", trust.verdict);
        for reason in &trust.reasons {
            let _ = writeln!(text, "#   {reason}");
        }
    }
    text.push_str("distance,x1,y1,left,right_unmatched,shift,x2,y2,right_matched,cost\n");
    let warped = &inspection.warped;
    for (k, sample) in inspection.samples().enumerate() {
        let optional = |value: Option<u8>| value.map_or(String::new(), |value| value.to_string());
        let Some(point1) = inspection.point1(sample) else { continue };
        let (x2, y2) = inspection
            .point2(sample)
            .map_or((String::new(), String::new()), |p| (format!("{:.3}", p.x), format!("{:.3}", p.y)));
        let shift = warped.matching.disparities.get(k).map(|d| f64::from(*d) * inspection.step);
        let cost = warped.matching.sample_costs.get(k).map_or(String::new(), ToString::to_string);
        let _ = writeln!(
            text,
            "{:.3},{:.3},{:.3},{},{},{},{x2},{y2},{},{cost}",
            f64::from(sample) * inspection.step,
            point1.x,
            point1.y,
            optional(warped.profile1.get(sample)),
            optional(warped.profile2.get(sample)),
            shift.map_or(String::new(), |shift| format!("{shift:.3}")),
            optional(warped.warped2.get(k).copied().flatten()),
        );
    }
    text
}
