//! Assessment of a geometry: figures of its lines, patches, matches and rivals, and the verdict.

mod agreement;
mod baseline;
mod degeneracy;
mod examination;
mod lens;
mod line_evidence;
mod margin;
mod parallax;
mod pattern;
mod points;
mod warp;

pub(in crate::estimate) use agreement::{given_figures, unguided_agreement};
pub use degeneracy::SMALLEST_SIDE;
pub use examination::examine;

pub(in crate::estimate) use degeneracy::{check_images, check_points, little_texture};
pub(in crate::estimate) use points::PointEvidence;

use std::sync::Arc;

use nalgebra::Matrix3;

use crate::cancel::CancelFlag;
use crate::estimate::evidence::lines::ComparedPencils;
use crate::estimate::evidence::patches::{Refined, UnguidedMatch, resized};
use crate::estimate::evidence::viewed::{SearchInput, ViewedPair};
use crate::estimate::fit::false_alarms::{Agreement, OF_A_PLANE, PRECISION, within};
use crate::estimate::fit::{largest_plane, strong_lens_is_likelier};
use crate::estimate::verdict::selection::ClickedPairs;
use crate::estimate::verdict::trust::{
    Baseline, Evidence, HALF_PLANE, LineEvidence, Mirror, OffPlane, PlaneEvidence, RefinedOn, Relief,
    Together, USUAL_SIDE,
};
use crate::estimate::{
    Assessment, Estimate, PatchSupport, PlaneHomography, Refinement, Search, Trust, Warning,
};
use crate::geometry::{
    Frame, FundamentalMatrix, PointPair, finite_point, median, sampson_distance, transfer_error,
};
use agreement::unguided_on_lines;
use baseline::Posed;
use examination::{line_figures, patch_support};
use line_evidence::line_evidence;
use margin::{all_apart, differs, least_clear, margin};
use parallax::{CORNER_SIGMA, precision};

/// Largest distance of a match from a homography that explains it, px: three deviations of a
/// refined match. It grows in proportion for images larger than [`USUAL_SIDE`], where corners are
/// less precise.
const PLANE_TOLERANCE: f64 = 1.0;

/// Largest parallax of a match near a plane, as a share of the longer side. Wrong matches lie
/// anywhere, most of them farther off.
const NEAR_PLANE: f64 = 0.05;

/// Data from which a geometry follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::estimate) enum RestsOn {
    /// The images, with the clicks and the matches from elsewhere.
    Images,
    /// The clicks alone.
    ClicksAlone,
    /// Matches from elsewhere alone.
    GivenAlone,
}

/// Evidence by which a geometry is judged.
pub(in crate::estimate) struct Judge<'a> {
    pub viewed: &'a ViewedPair<'a>,
    /// Geometries found by the search, best first.
    pub hypotheses: &'a [Estimate],
    /// Pencils through the anchors.
    pub pencils: &'a [Arc<ComparedPencils>],
    pub rests_on: RestsOn,
    pub cancel: &'a CancelFlag,
}

/// The largest plane, and what lies beside it.
struct FoundPlane {
    /// `None` if chance explains the matches on it.
    plane: Option<PlaneHomography>,
    evidence: PlaneEvidence,
    together: Together,
    relief: Option<Relief>,
    mirror: Option<Mirror>,
}

