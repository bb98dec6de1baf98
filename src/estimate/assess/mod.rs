//! How far a geometry is to be trusted: what its lines, patches, matches and rivals say, and a verdict in words.

mod degeneracy;
mod examination;
mod margin;
mod plane;
mod trust;
mod uncertainty;

pub use degeneracy::SMALLEST_SIDE;
pub use examination::examine;
pub use trust::{Reason, Trust, Verdict};
pub use uncertainty::{EpipoleEllipse, Uncertainty};

pub(super) use degeneracy::{check_images, check_points};
pub(super) use plane::largest_plane;

use super::{
    Assessment, Clicks, Estimate, Parameters, PatchSupport, PreparedPair, Refinement, Search, Warning,
};
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance};
use margin::margin;
use plane::share_on_one_plane;
use trust::Evidence;

/// How near a match must be to a homography to be explained by it, px in an image of up to [`PLANE_SIDE`] px, more in
/// proportion in larger ones, where corners are found less precisely: three deviations of a refined match.
const PLANE_TOLERANCE: f64 = 1.0;
const PLANE_SIDE: f64 = 800.0;

/// What a geometry is judged by, besides itself.
pub(super) struct Judge<'a> {
    pub prepared: &'a PreparedPair,
    pub clicks: &'a Clicks,
    pub parameters: &'a Parameters,
    /// The geometries that were found, best first.
    pub hypotheses: &'a [Estimate],
    /// What the user should know, whatever the result.
    pub warnings: &'a [Warning],
}

impl Judge<'_> {
    /// What is known about a geometry before everything has been looked at.
    pub fn preliminary(&self, f: &FundamentalMatrix, support: Option<PatchSupport>) -> Assessment {
        Assessment {
            lines: self.hypotheses.first().and_then(|best| best.assessment.lines.clone()),
            support,
            margin: self.margin(f, &[]),
            refinement: None,
            warnings: self.warnings(f),
            trust: None,
        }
    }

    /// Everything about a final geometry, with the verdict. `supporting` are the matches on which rivals are compared
    /// with it.
    pub fn result(
        &self,
        f: &FundamentalMatrix,
        supporting: &[PointPair],
        refinement: Option<Refinement>,
    ) -> Assessment {
        let Self { prepared, parameters, .. } = *self;
        // The figures of the result itself, not of the hypothesis it was refined from.
        let turn = self.hypotheses.first().map_or(0.0, Estimate::turn);
        let anchors = self.clicks.anchors();
        let lines = anchors
            .first_chunk::<2>()
            .and_then(|anchors| examination::line_figures(prepared, *anchors, f, turn, parameters));
        let support = match parameters.search {
            Search::Patches => examination::patch_support(prepared, f),
            Search::Lines => None,
        };
        let margin = self.margin(f, supporting);
        let trust = Some(self.trust(f, margin, refinement.as_ref()));
        Assessment { lines, support, margin, refinement, warnings: self.warnings(f), trust }
    }

    fn margin(&self, f: &FundamentalMatrix, supporting: &[PointPair]) -> Option<f64> {
        margin(f, self.hypotheses, supporting, self.prepared.frames(), self.parameters.search)
    }

    fn warnings(&self, f: &FundamentalMatrix) -> Vec<Warning> {
        let of_clicks = degeneracy::click_warnings(f, self.prepared.frames(), self.clicks);
        self.warnings.iter().cloned().chain(of_clicks).collect()
    }

    fn trust(&self, f: &FundamentalMatrix, margin: Option<f64>, refinement: Option<&Refinement>) -> Trust {
        let parameters = self.parameters;
        let distances: Vec<f64> =
            self.clicks.observed().iter().map(|pair| sampson_distance(f, pair)).collect();
        let matches: Vec<PointPair> =
            refinement.iter().flat_map(|r| r.matches.iter().map(|m| m.pair)).collect();
        let uncertainty = refinement.and_then(|r| r.uncertainty.as_ref());
        let deviation = uncertainty.and_then(|uncertainty| uncertainty.median_line2_deviation(&matches));
        let side = self.prepared.frames()[0].longer_side();
        let tolerance = PLANE_TOLERANCE * side.max(PLANE_SIDE) / PLANE_SIDE;
        Trust::judge(&Evidence {
            patches: parameters.search == Search::Patches,
            matches: refinement.map(|r| r.matches.len()),
            clicks: &distances,
            click_sigma: parameters.click_sigma,
            margin,
            deviation,
            on_one_plane: share_on_one_plane(&matches, tolerance, parameters.seed),
            side,
        })
    }
}
