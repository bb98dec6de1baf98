//! Judgements of a geometry from elsewhere by the geometry that two images or given matches show.

use crate::camera::PoseDifference;
use crate::estimate::{Estimate, Match, MatchFitError, Uncertainty, Verdict, estimate_fundamental};
use crate::geometry::{Frame, FundamentalMatrix, Matrix9, PointPair};
use crate::judge::{Finding, GivenCalibration, GivenGeometry, Judgement, Reference, RowMatches, judge};

/// Geometry that two images or given matches show, and the evidence that it rests on.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownGeometry {
    /// Fundamental matrix.
    pub fundamental: FundamentalMatrix,
    /// Matches that agree with the matrix.
    pub matches: Vec<PointPair>,
    /// Matches that no search and no line has selected. They alone refute another geometry.
    pub witnesses: Vec<PointPair>,
    /// Whether the matches can refute a geometry. True for matches that a person gives.
    pub is_trusted: bool,
    /// Whether the matches determine the epipoles, and with them the pose.
    pub has_epipoles: bool,
    /// Verdict on the geometry; `None` for given matches.
    pub verdict: Option<Verdict>,
    /// Covariance of the nine entries of the matrix.
    pub covariance: Option<Matrix9>,
}

impl From<&Estimate> for ShownGeometry {
    fn from(found: &Estimate) -> Self {
        Self {
            fundamental: *found.fundamental(),
            matches: found.matched_pairs(),
            witnesses: found.assessment.distinctive.to_vec(),
            is_trusted: found.may_contradict(),
            has_epipoles: !found.says_one_plane(),
            verdict: found.assessment.trust.as_ref().map(|trust| trust.verdict),
            covariance: found.uncertainty().map(Uncertainty::covariance),
        }
    }
}

impl ShownGeometry {
    /// Fits a geometry to given matches. All of them are witnesses.
    ///
    /// # Errors
    /// The errors of [`estimate_fundamental`].
    pub fn of_matches(matches: &[Match], frames: [Frame; 2], seed: u64) -> Result<Self, MatchFitError> {
        let fit = estimate_fundamental(matches, frames, seed)?;
        let right = matches.iter().zip(&fit.inlier_probabilities).filter(|(_, right)| **right > 0.5);
        Ok(Self {
            fundamental: fit.fundamental,
            matches: right.map(|(found, _)| found.pair).collect(),
            witnesses: matches.iter().map(|found| found.pair).collect(),
            is_trusted: true,
            has_epipoles: true,
            verdict: None,
            covariance: fit.uncertainty.as_ref().map(Uncertainty::covariance),
        })
    }

    /// Returns the matches that tell whether the images are rectified.
    pub fn rows(&self) -> RowMatches<'_> {
        let Self { matches, witnesses, is_trusted, .. } = self;
        RowMatches { matches, witnesses, is_trusted: *is_trusted }
    }

    /// Returns the reference of a judgement. Both geometries may be uncertain; without a covariance, the
    /// judged one counts as exact.
    pub fn reference(&self, frames: [Frame; 2], own_covariance: Option<&Matrix9>) -> Reference<'_> {
        let Self { fundamental, matches, witnesses, is_trusted, has_epipoles, covariance, .. } = self;
        Reference {
            fundamental: *fundamental,
            matches,
            witnesses,
            frames,
            is_trusted: *is_trusted,
            has_epipoles: *has_epipoles,
            covariance: covariance.map(|own| own + own_covariance.copied().unwrap_or_else(Matrix9::zeros)),
        }
    }

    /// Judges a geometry with its covariance. If it does not fit, `again` searches with other random numbers, since
    /// a finding that depends on them accuses nobody. `None` for too few matches ([`judge`]).
    ///
    /// # Errors
    /// The errors of `again`.
    pub fn judged<E>(
        &self,
        given: (&GivenGeometry, Option<&Matrix9>),
        frames: [Frame; 2],
        limit: f64,
        again: impl FnOnce() -> Result<Self, E>,
    ) -> Result<Option<Judgement>, E> {
        let (given, own_covariance) = given;
        let reference = self.reference(frames, own_covariance);
        let found = judge(given, &reference, limit);
        let Some(refuted) = found.as_ref().filter(|found| found.finding == Finding::DoesNotFit) else {
            return Ok(found);
        };
        let other = again()?;
        let other = judge(given, &other.reference(frames, own_covariance), limit);
        Ok(other.map(|other| refuted.clone().confirmed_by(&other, &reference)).or(found))
    }

    /// Compares a judged calibration with the pose that fits the matches. `None` while the geometry is in doubt, or if
    /// another mistake is named.
    pub fn compared_pose(&self, found: &Judgement, calibration: &GivenCalibration) -> Option<ComparedPose> {
        let is_clear = found.finding != Finding::Undecided && found.change.is_none() && self.is_trusted;
        if !is_clear || !self.has_epipoles {
            return is_clear.then_some(ComparedPose { difference: None });
        }
        let fit = calibration.views.fit_pose(&self.fundamental, &self.matches)?;
        Some(ComparedPose { difference: Some(fit.difference(&calibration.pose)?) })
    }
}

/// Pose of a judged calibration, compared with the pose that fits the matches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparedPose {
    /// How far the two are apart. `None` if the matches do not determine the epipoles, and so no pose.
    pub difference: Option<PoseDifference>,
}
