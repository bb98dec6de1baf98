//! Quantities of a geometry file, with their names.

use serde_json::{Map, Value};

/// Named table of numbers in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) enum Quantity {
    Fundamental,
    Epipole1,
    Epipole2,
    Camera1,
    Camera2,
    Homography1,
    Homography2,
    PlaneHomography,
    Points1,
    Points2,
    Pairs,
}

/// Each quantity with its accepted names and its description for a comment in the file, in the
/// order of the variants. The names are the symbol, the JSON name, and names used by other
/// programs.
const QUANTITIES: [(Quantity, &[&str], &str); 11] = [
    (
        Quantity::Fundamental,
        &[
            "F",
            "fundamental",
            "fundamental_matrix",
            "fundamentalMatrix",
            "FundamentalMatrix",
            "Fundamental_Matrix",
            "fundamental_matrices",
        ],
        "fundamental matrix, x2' F x1 = 0",
    ),
    (Quantity::Epipole1, &["e1", "epipole1"], "epipole in image 1, homogeneous, F e1 = 0"),
    (Quantity::Epipole2, &["e2", "epipole2"], "epipole in image 2, homogeneous, F' e2 = 0"),
    (Quantity::Camera1, &["P1", "camera1"], "camera of image 1, x1 ~ P1 X"),
    (Quantity::Camera2, &["P2", "camera2"], "camera of image 2, x2 ~ P2 X"),
    (Quantity::Homography1, &["H1", "homography1"], "rectifying homography of image 1, rectified ~ H1 x1"),
    (Quantity::Homography2, &["H2", "homography2"], "rectifying homography of image 2, rectified ~ H2 x2"),
    (
        Quantity::PlaneHomography,
        &["H21", "homography21"],
        "homography of the plane, or of the rotation of the camera, x2 ~ H21 x1",
    ),
    (Quantity::Points1, &["points1", "pts1", "matchedPoints1"], "points in image 1, one per row: x y"),
    (
        Quantity::Points2,
        &["points2", "pts2", "matchedPoints2"],
        "points in image 2, one per row: x y, in the order of points1",
    ),
    (Quantity::Pairs, &["pairs", "matches"], "point pairs, one per row: x1 y1 x2 y2"),
];

impl Quantity {
    /// Returns the symbol, for example `F`.
    pub(in crate::io) fn symbol(self) -> &'static str {
        QUANTITIES[self as usize].1[0]
    }

    /// Returns the JSON name, for example `fundamental`.
    pub(in crate::io) fn word(self) -> &'static str {
        let names = QUANTITIES[self as usize].1;
        names.get(1).unwrap_or(&names[0])
    }

    /// Returns whether it is points or point pairs.
    pub(in crate::io) fn is_points(self) -> bool {
        matches!(self, Self::Points1 | Self::Points2 | Self::Pairs)
    }

    pub(in crate::io) fn named(name: &str) -> Option<Self> {
        QUANTITIES.iter().find(|(_, names, _)| names.contains(&name)).map(|(quantity, ..)| *quantity)
    }

    /// Returns the description for a comment in the file.
    pub(in crate::io) fn meaning(self) -> &'static str {
        QUANTITIES[self as usize].2
    }
}

/// Adds a field to an object. A known name must not occur twice with different values.
pub(in crate::io) fn insert(
    object: &mut Map<String, Value>,
    name: String,
    value: Value,
) -> Result<(), String> {
    match object.get(&name) {
        Some(known) if Quantity::named(&name).is_some() && *known != value => return Err(there_twice(&name)),
        _ => object.insert(name, value),
    };
    Ok(())
}

pub(in crate::io) fn there_twice(name: &str) -> String {
    format!("{name} occurs twice with different values. Remove one of them")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_means_two_things() {
        for (k, (quantity, names, _)) in QUANTITIES.iter().enumerate() {
            assert_eq!(*quantity as usize, k);
            assert!(names.iter().all(|name| Quantity::named(name) == Some(*quantity)));
        }
        assert_eq!(Quantity::named("f"), None);
    }
}
