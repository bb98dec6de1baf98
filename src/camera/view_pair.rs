//! Two views without distortion, and epipolar curves in the pictures with distortion.

use nalgebra::{Matrix3, Vector3};

use super::model::CameraModel;
use super::pose::{PoseFit, RelativePose, fit_pose};
use super::undistorted_view::UndistortedView;
use crate::geometry::{Camera, Frame, FundamentalMatrix, Line, Point, PointPair};

/// Two views without distortion. A fundamental matrix of calibrated cameras belongs to them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewPair {
    /// Views of image 1 and image 2.
    pub views: [UndistortedView; 2],
}

/// Offset along a line for the direction of its curve, px.
const STEP: f64 = 0.5;

impl ViewPair {
    /// Plans the views of two cameras with pictures of these sizes. `None` as for
    /// [`UndistortedView::new`].
    pub fn new(cameras: [&CameraModel; 2], originals: [Frame; 2]) -> Option<Self> {
        let view = |k: usize| UndistortedView::new(cameras[k], originals[k]);
        Some(Self { views: [view(0)?, view(1)?] })
    }

    /// Returns whether a view differs from its picture.
    pub fn is_undistorted(&self) -> bool {
        self.views.iter().any(|view| !view.is_original())
    }

    /// Returns whether the focal lengths of both cameras are known or guessed.
    pub fn has_focal_lengths(&self) -> bool {
        self.views.iter().all(|view| view.camera().focal_deviation().is_some())
    }

    /// Returns the largest relative standard deviation of a guessed focal length, 0 for calibrations.
    pub fn focal_deviation(&self) -> f64 {
        self.views.iter().filter_map(|view| view.camera().focal_deviation()).fold(0.0, f64::max)
    }

    /// Returns whether these are the pictures themselves with guessed focal lengths: nothing is known of the lenses.
    pub fn is_guessed(&self) -> bool {
        !self.is_undistorted() && self.known_calibrations().is_none()
    }

    /// Returns the calibration matrices of the views if both focal lengths are known, not guessed.
    pub fn known_calibrations(&self) -> Option<[Matrix3<f64>; 2]> {
        let is_known = |view: &UndistortedView| view.camera().focal_deviation() == Some(0.0);
        self.views.iter().all(is_known).then(|| self.calibrations())
    }

    /// Returns the calibration matrices of the views.
    pub fn calibrations(&self) -> [Matrix3<f64>; 2] {
        self.views.each_ref().map(|view| *view.calibration())
    }

    /// Returns the cameras of the views, the first at the origin. `None` for a pose that is not finite.
    pub fn posed(&self, pose: &RelativePose) -> Option<[Camera; 2]> {
        let [k1, k2] = self.calibrations();
        Some([
            Camera::posed(&k1, &Matrix3::identity(), &Vector3::zeros())?,
            Camera::posed(&k2, pose.rotation.matrix(), &pose.translation)?,
        ])
    }

    /// Returns the views that a file describes, with these cameras. `None` if the file belongs to other lenses:
    /// a place in the pictures differs by more than 0.5 px.
    pub fn adopting(&self, described: &Self) -> Option<Self> {
        let view = |k: usize| self.views[k].adopting(&described.views[k]);
        Some(Self { views: [view(0)?, view(1)?] })
    }

    /// Returns the sizes of the views.
    pub fn frames(&self) -> [Frame; 2] {
        self.views.each_ref().map(UndistortedView::frame)
    }

    /// Refines the pose of a fundamental matrix of the views on matches: five numbers, Sampson
    /// distances in pixels with a Cauchy loss whose scale is the median distance. The uncertainty
    /// covers the noise of the matches and guessed focal lengths; equal guesses share their error.
    ///
    /// `None` for fewer than 10 matches, without a pose, and if a focal length is unknown.
    pub fn fit_pose(&self, fundamental: &FundamentalMatrix, matches: &[PointPair]) -> Option<PoseFit> {
        let calibrations = self.calibrations();
        let [first, second] = self.views.each_ref().map(|view| view.camera().focal_deviation());
        let (first, second) = (first?, second?);
        let fit =
            |calibrations: &[Matrix3<f64>; 2]| fit_pose(fundamental, calibrations, matches, self.frames()[0]);
        let mut found = fit(&calibrations)?;
        let is_same = self.views[0].camera() == self.views[1].camera();
        let changes = if is_same { [[first, first], [0.0; 2]] } else { [[first, 0.0], [0.0, second]] };
        for change in changes.iter().filter(|change| change.iter().any(|by| *by > 0.0)) {
            let longer = [0, 1].map(|k| {
                let mut calibration = calibrations[k];
                calibration[(0, 0)] *= 1.0 + change[k];
                calibration[(1, 1)] *= 1.0 + change[k];
                calibration
            });
            found.widened(&fit(&longer)?.pose);
        }
        Some(found)
    }

    /// Returns a point pair of the pictures in the views.
    pub fn undistorted_from_original(&self, pair: &PointPair) -> Option<PointPair> {
        pair.mapped(|k, point| self.views[k].undistorted_from_original(point))
    }

    /// Returns a point pair of the views in the pictures.
    pub fn original_from_undistorted(&self, pair: &PointPair) -> Option<PointPair> {
        pair.mapped(|k, point| self.views[k].original_from_undistorted(point))
    }

    /// Returns the mean distance in the pictures of both points of a pair of the views from their
    /// epipolar curves, px. `None` where a curve leaves the range of the lens.
    pub fn distance_from_curves(&self, f: &FundamentalMatrix, pair: &PointPair) -> Option<f64> {
        let (line2, line1) = (f.line2_from_point1(pair.point1)?, f.line1_from_point2(pair.point2)?);
        let [view1, view2] = &self.views;
        Some(0.5 * (distance(view1, &line1, pair.point1)? + distance(view2, &line2, pair.point2)?))
    }
}

/// Returns the distance in the picture of a point from the curve of a line: from the tangent at the
/// foot of the point.
fn distance(view: &UndistortedView, line: &Line, point: Point) -> Option<f64> {
    let foot = line.foot(point);
    let along = line.direction() * STEP;
    let place = |point: Point| view.original_from_undistorted(point);
    let tangent = (place(foot + along)? - place(foot - along)?).normalize();
    let off = place(point)? - place(foot)?;
    Some((off.x * tangent.y - off.y * tangent.x).abs())
}
