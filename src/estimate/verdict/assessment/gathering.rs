//! Gathering of the figures that a verdict on the result of a search rests on.

use nalgebra::Matrix3;

use super::agreement::{given_figures, unguided_agreement, unguided_on_lines};
use super::baseline::Posed;
use super::parallax::{contradicting, precision};
use super::relief::WarpTest;
use super::{Judge, RestsOn};
use crate::estimate::checks::have_dark_corners;
use crate::estimate::evidence::patches::{UnguidedMatch, resized};
use crate::estimate::evidence::viewed::SearchInput;
use crate::estimate::fit::false_alarms::{
    Agreement, OF_A_PLANE, OF_LINES, PRECISION, most_by_chance, within,
};
use crate::estimate::fit::{largest_plane, residual_pattern, strong_lens_is_likelier};
use crate::estimate::verdict::constants::{CORNER_SIGMA, HALF_PLANE, LARGEST_PARALLAX, largest_error};
use crate::estimate::verdict::trust::{
    Baseline, Case, Distinctive, LineEvidence, Mirror, OffPlane, PlaneEvidence, RefinedOn, Relief,
};
use crate::estimate::{PlaneHomography, Refinement, Search};
use crate::geometry::{
    Frame, FundamentalMatrix, PointPair, finite_point, median, sampson_distance, transfer_error,
};

/// The largest plane, and what lies beside it.
struct FoundPlane {
    /// `None` if chance explains the matches on it.
    plane: Option<PlaneHomography>,
    evidence: PlaneEvidence,
    relief: Option<Relief>,
}

