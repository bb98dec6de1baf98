//! The report of a result in sentences.

use super::geometry_file::{Format, ImageNote, PairLabel, TrustNote};
use super::result_words::judged_in_words;
use crate::camera::PicturesOf;
use crate::estimate::Estimate;
use crate::geometry::{PointPair, symmetric_epipolar_distance};
use crate::presentation::pictures_in_words;

/// Returns the report of a result with its point pairs. `shown` describes another geometry, if the window shows one,
/// and `note` has the verdict in the words of the window.
pub fn report_in_words(
    estimate: &Estimate,
    images: &[ImageNote; 2],
    pairs: &[(PointPair, PairLabel)],
    pictures: &PicturesOf,
    shown: Option<&str>,
    note: Option<&TrustNote>,
) -> String {
    let mut lines =
        vec![format!("Epipolar geometry of two images, written by epiline {}.", env!("CARGO_PKG_VERSION"))];
    lines.extend(Format::Text.convention());
    if *pictures == PicturesOf::Original {
        lines.extend(pictures_in_words(pictures, 0.0));
    }
    lines.extend(shown.map(|shown| {
        format!("This is the report of the result. The window shows another geometry: {shown}.")
    }));
    lines.push(String::new());
    for (image, place) in images.iter().zip(["left", "right"]) {
        let (width, height) = (image.frame.width, image.frame.height);
        lines.push(format!("Image {place}: {}, {width} x {height} px", image.name));
    }
    for (pair @ PointPair { point1, point2 }, PairLabel { name, origin }) in pairs {
        let distance = symmetric_epipolar_distance(estimate.fundamental(), pair);
        lines.push(format!(
            "Point pair {name}, {}: ({}, {}) and ({}, {}), {distance:.3} px from its epipolar lines",
            origin.name(),
            point1.x,
            point1.y,
            point2.x,
            point2.y
        ));
    }
    lines.push(String::new());
    lines.join("\n") + "\n" + &judged_in_words(estimate, images, pictures, note)
}
