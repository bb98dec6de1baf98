//! Content of a geometry file, independent of its format.

use nalgebra::{Matrix3, Matrix6, SMatrix};
use serde::{Deserialize, Serialize};

use super::labels::{PairLabel, TrustNote};
use crate::camera::{PicturesOf, PointCloud, PoseFit, RelativePose, UndistortedView, ViewPair};
use crate::estimate::Match;
use crate::geometry::{Camera, Frame, FundamentalMatrix, PointPair};
use crate::image::{Interpretation, Picture};

/// Name and size of an image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ImageNote {
    /// File name without folders.
    pub name: String,
    /// Width and height, px.
    #[serde(flatten)]
    pub frame: Frame,
    /// Meaning of the numbers of its pixels. Written only.
    #[serde(flatten)]
    pub interpretation: Interpretation,
}

impl ImageNote {
    /// Creates a note of a picture without a statement about its numbers.
    pub fn new(name: String, frame: Frame) -> Self {
        Self { name, frame, interpretation: Interpretation::default() }
    }
}

impl From<&Picture> for ImageNote {
    fn from(picture: &Picture) -> Self {
        Self { interpretation: picture.interpretation, ..Self::new(picture.name.clone(), picture.frame()) }
    }
}

/// Content of a geometry file in the convention of this program: `x2ᵀ F x1 = 0`, the centre of the
/// upper left pixel is (0, 0). Every part is optional; all numbers are finite.
#[derive(Debug, Clone, PartialEq)]
pub struct GeometryFile {
    /// Pictures that the coordinates belong to.
    pub pictures: PicturesOf,
    /// Fundamental matrix `F`.
    pub fundamental: Option<FundamentalMatrix>,
    /// Projection matrices `P1` and `P2`. They imply `F` if the file gives none.
    pub cameras: Option<[Camera; 2]>,
    /// Rectifying homographies, `rectified ∝ H original`, for image 1 and image 2, in pixels.
    pub homographies: Option<[Matrix3<f64>; 2]>,
    /// Homography `x2 ∝ H x1` in pixels, for a plane or a pure rotation of the camera.
    pub homography21: Option<Matrix3<f64>>,
    /// Corresponding points, px.
    pub pairs: Vec<PointPair>,
    /// Notes on both images.
    pub images: Option<[ImageNote; 2]>,
    /// Name and origin of each pair, in the order of `pairs`; may be empty. Written only.
    pub labels: Vec<PairLabel>,
    /// Matches found by the estimate of a result, px. Read only.
    pub found: Vec<PointPair>,
    /// Matrix that was read as F and is probably an essential one. Read only.
    pub essential: Option<Matrix3<f64>>,
    /// Verdict on the geometry. Written only.
    pub trust: Option<TrustNote>,
    /// Covariance of the nine entries of `F` with norm 1, row by row. Read from results only.
    pub covariance: Option<SMatrix<f64, 9, 9>>,
    /// Calibrated part of a result. Read from results only.
    pub calibrated: Option<CalibratedNote>,
    /// Clauses about how the file was read and what was left out. Read only.
    pub remarks: Vec<String>,
    /// Point pairs with their weights, if the file has weights. Read only.
    pub weighted: Vec<Match>,
    /// Reason why no matrix of the file is `F`, if it has others. Read only.
    pub not_fundamental: Option<String>,
    /// Scene points of the matches. Written only, as PLY.
    pub cloud: Option<PointCloud>,
    /// Whether the verdict says that the pictures show different scenes: chance explains the geometry. Read only.
    pub is_of_different_scenes: bool,
}

/// Calibrated part of a result.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CalibratedNote {
    /// Pose of camera 2 in the coordinates of camera 1.
    pub pose: Option<RelativePose>,
    /// Covariance of the pose as for [`PoseFit::covariance`].
    pub pose_covariance: Option<Matrix6<f64>>,
    /// Sizes of the pictures as they are.
    pub frames: Option<[Frame; 2]>,
    /// Clicks, then matches, in the pictures as they are; `None` beyond the range of a lens.
    pub originals: Vec<Option<PointPair>>,
}

