//! The figures of one geometry: what a hypothesis is ranked and shown by, whoever proposed it.

use super::bundle::{Angles, Bundle};
use super::hypotheses::{bisector_kappas, round_trip_area};
use super::level::{Level, resized_pair};
use super::line_refinement::stereo;
use super::prepared::PreparedPair;
use super::search::BAND;
use super::validation::line_score;
use super::{Construction, Hypothesis, Parameters, PatchSupport};
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::similarity::StereoSimilarity;

/// What the figures are computed from.
pub(super) struct Examiner<'a> {
    pub similarity: &'a StereoSimilarity<'a>,
    pub level: &'a Level<'a>,
    pub parameters: &'a Parameters,
    /// Full-size pixels.
    pub clicks: [PointPair; 2],
}

impl Examiner<'_> {
    /// Line score, round trip and both κ of `fundamental` (full size), whose epipolar lines at the clicks are
    /// those of `angles`; `None` where they degenerate.
    pub fn hypothesis(
        &self,
        fundamental: FundamentalMatrix,
        angles: &Angles,
        support: f64,
    ) -> Option<Hypothesis> {
        let clicks = self.clicks.map(|c| self.level.resized(&c));
        let frames = self.level.frames();
        let bundle = Bundle::new(angles, clicks)?;
        let (lines, kind) = (self.parameters.validation_lines, self.parameters.line_score);
        let score = line_score(self.similarity, &bundle, frames, lines, kind);
        let (forward, backward) =
            bisector_kappas(self.similarity, &bundle, &clicks).unwrap_or((angles.kappa, angles.kappa));
        let area = round_trip_area(&bundle, forward / backward, frames[0]);
        let angles = Angles { kappa: forward, ..*angles };
        Some(Hypothesis {
            fundamental,
            score,
            support,
            round_trip_area: area / self.level.scales[0],
            kappa_line2_from_line1: forward,
            kappa_line1_from_line2: backward,
            construction: Construction::new(&angles, self.clicks, Some(backward))?,
        })
    }
}

/// The patches that agree with `f` (full size).
pub(super) fn patch_support(prepared: &PreparedPair, f: &FundamentalMatrix) -> Option<PatchSupport> {
    let fine = prepared.fine_witness();
    let at_fine = f.rescaled(fine.scales[0], fine.scales[1])?;
    let matches = fine.support.matches(&at_fine, BAND).len();
    Some(PatchSupport { matches, score: fine.support.score(&at_fine, BAND) })
}

/// What the estimator would say of `f` (full size), had it been among its hypotheses: to rank a matrix from
/// elsewhere, the true one say, among those of an [`super::Estimate`] with the same clicks and parameters.
///
/// `turn` is about how far image 2 is rotated against image 1, radians, as [`Construction::turn`] of another
/// hypothesis tells. `None` where the epipolar lines of `f` degenerate at the clicks.
pub fn examine(
    prepared: &PreparedPair,
    clicks: [PointPair; 2],
    f: &FundamentalMatrix,
    turn: f64,
    parameters: &Parameters,
) -> Option<Hypothesis> {
    let mut angles = Angles::of(f, &clicks, turn)?;
    let mut support = 0.0;
    if parameters.patch_support {
        let fine = prepared.fine_witness();
        let at_fine = f.rescaled(fine.scales[0], fine.scales[1])?;
        let matches = fine.support.matches(&at_fine, BAND);
        support = fine.support.score(&at_fine, BAND);
        let own = clicks.map(|c| resized_pair(&c, fine.scales));
        // κ where the scene is, as for every other hypothesis.
        angles = Angles::nearest(&at_fine, &own, &angles, matches.iter().map(|m| m.pair)).unwrap_or(angles);
    }
    let level = prepared.level(parameters.coarse_side);
    let similarity = stereo(&level, parameters);
    Examiner { similarity: &similarity, level: &level, parameters, clicks }.hypothesis(*f, &angles, support)
}
