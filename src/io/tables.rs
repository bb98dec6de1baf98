//! Tables for spreadsheets and scripts: comma-separated values below comment lines that begin with `#`. They tell the
//! meaning of the columns, and the verdict on the geometry.

use std::fmt::Write;

use super::geometry_file::{PairLabel, TrustNote};
use crate::camera::PicturesOf;
use crate::geometry::PointPair;
use crate::motion::Barcode;
use crate::presentation::pictures_in_words;
use crate::similarity::MatchedLines;

/// Meaning of the columns of a [`line_table`], one sentence per line.
pub const LINE_COLUMNS: [&str; 3] = [
    "Pixels: x to the right, y down; the centre of the upper left pixel is (0, 0). Intensities go from 0 to 255.",
    "A row is a sample of the left line, in equal steps; distance is along that line from its anchor, px, and so is shift.",
    "x2, y2 and right_matched belong to the matched sample of the right line. They are empty outside the image.",
];
/// Meaning of the columns of a [`barcode_table`], one sentence per line.
const BARCODE_COLUMNS: [&str; 2] = [
    "A row is a frame of the left sequence, counted from 0, and the frame of the right sequence taken at the same time.",
    "left and right are 1 where something moving crosses the line of that image, else 0.",
];
/// Meaning of the columns of a [`pair_table`], one sentence per line.
const PAIR_COLUMNS: [&str; 3] = [
    "Pixels: x to the right, y down; the centre of the upper left pixel is (0, 0).",
    "x1, y1, x2 and y2 belong to the pictures as they are.",
    "distance: symmetric distance from the epipolar lines of the geometry shown, px.",
];

/// Returns the comment lines: title, meaning of the columns, and verdict on the geometry.
fn heading(what: &str, convention: &[&str], trust: Option<&TrustNote>) -> String {
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

/// Returns comma-separated values, one row per sample of the left line.
pub fn line_table(lines: &MatchedLines, pictures: &PicturesOf, trust: Option<&TrustNote>) -> String {
    let words = pictures_in_words(pictures, 0.0);
    let convention: Vec<&str> = LINE_COLUMNS.into_iter().chain(words.iter().map(String::as_str)).collect();
    let mut text = heading("Intensities along two lines", &convention, trust);
    text.push_str("distance,x1,y1,left,right_unmatched,shift,x2,y2,right_matched,cost\n");
    let warped = &lines.warped;
    for (k, sample) in lines.samples().enumerate() {
        let optional = |value: Option<u8>| value.map_or(String::new(), |value| value.to_string());
        let Some(point1) = lines.point1(sample) else { continue };
        let (x2, y2) = lines
            .point2(sample)
            .map_or((String::new(), String::new()), |p| (format!("{:.3}", p.x), format!("{:.3}", p.y)));
        let shift = warped.matching.disparities.get(k).map(|d| f64::from(*d) * lines.step);
        let cost = warped.matching.sample_costs.get(k).map_or(String::new(), ToString::to_string);
        let _ = writeln!(
            text,
            "{:.3},{:.3},{:.3},{},{},{},{x2},{y2},{},{cost}",
            f64::from(sample) * lines.step,
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

/// Returns the motion barcodes of two lines, one row per frame. `first` is the number of the first frame in the left
/// sequence; `offset` leads to the frame of the right one.
pub fn barcode_table(
    barcodes: &[Barcode; 2],
    first: usize,
    offset: i32,
    trust: Option<&TrustNote>,
) -> String {
    let mut text = heading("Motion barcodes of two lines", &BARCODE_COLUMNS, trust);
    text.push_str("frame_left,frame_right,left,right\n");
    let [left, right] = barcodes;
    for k in 0..left.len() {
        let frame = first + k;
        let other = frame as i64 + i64::from(offset);
        let bit = |barcode: &Barcode| u8::from(barcode.is_set(k));
        let _ = writeln!(text, "{frame},{other},{},{}", bit(left), bit(right));
    }
    text
}

/// A row of a [`pair_table`].
pub struct PairRow {
    /// Places in the pictures.
    pub pair: PointPair,
    pub label: PairLabel,
    /// Use of the pair in the estimate.
    pub role: &'static str,
    /// Symmetric distance, px, if there is a geometry.
    pub distance: Option<f64>,
}

/// Returns point pairs, one row per pair. Every reader of point pairs accepts the first four columns. `has_lens` tells
/// that the geometry belongs to views without lens distortion.
pub fn pair_table(rows: &[PairRow], has_lens: bool, trust: Option<&TrustNote>) -> String {
    let mut columns = PAIR_COLUMNS.to_vec();
    columns
        .extend(has_lens.then_some("The lines and distances belong to the views without lens distortion."));
    let mut text = heading("Point pairs of two images", &columns, trust);
    text.push_str("x1,y1,x2,y2,name,origin,role,distance\n");
    for PairRow { pair: PointPair { point1, point2 }, label, role, distance } in rows {
        let distance = distance.map_or(String::new(), |distance| format!("{distance:.3}"));
        let (name, origin) = (label.name.replace('"', "\"\""), label.origin.name());
        let _ = writeln!(
            text,
            "{},{},{},{},\"{name}\",{origin},{role},{distance}",
            point1.x, point1.y, point2.x, point2.y
        );
    }
    text
}