impl CalibratedNote {
    /// Creates the note of a pose.
    pub fn new(fit: Option<&PoseFit>) -> Self {
        Self {
            pose: fit.map(|fit| fit.pose),
            pose_covariance: fit.and_then(PoseFit::covariance),
            ..Self::default()
        }
    }

    /// Adds the sizes of the pictures as they are, and these points of the views in them.
    #[must_use]
    pub fn seen_by<'a>(self, views: &ViewPair, pairs: impl Iterator<Item = &'a PointPair>) -> Self {
        let frames = Some(views.views.each_ref().map(UndistortedView::original));
        let originals = pairs.map(|pair| views.original_from_undistorted(pair)).collect();
        Self { frames, originals, ..self }
    }
}

impl GeometryFile {
    /// Creates an empty file for coordinates of these pictures.
    pub fn of(pictures: PicturesOf) -> Self {
        Self {
            pictures,
            fundamental: None,
            cameras: None,
            homographies: None,
            homography21: None,
            pairs: Vec::new(),
            images: None,
            labels: Vec::new(),
            found: Vec::new(),
            trust: None,
            covariance: None,
            calibrated: None,
            remarks: Vec::new(),
            weighted: Vec::new(),
            essential: None,
            not_fundamental: None,
            cloud: None,
            is_of_different_scenes: false,
        }
    }

    /// Adds the cameras of views with a pose. Guessed focal lengths are named beside the verdict.
    pub fn add_cameras(&mut self, views: &ViewPair, fit: &PoseFit) {
        self.cameras = views.posed(&fit.pose);
        self.calibrated = Some(CalibratedNote::new(Some(fit)));
        let percent = 100.0 * views.focal_deviation();
        if percent > 0.0 {
            let trust = self.trust.get_or_insert_with(TrustNote::not_judged);
            trust
                .reasons
                .push(format!("The focal lengths of the cameras are guesses, known to {percent:.0} %."));
        }
    }

    /// Returns `F`, derived from the cameras if the file gives none.
    pub fn geometry(&self) -> Option<FundamentalMatrix> {
        self.fundamental.or_else(|| {
            let [camera1, camera2] = self.cameras.as_ref()?;
            Camera::fundamental(camera1, camera2)
        })
    }

    /// Returns the matches of a result, or the point pairs of any other file.
    pub fn matches(self) -> Vec<PointPair> {
        if self.found.is_empty() { self.pairs } else { self.found }
    }

    /// Returns [`matches`](Self::matches) in the pictures as they are. The matches of a file may
    /// belong to views without distortion. Points beyond the range of a lens are left out.
    ///
    /// # Errors
    /// A clause for the user if the file does not describe its views.
    pub(in crate::io) fn original_matches(self) -> Result<Vec<PointPair>, String> {
        let clicks = if self.found.is_empty() { 0 } else { self.pairs.len() };
        let calibrated = self.calibrated.as_ref().filter(|_| self.pictures.is_undistorted());
        match calibrated.and_then(|calibrated| calibrated.originals.get(clicks..)) {
            Some(originals) if !originals.is_empty() => Ok(originals.iter().flatten().copied().collect()),
            _ => {
                let pictures = self.pictures.clone();
                originals(self.matches(), &pictures)
            }
        }
    }

    /// Returns the point pairs in the pictures as they are, like [`Self::original_matches`].
    pub(in crate::io) fn original_pairs(self) -> Result<Vec<PointPair>, String> {
        originals(self.pairs, &self.pictures)
    }
}

/// Returns point pairs in the pictures as they are.
fn originals(pairs: Vec<PointPair>, pictures: &PicturesOf) -> Result<Vec<PointPair>, String> {
    match pictures {
        PicturesOf::Untold | PicturesOf::Original => Ok(pairs),
        PicturesOf::Undistorted(Some(views)) => {
            Ok(pairs.iter().filter_map(|pair| views.original_from_undistorted(pair)).collect())
        }
        PicturesOf::Undistorted(None) if pairs.is_empty() => Ok(pairs),
        PicturesOf::Undistorted(None) => Err(
            "its points belong to views without lens distortion, which it does not describe. Export them again"
                .to_owned(),
        ),
    }
}

/// Interpretation of numbers without names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BareNumbers {
    Anything,
    Geometry,
}
