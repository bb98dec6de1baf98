//! Verdict on a geometry of given matches, without pictures.
//!
//! The tests of the matches are those of any result. Nothing tests whether the matches are scene points, so
//! the verdict is never reliable.

use nalgebra::Matrix3;

use super::baseline::Posed;
use super::gathering::{leaves_in_place, plane_homography};
use super::relief::WarpTest;
use crate::estimate::evidence::patches::UnguidedMatch;
use crate::estimate::fit::false_alarms::{Agreement, OF_A_PLANE};
use crate::estimate::fit::{Warp, largest_plane, residual_pattern};
use crate::estimate::verdict::constants::{DEVIATIONS, largest_error};
use crate::estimate::verdict::trust::{Case, GivenPoints, OffPlane, PlaneEvidence, RefinedOn};
use crate::estimate::{Match, PlaneHomography, Trust, Uncertainty};
use crate::geometry::{Frame, FundamentalMatrix, PointPair};

/// Returns the ratio of the noise to its estimate that is exceeded once in 700 times, for so many degrees of
/// freedom: the quantile of χ² after Wilson & Hilferty (1931). Infinite for so few that they do not tell.
fn largest_underestimate(freedom: f64) -> f64 {
    let part = 2.0 / (9.0 * freedom.max(1.0));
    (1.0 - part - DEVIATIONS * part.sqrt()).max(0.0).powf(-1.5)
}

/// A geometry of given matches, and what agrees with it.
pub(in crate::estimate) struct PointEvidence<'a> {
    /// All matches. They were found without the geometry.
    pub matches: &'a [Match],
    /// Matches that are likelier right than wrong.
    pub agreeing: &'a [PointPair],
    pub agreement: Agreement,
    /// Number of matches that agree on another geometry, if the matches that do not agree on this one do so
    /// beyond chance.
    pub rival: Option<usize>,
    pub fundamental: &'a FundamentalMatrix,
    pub uncertainty: Option<&'a Uncertainty>,
    /// Calibration matrices, if the geometry is an essential matrix.
    pub calibrations: Option<[Matrix3<f64>; 2]>,
    /// Standard deviation of the distance of a right match from its line in image 2, px.
    pub sigma: f64,
    pub frames: [Frame; 2],
    pub seed: u64,
}

impl PointEvidence<'_> {
    /// Returns the verdict, the margin over the rival, and the homography if only a plane is certain.
    pub fn judge(&self) -> (Trust, Option<f64>, Option<PlaneHomography>) {
        let Self { matches, agreeing, fundamental: f, frames, .. } = *self;
        let side = frames[0].longer_side();
        let deviation = self.uncertainty.and_then(|uncertainty| uncertainty.median_line2_deviation(agreeing));
        let tolerance = self.tolerance();
        let plane = largest_plane(agreeing, tolerance, self.seed);
        let margin = self.rival.map(|rival| super::margin::relative(agreeing.len() as f64, rival as f64));
        let points = GivenPoints {
            agreeing: agreeing.len(),
            matches: matches.len(),
            is_chance: !self.agreement.is_no_chance(),
        };
        let found: Vec<UnguidedMatch> =
            matches.iter().map(|m| UnguidedMatch { pair: m.pair, prior: m.prior as f32 }).collect();
        let posed = |calibrations| Posed {
            f,
            calibrations,
            matches: agreeing,
            unguided: &found,
            lead_over: &|_, _| None,
            side,
            tolerance,
            seed: self.seed,
        };
        let trust = Trust::judge(&Case {
            refined_on: RefinedOn::Points(points),
            margin,
            deviation,
            plane: plane.map(|(h, most)| self.plane_evidence(&h, most, tolerance)),
            // A warp of more coefficients would follow all of the matches.
            relief: plane.and_then(|(h, _)| {
                let (frame, seed) = (frames[0], self.seed);
                let test = WarpTest {
                    f,
                    matches: agreeing,
                    h: &h,
                    unguided: &found,
                    lead_over: &|_, _| None,
                    frame,
                    tolerance,
                    seed,
                };
                let relief = || test.relief();
                (agreeing.len() >= 2 * Warp::COEFFICIENTS).then(relief).flatten()
            }),
            baseline: self.calibrations.as_ref().and_then(|calibrations| posed(calibrations).baseline()),
            pattern: residual_pattern(agreeing, f, side),
            side,
            ..Case::default()
        });
        let plane = plane.filter(|_| trust.says_one_plane());
        (trust, margin, plane.and_then(|(h, _)| plane_homography(&h, agreeing, frames[1], tolerance)))
    }

    /// Returns the largest distance of a match from a homography that explains it, px: the usual one, or a smaller
    /// one if the matches show that they are more precise.
    fn tolerance(&self) -> f64 {
        let usual = largest_error(self.frames[0].longer_side());
        // On a plane, F absorbs as much noise as nine numbers do.
        let freedom = self.agreeing.len().saturating_sub(9);
        let estimated = DEVIATIONS * self.sigma;
        (estimated * largest_underestimate(freedom as f64)).min(usual).max(estimated)
    }

    /// Returns the evidence beside a homography that `most` of the agreeing matches follow.
    fn plane_evidence(&self, h: &Matrix3<f64>, most: usize, tolerance: f64) -> PlaneEvidence {
        let side = self.frames[0].longer_side();
        let share = |most: f64| {
            let free = self.agreeing.len().saturating_sub(OF_A_PLANE.matches).max(1) as f64;
            ((most - OF_A_PLANE.matches as f64) / free).max(0.0)
        };
        let all: Vec<PointPair> = self.matches.iter().map(|m| m.pair).collect();
        PlaneEvidence {
            share: share(most as f64),
            off: OffPlane::new(&all, self.fundamental, h, side, self.sigma),
            is_still: leaves_in_place(h, self.agreeing, tolerance),
        }
    }
}
