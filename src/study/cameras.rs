//! Pictures and points in the views without distortion.

use std::sync::Arc;

use super::StudyError;
use crate::camera::{CameraModel, FocalLength, UndistortedView, ViewPair};
use crate::estimate::Match;
use crate::geometry::{Frame, PointPair};
use crate::image::Picture;

/// Returns a camera without a calibration, of distortion λ of the division model, of a focal length, or of both. The
/// principal point is in the middle of a picture of this size. `None` without either, and for impossible numbers.
pub fn assumed_camera(
    lambda: Option<f64>,
    focal: Option<FocalLength>,
    picture: Frame,
) -> Option<CameraModel> {
    let lens = lambda.and_then(|lambda| CameraModel::of_division(lambda, picture));
    match (lens, focal) {
        (Some(lens), Some(focal)) => lens.with_focal_length(focal),
        (None, Some(focal)) => CameraModel::of_focal_length(focal, picture),
        (lens, None) => lens,
    }
}

/// Plans the views without distortion of two cameras with pictures of these sizes.
///
/// # Errors
/// [`StudyError::FoldsBack`] if the distortion of a lens cannot be undone.
pub fn plan_views(cameras: [&CameraModel; 2], pictures: [Frame; 2]) -> Result<ViewPair, StudyError> {
    ViewPair::new(cameras, pictures).ok_or(StudyError::FoldsBack)
}

/// Draws a picture without the distortion of its lens. A picture without distortion is returned as it is.
pub fn undistorted(view: &UndistortedView, picture: &Arc<Picture>) -> Arc<Picture> {
    if view.is_original() {
        return Arc::clone(picture);
    }
    Arc::new(picture.redrawn(view.frame(), |place| view.source_of(place)))
}

/// Returns the places of clicked pairs of the pictures in their views.
///
/// # Errors
/// [`StudyError::ClickBeyondLens`] with the first pair beyond the range of a lens.
pub fn clicks_in(views: &ViewPair, clicks: &[PointPair]) -> Result<Vec<PointPair>, StudyError> {
    let place = |(k, pair)| views.undistorted_from_original(pair).ok_or(StudyError::ClickBeyondLens(k + 1));
    clicks.iter().enumerate().map(place).collect()
}

/// Returns the places of matches of the pictures in their views, without those beyond the range of a lens.
///
/// # Errors
/// [`StudyError::MatchesBeyondLens`] if none is left.
pub fn matches_in(views: &ViewPair, matches: &[Match]) -> Result<Vec<Match>, StudyError> {
    let moved = |found: &Match| Some(Match { pair: views.undistorted_from_original(&found.pair)?, ..*found });
    let inside: Vec<Match> = matches.iter().filter_map(moved).collect();
    if inside.is_empty() { Err(StudyError::MatchesBeyondLens) } else { Ok(inside) }
}