impl Judge<'_> {
    /// Returns the assessment of a preliminary geometry, without a verdict.
    pub fn preliminary(&self, f: &FundamentalMatrix, support: Option<PatchSupport>) -> Assessment {
        let SearchInput { prepared, parameters, .. } = self.viewed.input;
        let frames = prepared.frames();
        let rival = self.hypotheses.iter().position(|other| differs(f, other.fundamental(), &[], frames));
        Assessment {
            lines: self.hypotheses.first().and_then(|best| best.assessment.lines.clone()),
            support,
            margin: margin(self.hypotheses, rival, parameters.search),
            warnings: self.warnings(f),
            ..Assessment::default()
        }
    }

    /// Returns the full assessment of a final geometry, with the verdict. Rivals are compared with
    /// it on the matches `supporting`.
    pub fn result(
        &self,
        f: &FundamentalMatrix,
        supporting: &[PointPair],
        refined: Option<Refined>,
    ) -> Assessment {
        let viewed = self.viewed;
        let SearchInput { prepared, clicks, parameters } = viewed.input;
        // These are figures of the result, not of the hypothesis from which it was refined.
        let turn = self.hypotheses.first().map_or(0.0, Estimate::turn);
        let anchors = clicks.anchors();
        let lines = anchors.first_chunk().and_then(|anchors| line_figures(viewed, *anchors, f, turn));
        let support = patch_support(viewed, f);
        let apart = all_apart(f, self.hypotheses, supporting, prepared.frames());
        let margin = margin(self.hypotheses, apart.rival(), parameters.search);
        let least = |refined: &Refined| least_clear(refined.weight, refined.weight_deviation);
        let has_rival = apart.rival().is_some();
        // Without figures before refinement, the figures after it decide.
        let is_open = |refined: &&Refined| has_rival && margin.is_none_or(|margin| margin < least(refined));
        let open = refined.as_ref().filter(is_open);
        let refined_margin = open.map(|refined| self.refined_margin(f, refined.weight, supporting));
        let refinement = refined.map(|refined| refined.refinement);
        let line_evidence = self.line_evidence(f, supporting, refinement.as_ref());
        let (trust, plane) = self.trust(f, refined_margin.or(margin), refinement.as_ref(), line_evidence);
        let mut warnings = self.warnings(f);
        let is_free = refinement.as_ref().is_some_and(|refinement| !refinement.is_posed);
        if is_free && prepared.calibrations().is_some() {
            warnings.push(Warning::CalibrationContradicted);
        }
        let trust = Some(trust);
        let distinctive =
            refinement.as_ref().map_or_else(Arc::default, |_| viewed.patches.distinctive().into());
        Assessment {
            lines,
            support,
            margin,
            refined_margin,
            apart: Some(apart),
            line_evidence,
            barcodes: None,
            refinement,
            distinctive,
            warnings,
            trust,
            plane,
            of_given: self.rests_on == RestsOn::GivenAlone,
        }
    }

    /// Returns the advantage of a refined geometry, whose matches weigh `weight`, over its refined
    /// rivals. A rival counts if refinement leaves it clearly different.
    fn refined_margin(&self, f: &FundamentalMatrix, weight: f64, supporting: &[PointPair]) -> f64 {
        let viewed = self.viewed;
        let SearchInput { prepared, parameters, .. } = viewed.input;
        let clicked = ClickedPairs::of(viewed.input);
        let is_rival = |other: &FundamentalMatrix| differs(f, other, supporting, prepared.frames());
        let heaviest = self
            .hypotheses
            .iter()
            .map(Estimate::fundamental)
            .filter(|other| is_rival(other))
            .take(parameters.refinement.rivals)
            .filter_map(|rival| viewed.patches.refine(rival, &clicked.0, self.cancel))
            .filter(|refined| is_rival(&refined.fundamental))
            .map(|refined| refined.weight)
            .fold(0.0, f64::max);
        margin::relative(weight, heaviest)
    }

    /// Returns the evidence of the images for the lines. `None` if a geometry does not rest on the images, or if
    /// refinement is off.
    fn line_evidence(
        &self,
        f: &FundamentalMatrix,
        supporting: &[PointPair],
        refinement: Option<&Refinement>,
    ) -> Option<LineEvidence> {
        let SearchInput { prepared, parameters, .. } = self.viewed.input;
        let is_refined = parameters.search == Search::Patches && parameters.refinement.refine;
        if self.rests_on != RestsOn::Images || !is_refined {
            return None;
        }
        let (patches, frames) = (&self.viewed.patches, prepared.frames());
        let found = refinement.map(|refinement| refinement.matches.iter().map(|m| m.pair).collect());
        let matches: Vec<PointPair> = found.unwrap_or_else(|| supporting.to_vec());
        let others = self.hypotheses.iter().map(Estimate::fundamental);
        let rivals: Vec<&FundamentalMatrix> =
            others.filter(|other| differs(f, other, &matches, frames)).collect();
        let agreement = unguided_agreement(patches, f, frames);
        Some(line_evidence(f, &rivals, patches.unguided(), frames, &agreement))
    }

    fn warnings(&self, f: &FundamentalMatrix) -> Vec<Warning> {
        let SearchInput { prepared, clicks, .. } = self.viewed.input;
        let mut warnings = little_texture(clicks, self.pencils);
        warnings.extend(degeneracy::click_warnings(f, prepared.frames(), clicks));
        warnings
    }

    /// Returns the largest plane, the evidence beside it, and the distinctive matches that move
    /// together. `None` if no plane is found.
    fn plane(&self, f: &FundamentalMatrix, matches: &[PointPair], tolerance: f64) -> Option<FoundPlane> {
        let SearchInput { prepared, clicks, parameters } = self.viewed.input;
        let frames = prepared.frames();
        let (h, most) = largest_plane(matches, tolerance, parameters.seed)?;
        let share = most as f64 / matches.len() as f64;
        let bent_share = lens::share_through_a_lens(matches, &h, frames, tolerance);
        let fine = self.viewed.patches.fine();
        let (h_fine, f_fine) = (resized(&h, fine.scales)?, f.rescaled(fine.scales)?);
        let (side, side_fine) = (frames[0].longer_side(), fine.scales[0] * frames[0].longer_side());
        let distinctive = fine.support.distinctive();
        let afar = OffPlane::new(&distinctive, &f_fine, &h_fine, side_fine, CORNER_SIGMA);
        let patches = &self.viewed.patches;
        let unguided = patches.unguided();
        let is_near = |m: &PointPair| {
            let mapped = finite_point(&(h * m.point1.to_homogeneous()));
            mapped.is_some_and(|at| (m.point2 - at).norm() < NEAR_PLANE * side)
        };
        // A corner has fewer look-alikes near its place on a plane that explains many matches.
        let mut testify = Vec::new();
        if share > HALF_PLANE {
            testify = patches.unguided_corners(is_near);
        }
        testify.extend(unguided);
        let near: Vec<PointPair> =
            testify.iter().filter(|m| m.is_likely()).map(|m| m.pair).filter(is_near).collect();
        let closely = OffPlane::new(&near, f, &h, side, precision(&near, f));
        // Each clicked pair shows one scene point in both images.
        let clicked = OffPlane::new(&clicks.observed(), f, &h, side, parameters.click_sigma);
        // Each kind of matches alone may determine the epipoles.
        let is_still = leaves_in_place(&h, matches, tolerance);
        let off = afar.or_stronger(closely).or_stronger(clicked);
        let evidence = PlaneEvidence { share, bent_share, off, is_still };
        let together = parallax::together(&distinctive, &f_fine, &h_fine, side_fine);
        let relief = warp::relief(&testify, matches, &h, f, frames[0], tolerance, parameters.seed);
        // Most unguided matches of an upright pair are right; those of a mirror image are not.
        let on_lines = |m: &&UnguidedMatch| sampson_distance(f, &m.pair) < tolerance;
        let likely = || unguided.iter().filter(|m| m.is_likely());
        let is_suspect = 2 * likely().filter(on_lines).count() < likely().count();
        let mirror = Some(Mirror { matches: self.viewed.patches.mirrored(), is_suspect });
        Some(FoundPlane {
            mirror,
            plane: plane_homography(&h, matches, frames[1], tolerance),
            evidence,
            together,
            relief,
        })
    }

    /// Returns the evidence for the direction of the baseline of known cameras.
    fn baseline(&self, f: &FundamentalMatrix, matches: &[PointPair], tolerance: f64) -> Option<Baseline> {
        let SearchInput { prepared, parameters, .. } = self.viewed.input;
        let (calibrations, unguided) = (&prepared.calibrations()?, self.viewed.patches.unguided());
        let (side, seed) = (prepared.frames()[0].longer_side(), parameters.seed);
        Posed { f, calibrations, matches, unguided, side, tolerance, seed }.baseline()
    }

    /// Returns the verdict, and the plane if the verdict says that only a plane is certain.
    fn trust(
        &self,
        f: &FundamentalMatrix,
        margin: Option<f64>,
        refinement: Option<&Refinement>,
        lines: Option<LineEvidence>,
    ) -> (Trust, Option<PlaneHomography>) {
        let SearchInput { prepared, clicks, parameters } = self.viewed.input;
        let distances: Vec<f64> = clicks.observed().iter().map(|pair| sampson_distance(f, pair)).collect();
        let matches: Vec<PointPair> =
            refinement.iter().flat_map(|r| r.matches.iter().map(|m| m.pair)).collect();
        let uncertainty = refinement.and_then(|r| r.uncertainty.as_ref());
        let deviation = uncertainty.and_then(|uncertainty| uncertainty.median_line2_deviation(&matches));
        let side = prepared.frames()[0].longer_side();
        let tolerance = PLANE_TOLERANCE * (side / USUAL_SIDE).max(1.0);
        let found = self.plane(f, &matches, tolerance);
        let is_posed = refinement.is_some_and(|refinement| refinement.is_posed);
        let is_refined = parameters.search == Search::Patches && parameters.refinement.refine;
        let patches = &self.viewed.patches;
        let unguided = is_refined.then(|| unguided_agreement(patches, f, prepared.frames()));
        let given = prepared.given().map(|given| given_figures(given, f, parameters.click_sigma));
        let trust = Trust::judge(&Evidence {
            patches: parameters.search == Search::Patches,
            barcodes: None,
            refined_on: match (self.rests_on, refinement) {
                (RestsOn::GivenAlone, _) => RefinedOn::Given(matches.len()),
                (RestsOn::ClicksAlone, None) => RefinedOn::Clicks,
                (_, Some(_)) => RefinedOn::Matches(matches.len()),
                _ if !parameters.refinement.refine => RefinedOn::Nothing,
                _ => RefinedOn::TooFewMatches,
            },
            clicks: &distances,
            click_sigma: parameters.click_sigma,
            margin,
            lines,
            deviation,
            plane: found.as_ref().map(|found| found.evidence),
            together: found.as_ref().map(|found| found.together).unwrap_or_default(),
            relief: found.as_ref().and_then(|found| found.relief),
            baseline: is_posed.then(|| self.baseline(f, &matches, tolerance)).flatten(),
            mirror: found.as_ref().and_then(|found| found.mirror),
            strong_lens: is_refined
                && degeneracy::have_dark_corners(prepared)
                && strong_lens_is_likelier(
                    &prepared.putative_matches(),
                    f,
                    prepared.frames(),
                    parameters.seed,
                ),
            unguided,
            unguided_on_lines: unguided.map_or(0, |_| unguided_on_lines(patches, f, tolerance)),
            given,
            pattern: pattern::residual_pattern(&matches, f, side),
            side,
        });
        let plane = found.and_then(|found| found.plane).filter(|_| trust.says_one_plane());
        (trust, plane)
    }
}

