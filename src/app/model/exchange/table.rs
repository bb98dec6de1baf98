//! Table of the point pairs for spreadsheets and scripts.

use std::fmt::Write;

use super::profile::heading;
use super::trust::trust_note;
use crate::app::model::Model;
use crate::app::model::document::Role;

/// Meaning of the columns, one sentence per line.
const CONVENTION: [&str; 3] = [
    "Pixels: x to the right, y down; the centre of the upper left pixel is (0, 0).",
    "x1, y1, x2 and y2 belong to the pictures as they are.",
    "distance: symmetric distance from the epipolar lines of the geometry shown, px.",
];

/// Returns comma-separated values, one row per pair that is not excluded, in the order of the list.
/// Every reader of point pairs accepts the first four columns. Comment lines begin with `#`.
pub fn csv(model: &Model) -> String {
    let document = &model.document;
    let mut convention = CONVENTION.to_vec();
    if model.open.undistorted().is_some() {
        convention.push("The lines and distances belong to the views without lens distortion.");
    }
    let mut text = heading("Point pairs of two images", &convention, trust_note(model).as_ref());
    text.push_str("x1,y1,x2,y2,name,origin,role,distance\n");
    for (pair, points) in model.pairs_in_pictures().into_iter().enumerate() {
        let role = match document.role(pair) {
            Role::Used => "used",
            Role::Check => "check only",
            Role::Excluded => continue,
        };
        let distance = model.pair_distance(pair).map_or(String::new(), |distance| format!("{distance:.3}"));
        let name = document.name(pair).replace('"', "\"\"");
        let _ = writeln!(
            text,
            "{},{},{},{},\"{name}\",{},{role},{distance}",
            points.point1.x,
            points.point1.y,
            points.point2.x,
            points.point2.y,
            document.origin(pair).name()
        );
    }
    text
}
