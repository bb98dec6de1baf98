//! Tables of the inspected line pair: intensities, or motion barcodes.

use std::fmt::Write;

use crate::app::model::inspection::Inspection;
use crate::app::model::recording::InspectedBarcodes;
use crate::camera::PicturesOf;
use crate::io::TrustNote;
use crate::motion::Barcode;
use crate::presentation::pictures_in_words;

/// Meaning of the columns, one sentence per line.
pub const CONVENTION: [&str; 3] = [
    "Pixels: x to the right, y down; the centre of the upper left pixel is (0, 0). Intensities go from 0 to 255.",
    "A row is a sample of the left line, in equal steps; distance is along that line from its anchor, px, and so is shift.",
    "x2, y2 and right_matched belong to the matched sample of the right line. They are empty outside the image.",
];

/// Meaning of the columns of barcodes, one sentence per line.
pub const BARCODE_CONVENTION: [&str; 2] = [
    "A row is a frame of the left sequence, counted from 0, and the frame of the right sequence taken at the same time.",
    "left and right are 1 where something moving crosses the line of that image, else 0.",
];

/// Returns comma-separated values, one row per frame. Comment lines begin with `#`.
pub fn barcodes_csv(inspected: &InspectedBarcodes, offset: i32, trust: Option<&TrustNote>) -> String {
    let mut text = heading("Motion barcodes of two lines", &BARCODE_CONVENTION, trust);
    text.push_str("frame_left,frame_right,left,right\n");
    let [left, right] = &inspected.barcodes;
    for k in 0..left.len() {
        let frame = inspected.first + k;
        let other = frame as i64 + i64::from(offset);
        let bit = |barcode: &Barcode| u8::from(barcode.is_set(k));
        let _ = writeln!(text, "{frame},{other},{},{}", bit(left), bit(right));
    }
    text
}

/// Returns the comment lines: title, meaning of the columns, and verdict on the geometry.
pub(super) fn heading(what: &str, convention: &[&str], trust: Option<&TrustNote>) -> String {
    let mut text = format!("# {what}, written by epiline {}\n", env!("CARGO_PKG_VERSION"));
    for sentence in convention {
        let _ = writeln!(text, "# {sentence}");
    }
    if let Some(trust) = trust {
        let _ = writeln!(text, "# {}", trust.sentence());
        for reason in &trust.reasons {
            let _ = writeln!(text, "#   {reason}");
        }
    }
    text
}

/// Returns comma-separated values, one row per sample of the left line. Comment lines begin with
/// `#`.
pub fn csv(inspection: &Inspection, pictures: &PicturesOf, trust: Option<&TrustNote>) -> String {
    let words = pictures_in_words(pictures, 0.0);
    let convention: Vec<&str> = CONVENTION.into_iter().chain(words.iter().map(String::as_str)).collect();
    let mut text = heading("Intensities along two lines", &convention, trust);
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
