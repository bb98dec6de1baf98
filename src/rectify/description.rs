//! The description of a rectification that is written beside its pictures.

use serde::Serialize;

use super::{Measures, PolarTable, Rectification, RectifyMethod, RectifyWarning};
use crate::geometry::{Frame, FundamentalMatrix};

const PLANAR: &str = "Pixels are (x, y), x right, y down, the centre of the top-left pixel is (0, 0). homography1 and \
    homography2 are nested rows: rectified ~ H original, homogeneous. Where pictures is undistorted, original is a place in the view without \
    distortion. Corresponding points have the same rectified y.";
const POLAR: &str = "Pixels are (x, y), x right, y down, the centre of the top-left pixel is (0, 0). Rectified pixel \
    (column, row) of an image is at epipole + (radius + column * radius_step) * (cos a, sin a) of the original, a = \
    angles[row] in radians. Where pictures is undistorted, original is a place in the view without distortion. \
    Corresponding points are in the same row.";

/// Content of a description file. Lengths in px.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Description<'a> {
    method: RectifyMethod,
    reason: &'a str,
    convention: &'static str,
    /// Width and height of both rectified pictures.
    size: Frame,
    /// Factor by which the pixel limit reduced the pictures.
    scale: f64,
    original_sizes: [Frame; 2],
    fundamental: FundamentalMatrix,
    #[serde(skip_serializing_if = "Option::is_none")]
    homography1: Option<[[f64; 3]; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    homography2: Option<[[f64; 3]; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    polar1: Option<PolarTable<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    polar2: Option<PolarTable<'a>>,
    measures: &'a Measures,
    warnings: &'a [RectifyWarning],
    version: &'static str,
}

impl Rectification {
    /// Returns the description of this rectification. `originals` are the sizes of both images.
    pub fn description(&self, fundamental: &FundamentalMatrix, originals: [Frame; 2]) -> Description<'_> {
        let homography = |k: usize| {
            let h = self.maps[k].homography()?;
            Some(h.transpose().data.0)
        };
        Description {
            method: self.method,
            reason: &self.reason,
            convention: if self.method == RectifyMethod::Polar { POLAR } else { PLANAR },
            size: self.size,
            scale: self.scale,
            original_sizes: originals,
            fundamental: *fundamental,
            homography1: homography(0),
            homography2: homography(1),
            polar1: self.maps[0].polar_table(),
            polar2: self.maps[1].polar_table(),
            measures: &self.measures,
            warnings: &self.warnings,
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}
