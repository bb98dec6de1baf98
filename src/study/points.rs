//! Matches of another program, without pictures.

use super::StudyError;
use super::cameras::matches_in;
use crate::camera::ViewPair;
use crate::estimate::{Match, PointEstimate, PointsError, check_inside, estimate_points};
use crate::geometry::Frame;

/// Matches without pictures, with everything that is known about the pictures.
#[derive(Debug, Clone)]
pub struct PointStudy {
    /// Places in the views.
    matches: Vec<Match>,
    frames: Option<[Frame; 2]>,
    views: Option<ViewPair>,
    left_out: usize,
}

impl PointStudy {
    /// Studies matches in pictures of these sizes, if the sizes are known.
    ///
    /// # Errors
    /// [`PointsError::Outside`] for a match outside its picture.
    pub fn of_points(matches: Vec<Match>, frames: Option<[Frame; 2]>) -> Result<Self, PointsError> {
        if let Some(frames) = frames {
            check_inside(&matches, frames)?;
        }
        Ok(Self { matches, frames, views: None, left_out: 0 })
    }

    /// Moves the matches to their places in views without distortion, and leaves out those beyond the range of a lens.
    ///
    /// # Errors
    /// [`StudyError::MatchesBeyondLens`] if none is left.
    pub fn with_views(self, views: ViewPair) -> Result<Self, StudyError> {
        let matches = matches_in(&views, &self.matches)?;
        let left_out = self.matches.len() - matches.len();
        Ok(Self { matches, frames: Some(views.frames()), views: Some(views), left_out })
    }

    /// Returns the matches, as places in the views.
    pub fn matches(&self) -> &[Match] {
        &self.matches
    }

    /// Returns the sizes of the pictures in their views, if they are known.
    pub fn frames(&self) -> Option<[Frame; 2]> {
        self.frames
    }

    /// Returns the views, if the cameras are known.
    pub fn views(&self) -> Option<&ViewPair> {
        self.views.as_ref()
    }

    /// Returns the number of matches that were left out, since they lie beyond the range of a lens.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// Fits a geometry of the views ([`estimate_points`]). It is an essential matrix if both focal lengths are known,
    /// not guessed, unless the matches show that the calibration is wrong.
    ///
    /// # Errors
    /// The errors of [`estimate_points`].
    pub fn solve(&self, seed: u64) -> Result<PointEstimate, PointsError> {
        let calibrations = self.views.as_ref().and_then(ViewPair::known_calibrations);
        estimate_points(&self.matches, self.frames, calibrations, seed)
    }
}
