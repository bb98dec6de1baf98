//! The epipolar geometry of two images: F with its epipoles.

use super::{FundamentalMatrix, HomogeneousPoint};

/// A fundamental matrix and its epipoles, computed once. It says nothing of how it came about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EpipolarGeometry {
    fundamental: FundamentalMatrix,
    epipole1: HomogeneousPoint,
    epipole2: HomogeneousPoint,
}

impl EpipolarGeometry {
    /// `x2ᵀ F x1 = 0`.
    pub fn fundamental(&self) -> &FundamentalMatrix {
        &self.fundamental
    }

    /// The epipole in image 1, homogeneous, unit norm.
    pub fn epipole1(&self) -> HomogeneousPoint {
        self.epipole1
    }

    /// The epipole in image 2, homogeneous, unit norm.
    pub fn epipole2(&self) -> HomogeneousPoint {
        self.epipole2
    }
}

impl From<FundamentalMatrix> for EpipolarGeometry {
    fn from(fundamental: FundamentalMatrix) -> Self {
        Self { fundamental, epipole1: fundamental.epipole1(), epipole2: fundamental.epipole2() }
    }
}
