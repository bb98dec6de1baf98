//! Relative poses of the cameras of a result.

use crate::camera::{PoseFit, RelativePose, ViewPair};
use crate::estimate::{Estimate, Reason};
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::study::StudyError;

/// Relative pose of the cameras of a result, or the reason why there is none.
#[derive(Debug, Clone)]
pub enum PoseOutcome {
    /// The matches determine the pose.
    Determined(PoseFit),
    /// Only a plane or a rotation of the camera is certain. The pose belongs to one of many epipoles that fit.
    /// It has no uncertainty: a covariance describes the errors around this epipole alone.
    OpenEpipole(PoseFit),
    /// The cameras are known and only turned. The rotation is determined; the translation is one of many that fit.
    OnlyTurned(PoseFit),
    /// There are too few matches for a pose.
    TooFewMatches,
    /// A focal length is unknown.
    NoFocalLengths,
}

impl PoseOutcome {
    /// Fits the pose to the matches of a result ([`ViewPair::fit_pose`]).
    pub fn new(found: &Estimate, views: &ViewPair) -> Self {
        if !views.has_focal_lengths() {
            return Self::NoFocalLengths;
        }
        match views.fit_pose(found.fundamental(), &found.matched_pairs()) {
            Some(fit) if found.says_one_plane() => {
                let reasons = || found.assessment.trust.iter().flat_map(|trust| &trust.reasons);
                let is_turned = reasons().any(|reason| matches!(reason, Reason::OnlyTurned { .. }));
                let may_be_wrong = reasons().any(|reason| matches!(reason, Reason::BehindCameras { .. }));
                let open = if is_turned && !may_be_wrong { Self::OnlyTurned } else { Self::OpenEpipole };
                open(PoseFit { uncertainty: None, ..fit })
            }
            Some(fit) => Self::Determined(fit),
            None => Self::TooFewMatches,
        }
    }

    /// Returns the fitted pose, even if other epipoles fit as well.
    pub fn fit(&self) -> Option<&PoseFit> {
        match self {
            Self::Determined(fit) | Self::OpenEpipole(fit) | Self::OnlyTurned(fit) => Some(fit),
            Self::TooFewMatches | Self::NoFocalLengths => None,
        }
    }

    /// Returns the pose that the matches determine.
    pub fn determined(&self) -> Option<&PoseFit> {
        match self {
            Self::Determined(fit) => Some(fit),
            _ => None,
        }
    }
}

/// Returns the pose of `F` or, without `F`, the pose of the calibration. `own` is the pose of the calibration with
/// the length of its baseline, which no `F` tells.
///
/// # Errors
/// [`StudyError::NoPose`], [`StudyError::NoFocalLengths`] and [`StudyError::NoMatches`].
pub fn stereo_pose(
    own: Option<(RelativePose, f64)>,
    views: &ViewPair,
    fundamental: Option<&FundamentalMatrix>,
    matches: &[PointPair],
) -> Result<(RelativePose, Option<f64>), StudyError> {
    let Some(fundamental) = fundamental else {
        return own.map(|(pose, baseline)| (pose, Some(baseline))).ok_or(StudyError::NoPose);
    };
    if !views.has_focal_lengths() {
        return Err(StudyError::NoFocalLengths);
    }
    if matches.is_empty() {
        return Err(StudyError::NoMatches);
    }
    let fit = views.fit_pose(fundamental, matches);
    let pose = fit
        .map(|fit| fit.pose)
        .or_else(|| RelativePose::from_fundamental(fundamental, &views.calibrations(), matches));
    Ok((pose.ok_or(StudyError::NoPose)?, own.map(|(_, baseline)| baseline)))
}
