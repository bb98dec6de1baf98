//! What is in a geometry file, whatever its format.

use std::path::Path;

use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

use super::super::read::ReadError;
use super::labels::{PairLabel, TrustNote};
use crate::geometry::{Camera, Frame, FundamentalMatrix, PointPair};

/// The name and the size of an image.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageNote {
    /// File name, without folders.
    pub name: String,
    /// Width and height, px.
    #[serde(flatten)]
    pub frame: Frame,
}

/// What such a file holds, in the convention of this program: `x2ᵀ F x1 = 0`, the centre of the upper left pixel
/// is (0, 0). Every part may be missing; all numbers are finite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GeometryFile {
    /// `F`.
    pub fundamental: Option<FundamentalMatrix>,
    /// The projection matrices `P1` and `P2`; they imply an `F` where none is given.
    pub cameras: Option<[Camera; 2]>,
    /// `rectified ∝ H original`, for image 1 and image 2, both in pixels.
    pub homographies: Option<[Matrix3<f64>; 2]>,
    /// `x2 ∝ H x1` in pixels, where one plane or a turn of the camera is all that is known for certain.
    pub homography21: Option<Matrix3<f64>>,
    /// Points of the same scene point, px.
    pub pairs: Vec<PointPair>,
    /// The two images.
    pub images: Option<[ImageNote; 2]>,
    /// What is known of each pair, in their order; empty where nothing is. Written only.
    pub labels: Vec<PairLabel>,
    /// How far the geometry is to be trusted, where somebody has judged it. Written only.
    pub trust: Option<TrustNote>,
}

impl GeometryFile {
    /// `F`, of the cameras where there is no other.
    pub fn geometry(&self) -> Option<FundamentalMatrix> {
        self.fundamental.or_else(|| {
            let [camera1, camera2] = self.cameras.as_ref()?;
            Camera::fundamental(camera1, camera2)
        })
    }
}

/// What somebody expects of bare numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BareNumbers {
    Anything,
    Geometry,
}

/// What is wrong with the content of a file, one clause.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{problem}")]
pub struct Problem {
    /// Number of the line, from 1, where there is one to name.
    pub line: Option<usize>,
    /// What was expected and what was found.
    pub problem: String,
}

impl Problem {
    pub(super) fn whole(problem: impl Into<String>) -> Self {
        Self { line: None, problem: problem.into() }
    }

    /// The same with the name of the file.
    pub(super) fn of_file(self, path: &Path) -> ReadError {
        match self.line {
            Some(line) => ReadError::line(path, line, self.problem),
            None => ReadError::content(path, self.problem),
        }
    }

    pub(super) fn at(line: usize, problem: impl Into<String>) -> Self {
        Self { line: Some(line), problem: problem.into() }
    }
}