/// Returns whether `h` leaves its matches in their places, to within the error of a match.
fn leaves_in_place(h: &Matrix3<f64>, matches: &[PointPair], tolerance: f64) -> bool {
    let on_plane = matches.iter().filter(|m| transfer_error(h, m) < tolerance);
    let moved: Vec<f64> = on_plane.map(|m| (m.point2 - m.point1).norm()).collect();
    median(moved) < tolerance
}

/// Returns the homography `h` in the form of a result. `None` if chance explains its matches: they were found
/// along epipolar lines, and may be anywhere on these in image 2.
fn plane_homography(
    h: &Matrix3<f64>,
    matches: &[PointPair],
    frame2: Frame,
    tolerance: f64,
) -> Option<PlaneHomography> {
    let by_chance = matches.iter().map(|m| within(transfer_error(h, m).max(PRECISION), frame2));
    if !Agreement::of(by_chance, OF_A_PLANE).is_no_chance() {
        return None;
    }
    let residuals: Vec<f64> =
        matches.iter().map(|m| transfer_error(h, m)).filter(|error| *error < tolerance).collect();
    let last = h[(2, 2)];
    let divisor = if last.abs() > 1e-9 * h.norm() { last } else { h.norm() };
    Some(PlaneHomography {
        homography21: h / divisor,
        matches: residuals.len(),
        share: residuals.len() as f64 / matches.len().max(1) as f64,
        residual: median(residuals),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_whose_matches_hardly_move_is_that_of_a_still_camera() {
        let moved = |dx: f64| -> Vec<PointPair> {
            let at = |k: i32| (f64::from(k % 8) * 40.0, f64::from(k / 8) * 30.0);
            // One of five matches is beside the plane.
            let by = |k: i32| if k % 5 == 0 { 25.0 } else { dx };
            (0..64).map(|k| (at(k), by(k))).map(|((x, y), by)| PointPair::new(x, y, x + by, y)).collect()
        };
        let shift = |dx: f64| Matrix3::new(1.0, 0.0, dx, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        assert!(leaves_in_place(&shift(0.2), &moved(0.2), 1.0));
        assert!(!leaves_in_place(&shift(3.0), &moved(3.0), 1.0));
    }

    #[test]
    fn a_homography_that_chance_explains_is_not_told() {
        let frame = Frame::new(800, 600);
        let anywhere = |k: usize| {
            let at = |n: usize, side: usize| ((k * n + 37) % side) as f64;
            PointPair::new(at(131, 797), at(71, 599), at(211, 787), at(97, 593))
        };
        let on_a_plane = |k: usize| {
            let pair = anywhere(k);
            PointPair { point2: pair.point1 + crate::geometry::Vector::new(30.0, 5.0), ..pair }
        };
        let h = Matrix3::new(1.0, 0.0, 30.0, 0.0, 1.0, 5.0, 0.0, 0.0, 1.0);
        let told = |on: usize| {
            let matches: Vec<PointPair> =
                (0..112).map(|k| if k < on { on_a_plane(k) } else { anywhere(k) }).collect();
            plane_homography(&h, &matches, frame, 1.0).map(|plane| plane.matches)
        };
        assert_eq!((told(5), told(40)), (None, Some(40)));
    }
}
