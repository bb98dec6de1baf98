//! Quantities of a geometry file, with their names.

/// Named table of numbers in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
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

impl Quantity {
    const ALL: [Self; 11] = [
        Self::Fundamental,
        Self::Epipole1,
        Self::Epipole2,
        Self::Camera1,
        Self::Camera2,
        Self::Homography1,
        Self::Homography2,
        Self::PlaneHomography,
        Self::Points1,
        Self::Points2,
        Self::Pairs,
    ];

    /// Returns the accepted names: the symbol, the JSON name, then names used by other programs.
    fn names(self) -> &'static [&'static str] {
        match self {
            Self::Fundamental => &[
                "F",
                "fundamental",
                "fundamental_matrix",
                "fundamentalMatrix",
                "FundamentalMatrix",
                "Fundamental_Matrix",
                "fundamental_matrices",
            ],
            Self::Epipole1 => &["e1", "epipole1"],
            Self::Epipole2 => &["e2", "epipole2"],
            Self::Camera1 => &["P1", "camera1"],
            Self::Camera2 => &["P2", "camera2"],
            Self::Homography1 => &["H1", "homography1"],
            Self::Homography2 => &["H2", "homography2"],
            Self::PlaneHomography => &["H21", "homography21"],
            Self::Points1 => &["points1", "pts1", "matchedPoints1"],
            Self::Points2 => &["points2", "pts2", "matchedPoints2"],
            Self::Pairs => &["pairs", "matches"],
        }
    }

    /// Returns the symbol, for example `F`.
    pub(super) fn symbol(self) -> &'static str {
        self.names()[0]
    }

    /// Returns the JSON name, for example `fundamental`.
    pub(super) fn word(self) -> &'static str {
        self.names().get(1).copied().unwrap_or(self.symbol())
    }

    /// Returns the quantity of a name.
    pub(super) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|q| q.names().contains(&name))
    }

    /// Returns the description for a comment in the file.
    pub(super) fn meaning(self) -> &'static str {
        match self {
            Self::Fundamental => "fundamental matrix, x2' F x1 = 0",
            Self::Epipole1 => "epipole in image 1, homogeneous, F e1 = 0",
            Self::Epipole2 => "epipole in image 2, homogeneous, F' e2 = 0",
            Self::Camera1 => "camera of image 1, x1 ~ P1 X",
            Self::Camera2 => "camera of image 2, x2 ~ P2 X",
            Self::Homography1 => "rectifying homography of image 1, rectified ~ H1 x1",
            Self::Homography2 => "rectifying homography of image 2, rectified ~ H2 x2",
            Self::PlaneHomography => "homography of the plane, or of the rotation of the camera, x2 ~ H21 x1",
            Self::Points1 => "points in image 1, one per row: x y",
            Self::Points2 => "points in image 2, one per row: x y, in the order of points1",
            Self::Pairs => "point pairs, one per row: x1 y1 x2 y2",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_means_two_things() {
        for quantity in Quantity::ALL {
            for name in quantity.names() {
                assert_eq!(Quantity::named(name), Some(quantity));
            }
        }
        assert_eq!(Quantity::named("f"), None);
    }
}