impl Judge<'_> {
    /// Returns the largest plane and the evidence beside it. `None` if no plane is found.
    fn plane(&self, f: &FundamentalMatrix, matches: &[PointPair], tolerance: f64) -> Option<FoundPlane> {
        let SearchInput { prepared, clicks, parameters } = self.viewed.input;
        let frames = prepared.frames();
        let (h, most) = largest_plane(matches, tolerance, parameters.seed)?;
        let share = most as f64 / matches.len() as f64;
        let fine = self.viewed.patches.fine();
        let (h_fine, f_fine) = (resized(&h, fine.scales)?, f.rescaled(fine.scales)?);
        let (side, side_fine) = (frames[0].longer_side(), fine.scales[0] * frames[0].longer_side());
        let distinctive = fine.support.distinctive();
        let afar = OffPlane::new(&distinctive, &f_fine, &h_fine, side_fine, CORNER_SIGMA);
        let patches = &self.viewed.patches;
        let unguided = patches.unguided();
        let is_near = |m: &PointPair| {
            let mapped = finite_point(&(h * m.point1.to_homogeneous()));
            mapped.is_some_and(|at| (m.point2 - at).norm() < LARGEST_PARALLAX * side)
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
        let evidence = PlaneEvidence { share, off, is_still };
        let (frame, seed) = (frames[0], parameters.seed);
        let lead_over = &|pair: &PointPair, other2| patches.lead_over(pair, other2);
        let relief =
            WarpTest { f, matches, h: &h, unguided: &testify, lead_over, frame, tolerance, seed }.relief();
        Some(FoundPlane { plane: plane_homography(&h, matches, frames[1], tolerance), evidence, relief })
    }

    /// Returns the matches with the mirror image of image 2.
    fn mirror(&self, f: &FundamentalMatrix, tolerance: f64) -> Mirror {
        let patches = &self.viewed.patches;
        // Most unguided matches of an upright pair are right; those of a mirror image are not.
        let on_lines = |m: &&UnguidedMatch| sampson_distance(f, &m.pair) < tolerance;
        let likely = || patches.unguided().iter().filter(|m| m.is_likely());
        let is_suspect = 2 * likely().filter(on_lines).count() < likely().count();
        Mirror { matches: patches.mirrored(), is_suspect }
    }

    /// Returns the distinctive corner matches that contradict a geometry.
    fn distinctive(&self, f: &FundamentalMatrix) -> Option<Distinctive> {
        let fine = self.viewed.patches.fine();
        Some(contradicting(&fine.support.distinctive(), &f.rescaled(fine.scales)?))
    }

    /// Returns whether a lens as strong as a fisheye makes the matches clearly likelier.
    fn strong_lens(&self, f: &FundamentalMatrix) -> bool {
        let SearchInput { prepared, parameters, .. } = self.viewed.input;
        let matches = || prepared.putative_matches();
        have_dark_corners(prepared)
            && strong_lens_is_likelier(&matches(), f, prepared.frames(), parameters.seed)
    }

    /// Returns the evidence for the direction of the baseline of known cameras.
    fn baseline(&self, f: &FundamentalMatrix, matches: &[PointPair], tolerance: f64) -> Option<Baseline> {
        let SearchInput { prepared, parameters, .. } = self.viewed.input;
        let (calibrations, unguided) = (&prepared.calibrations()?, self.viewed.patches.unguided());
        let (side, seed) = (prepared.frames()[0].longer_side(), parameters.seed);
        let lead_over = &|pair: &PointPair, other2| self.viewed.patches.lead_over(pair, other2);
        Posed { f, calibrations, matches, unguided, lead_over, side, tolerance, seed }.baseline()
    }

    /// Returns the figures that the verdict rests on, and the largest plane.
    pub(super) fn case(
        &self,
        f: &FundamentalMatrix,
        margin: Option<f64>,
        refinement: Option<&Refinement>,
        lines: Option<LineEvidence>,
    ) -> (Case, Option<PlaneHomography>) {
        let SearchInput { prepared, clicks, parameters } = self.viewed.input;
        let distances: Vec<f64> = clicks.observed().iter().map(|pair| sampson_distance(f, pair)).collect();
        let matches: Vec<PointPair> =
            refinement.iter().flat_map(|r| r.matches.iter().map(|m| m.pair)).collect();
        let uncertainty = refinement.and_then(|r| r.uncertainty.as_ref());
        let deviation = uncertainty.and_then(|uncertainty| uncertainty.median_line2_deviation(&matches));
        let side = prepared.frames()[0].longer_side();
        let tolerance = largest_error(side);
        let found = self.plane(f, &matches, tolerance);
        let is_posed = refinement.is_some_and(|refinement| refinement.is_posed);
        let is_refined = parameters.search == Search::Patches && parameters.refinement.refine;
        let patches = &self.viewed.patches;
        let unguided = is_refined.then(|| unguided_agreement(patches, f, prepared.frames()));
        let given = prepared.given().map(|given| given_figures(given, f, parameters.click_sigma));
        let case = Case {
            patches: parameters.search == Search::Patches,
            barcodes: None,
            refined_on: match (self.rests_on, refinement) {
                (RestsOn::GivenAlone, _) => RefinedOn::Given(matches.len()),
                (RestsOn::ClicksAlone, None) => RefinedOn::Clicks,
                (_, Some(_)) => RefinedOn::Matches(matches.len()),
                _ if !parameters.refinement.refine => RefinedOn::Nothing,
                _ => RefinedOn::TooFewMatches,
            },
            clicks: distances.into(),
            click_sigma: parameters.click_sigma,
            margin,
            lines,
            deviation,
            plane: found.as_ref().map(|found| found.evidence),
            distinctive: is_refined.then(|| self.distinctive(f)).flatten(),
            relief: found.as_ref().and_then(|found| found.relief),
            baseline: is_posed.then(|| self.baseline(f, &matches, tolerance)).flatten(),
            mirror: is_refined.then(|| self.mirror(f, tolerance)),
            strong_lens: is_refined.then(|| self.strong_lens(f)),
            unguided,
            unguided_on_lines: unguided.map_or(0, |_| unguided_on_lines(patches, f, tolerance)),
            unguided_by_chance: unguided.map_or(0, |agreement| {
                let within = prepared.frames().map(|frame| within(tolerance, frame));
                most_by_chance(agreement.matches, within[0].max(within[1]), OF_LINES)
            }),
            given,
            pattern: residual_pattern(&matches, f, side),
            side,
        };
        (case, found.and_then(|found| found.plane))
    }
}

/// Returns whether `h` leaves its matches in their places, to within the error of a match.
pub(super) fn leaves_in_place(h: &Matrix3<f64>, matches: &[PointPair], tolerance: f64) -> bool {
    let on_plane = matches.iter().filter(|m| transfer_error(h, m) < tolerance);
    let moved: Vec<f64> = on_plane.map(|m| (m.point2 - m.point1).norm()).collect();
    median(moved) < tolerance
}

/// Returns the homography `h` in the form of a result. `None` if chance explains its matches: they were found
/// along epipolar lines, and may be anywhere on these in image 2.
pub(super) fn plane_homography(
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
