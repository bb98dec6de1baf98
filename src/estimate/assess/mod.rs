//! How far a geometry is to be trusted: what its lines, patches, matches and rivals say, and a verdict in words.

mod degeneracy;
mod examination;
mod margin;
mod parallax;

pub use degeneracy::SMALLEST_SIDE;
pub use examination::examine;

pub(super) use degeneracy::{check_images, check_points};

use super::patches::{PatchLevels, largest_plane};
use super::trust::{Evidence, PlaneEvidence};
use super::{
    Assessment, Clicks, Estimate, Parameters, PatchSupport, PreparedPair, Refinement, Search, Trust, Warning,
};
use crate::geometry::{FundamentalMatrix, PointPair, sampson_distance};
use crate::similarity::SimilaritySource;
use examination::Examiner;
use margin::margin;
use nalgebra::Matrix3;
use parallax::OffPlane;

/// How near a match must be to a homography to be explained by it, px in an image of up to [`PLANE_SIDE`] px, more in
/// proportion in larger ones, where corners are found less precisely: three deviations of a refined match.
const PLANE_TOLERANCE: f64 = 1.0;
const PLANE_SIDE: f64 = 800.0;

/// What a geometry is judged by, besides itself.
pub(super) struct Judge<'a> {
    pub prepared: &'a PreparedPair,
    pub source: &'a dyn SimilaritySource,
    pub patches: &'a PatchLevels,
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
        let Self { prepared, source, patches, parameters, .. } = *self;
        let examiner = Examiner { prepared, source, patches, parameters };
        // The figures of the result itself, not of the hypothesis it was refined from.
        let turn = self.hypotheses.first().map_or(0.0, Estimate::turn);
        let anchors = self.clicks.anchors();
        let lines = anchors.first_chunk::<2>().and_then(|anchors| examiner.line_figures(*anchors, f, turn));
        let support = examiner.patch_support(f);
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

    /// What one plane explains, and what lies off it.
    fn plane(&self, f: &FundamentalMatrix, matches: &[PointPair], tolerance: f64) -> Option<PlaneEvidence> {
        let (h, most) = largest_plane(matches, tolerance, self.parameters.seed)?;
        let share = most as f64 / matches.len() as f64;
        let fine = self.patches.fine(self.prepared.pyramids());
        let [s1, s2] = fine.scales;
        let at_level = |s: f64| {
            let shift = 0.5 * s - 0.5;
            Matrix3::new(s, 0.0, shift, 0.0, s, shift, 0.0, 0.0, 1.0)
        };
        let at_fine = at_level(s2) * h * at_level(s1).try_inverse()?;
        let side = s1 * self.prepared.frames()[0].longer_side();
        let distinctive = OffPlane::new(&fine.support, &f.rescaled(s1, s2)?, &at_fine, side);
        let refined = OffPlane::refined(matches, f, &h, tolerance, self.prepared.frames()[0].longer_side());
        // Either may hold the epipoles: what is seen from afar, or what is seen finely.
        let off = if refined.by_chance < distinctive.by_chance { refined } else { distinctive };
        let OffPlane { groups, agreeing, by_chance } = off;
        Some(PlaneEvidence { share, by_chance, groups, agreeing })
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
            plane: self.plane(f, &matches, tolerance),
            side,
        })
    }
}
