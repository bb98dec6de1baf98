//! The epipolar geometry of two images: `F` with its epipoles.

use super::{Frame, FundamentalMatrix, HomogeneousPoint, finite_point};

/// A fundamental matrix and its epipoles, computed once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpipolarGeometry {
    fundamental: FundamentalMatrix,
    epipole1: HomogeneousPoint,
    epipole2: HomogeneousPoint,
}

impl EpipolarGeometry {
    /// Returns the fundamental matrix, `x2ᵀ F x1 = 0`.
    pub fn fundamental(&self) -> &FundamentalMatrix {
        &self.fundamental
    }

    /// Returns the epipole in image 1, homogeneous, unit norm.
    pub fn epipole1(&self) -> HomogeneousPoint {
        self.epipole1
    }

    /// Returns the epipole in image 2, homogeneous, unit norm.
    pub fn epipole2(&self) -> HomogeneousPoint {
        self.epipole2
    }
}

impl From<FundamentalMatrix> for EpipolarGeometry {
    fn from(fundamental: FundamentalMatrix) -> Self {
        Self { fundamental, epipole1: fundamental.epipole1(), epipole2: fundamental.epipole2() }
    }
}

/// Describes an epipole in words: its position, or its direction when it is at infinity.
pub fn place_in_words(epipole: &HomogeneousPoint, frame: Frame) -> String {
    if let Some(p) = finite_point(epipole) {
        let side = if frame.contains(p) { "inside" } else { "outside" };
        format!("({:.2}, {:.2}) px, {side} the image", p.x, p.y)
    } else {
        let angle = epipole.y.atan2(epipole.x).to_degrees().rem_euclid(180.0);
        format!("infinitely far, lines run at {angle:.2}° to the x axis (y is down)")
    }
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
