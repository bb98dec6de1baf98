//! Refinement of all seven degrees of freedom at full resolution, on patches matched along the
//! epipolar lines.
//!
//! `F` is known to a few pixels, so each corner of image 1 is compared only with the corners of image 2
//! near its epipolar line. Mutual best matches are aligned to sub-pixel positions, and `F` is refitted
//! to them with a robust cost. Then the same is done with a narrower band. The clicks take part with
//! their own uncertainty.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::aligned_features::AlignedFeatures;
use super::corner_patches::CornerPatches;
use super::dense::DenseCorners;
use super::feature_support::FLOOR;
use super::level_corners::{Alike, LevelCorners, MutualMatch};
use super::matches::{LEAST_MATCHES, LevelMatch, MATCH_SIGMA, RefinedMatch, at_level};
use crate::cancel::CancelFlag;
use crate::estimate::evidence::lazy::Lazy;
use crate::estimate::fit::Uncertainty;
use crate::geometry::{
    FundamentalMatrix, Matrix9, Observation, PointPair, fit_fundamental, sampson_distance,
};
use crate::image::{Alignment, PairLevel, Placement, RelativeView, align, warps_around};

/// Matches of a refined geometry, their noise, and its uncertainty.
#[derive(Debug, Clone)]
pub struct Refinement {
    /// Patches matched along the epipolar lines.
    pub matches: Vec<RefinedMatch>,
    /// Uncertainty of the geometry. `None` if the matches do not determine it.
    pub uncertainty: Option<Uncertainty>,
    /// Noise of the matches, px: half of the right ones have a smaller Sampson distance. `None` for too
    /// few matches.
    pub noise: Option<f64>,
    /// Whether the cameras are known and the geometry is their essential matrix.
    pub is_posed: bool,
}

/// A geometry on the way of a refinement, and the matches to which it was fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RefinementStep {
    /// Fundamental matrix of the full-size images, `x2ᵀ F x1 = 0`.
    pub fundamental: FundamentalMatrix,
    /// Number of matches found along the lines of the step before.
    pub matches: usize,
}

/// Corners and patches of one level, computed once per image pair.
#[derive(Debug, Default)]
pub(in crate::estimate) struct RefinementLevel {
    /// Patches of this size, shared with other stages.
    patches: SharedPatches,
    corners: Lazy<LevelCorners>,
    dense: Lazy<DenseCorners>,
    /// Best places in image 2 for the surroundings of a corner of image 1, starting at a corner of image 2
    /// under a warp. They do not depend on `F`, so the next refinement needs most of them again.
    aligned: Mutex<HashMap<Alike, Option<Placement>>>,
}

/// Corners of each image. With 2,500 the accuracy is the same and the time twice as long
/// (`lab/notes.md`).
const CORNERS: usize = 1500;
/// Widths of the band, px of the level, one for each round: the error of a ranked geometry, then
/// the error of a refined geometry.
const BANDS: [f64; 3] = [4.0, 2.0, 1.2];
/// Width of a band in standard deviations of a match: 99.7 % of Gaussian errors are within it.
const BAND_DEVIATIONS: f64 = 3.0;
/// Least scale of the robust fit, in standard deviations of a match: nearer matches are equally
/// good. It decides in the last round only, where the band alone would give 1.3.
const LEAST_SCALE: f64 = 1.5;

/// Result of a refinement.
#[derive(Debug, Clone)]
pub(in crate::estimate) struct Refined {
    pub fundamental: FundamentalMatrix,
    pub refinement: Refinement,
    /// Weight of the evidence: the sum over the matches of the correlation excess times the fit.
    /// The fit is 1 on the epipolar line, ½ at the deviation of a match, and falls with the square
    /// of the distance. The right one of several refinements has the largest weight on nearly every
    /// pair measured.
    pub weight: f64,
    /// Standard deviation of the weight, as a sum over independent matches (Poisson process).
    pub weight_deviation: f64,
    /// The fits that led here, in order.
    pub steps: Vec<RefinementStep>,
}

impl Refined {
    /// Returns the result for a geometry fitted to matches at a level, with their noise and the covariance
    /// of the fit. All are in pixels of the level.
    pub(super) fn new(
        level: &PairLevel,
        f: &FundamentalMatrix,
        matches: &[LevelMatch],
        noise: Option<f64>,
        covariance: Option<&Matrix9>,
    ) -> Option<Self> {
        let weight = |m: &LevelMatch| {
            let deviations = sampson_distance(f, &m.found.pair) / m.sigma;
            f64::from(m.found.correlation - FLOOR) / (1.0 + deviations.powi(2))
        };
        let weights: Vec<f64> = matches.iter().map(weight).collect();
        let full_size = level.scales.map(f64::recip);
        let at_full_size =
            |m: &LevelMatch| RefinedMatch { pair: m.found.pair.rescaled(full_size), ..m.found };
        Some(Self {
            fundamental: f.rescaled(full_size)?,
            refinement: Refinement {
                matches: matches.iter().map(at_full_size).collect(),
                uncertainty: covariance.map(|c| Uncertainty::new(f, c, level.scales)),
                noise: noise.map(|noise| noise / level.scales[0]),
                is_posed: false,
            },
            weight: weights.iter().sum(),
            weight_deviation: weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt(),
            steps: Vec::new(),
        })
    }

    /// Returns the geometry that a further fit found, with all steps; this one if it found none.
    #[must_use]
    pub fn replaced_by(self, further: Option<Self>) -> Self {
        match further {
            Some(further) => further.after(self.steps),
            None => self,
        }
    }

    /// Returns this geometry with the steps that led to it: `before`, and its own.
    #[must_use]
    pub(super) fn after(self, before: impl IntoIterator<Item = RefinementStep>) -> Self {
        Self { steps: before.into_iter().chain(self.steps).collect(), ..self }
    }
}

/// Corners and patches under one view, computed for each size when first needed.
#[derive(Debug, Clone, Default)]
pub(super) struct SharedPatches(Arc<Mutex<Vec<PatchesOfScales>>>);

type PatchesOfScales = ([f64; 2], PatchesOfSize);
type PatchesOfSize = Arc<Lazy<Arc<CornerPatches>>>;

impl SharedPatches {
    pub fn get(&self, level: &PairLevel, view: RelativeView) -> Arc<CornerPatches> {
        let patches = || CornerPatches::new(level, CORNERS, warps_around(&level.warp(view)));
        Arc::clone(self.of_size(level.scales).get_or_make(|| Arc::new(patches())))
    }

    fn of_size(&self, scales: [f64; 2]) -> PatchesOfSize {
        // Entries are complete even if a thread that held the lock panicked.
        let mut sizes = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // Equal sizes have bitwise equal scales.
        let same = |of: &[f64; 2]| of.map(f64::to_bits) == scales.map(f64::to_bits);
        if let Some((_, known)) = sizes.iter().find(|(of, _)| same(of)) {
            return Arc::clone(known);
        }
        let fresh = PatchesOfSize::default();
        sizes.push((scales, Arc::clone(&fresh)));
        fresh
    }
}

impl RefinementLevel {
    /// Returns a level with these patches.
    pub fn on(patches: &SharedPatches) -> Self {
        Self { patches: patches.clone(), ..Self::default() }
    }

    fn known(&self) -> MutexGuard<'_, HashMap<Alike, Option<Placement>>> {
        // Entries are whole whatever happened to a thread that held the lock.
        self.aligned.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A level of the refinement, with everything needed to find matches along the epipolar lines.
#[derive(Clone, Copy)]
pub(super) struct LevelMatcher<'a> {
    pub stage: &'a RefinementLevel,
    pub level: PairLevel<'a>,
    pub view: RelativeView,
    pub features: &'a AlignedFeatures,
}

impl LevelMatcher<'_> {
    /// Returns the corners, found when first needed.
    pub fn corners(&self) -> &LevelCorners {
        self.stage.corners.get_or_make(|| LevelCorners::new(self.stage.patches.get(&self.level, self.view)))
    }

    /// Returns the corners with which a known geometry is matched densely, found when first needed.
    pub fn dense_corners(&self) -> &DenseCorners {
        self.stage.dense.get_or_make(|| DenseCorners::new(&self.level))
    }

    /// Refines `f` at this level. `None` if too few matches support it. `f`, clicks and features are in
    /// full-size pixels.
    pub fn refine(
        &self,
        f: &FundamentalMatrix,
        clicks: &[Observation],
        cancel: &CancelFlag,
    ) -> Option<Refined> {
        let mut current = f.rescaled(self.level.scales)?;
        let mut matches: Vec<LevelMatch> = Vec::new();
        let mut covariance = None;
        let mut steps = Vec::new();
        let full_size = self.level.scales.map(f64::recip);
        for band in BANDS {
            if cancel.is_cancelled() {
                return None;
            }
            matches = self.matches_along_lines(&current, band);
            if matches.len() < LEAST_MATCHES {
                return None;
            }
            let observations: Vec<Observation> = matches
                .iter()
                .map(|m| Observation { pair: m.found.pair, sigma: m.sigma })
                .chain(clicks.iter().map(|click| at_level(click, &self.level)))
                .collect();
            let scale = (band / BAND_DEVIATIONS / MATCH_SIGMA).max(LEAST_SCALE);
            let fitted = fit_fundamental(&current, &observations, scale)?;
            (current, covariance) = (fitted.fundamental, fitted.covariance);
            steps.push(RefinementStep { fundamental: current.rescaled(full_size)?, matches: matches.len() });
        }
        matches.retain(|m| sampson_distance(&current, &m.found.pair) < BANDS[BANDS.len() - 1]);
        Some(Refined::new(&self.level, &current, &matches, None, covariance.as_ref())?.after(steps))
    }

    /// Returns the matches of features and the mutual best matches of corners within `band` px of each
    /// other's epipolar lines, with sub-pixel positions in image 2. All are in pixels of the level.
    pub fn matches_along_lines(&self, f: &FundamentalMatrix, band: f64) -> Vec<LevelMatch> {
        let corners = self.corners();
        let mutual = corners.mutual(corners.places2.mutually_near(f, band));
        let of_corners =
            mutual.iter().zip(self.placements(corners, &mutual)).filter_map(|(mutual, placement)| {
                let point1 = corners.patches.points1[mutual.alike.corner1 as usize];
                let Placement { at, affine } = placement?;
                let pair = PointPair { point1, point2: at };
                let found = RefinedMatch { pair, correlation: mutual.correlation };
                Some(LevelMatch { found, affine, sigma: MATCH_SIGMA, prior: mutual.prior })
            });
        of_corners.chain(self.features.near(&self.level, f, band)).collect()
    }

    /// Returns sub-pixel positions in image 2, and computes unknown ones in parallel. `None` where the
    /// surroundings do not fit after all.
    fn placements(&self, corners: &LevelCorners, mutual: &[MutualMatch]) -> Vec<Option<Placement>> {
        let fresh: Vec<Alike> = {
            let known = self.stage.known();
            mutual.iter().map(|m| m.alike).filter(|alike| !known.contains_key(alike)).collect()
        };
        let found: Vec<(Alike, Option<Placement>)> = fresh
            .into_par_iter()
            .map(|alike| {
                let point1 = corners.patches.points1[alike.corner1 as usize];
                let at = corners.places2.points[alike.corner2 as usize];
                let start = Placement { at, affine: corners.patches.warps[alike.warp as usize] };
                (alike, align(self.level.planes, point1, start, &Alignment::STRICT))
            })
            .collect();
        let mut known = self.stage.known();
        known.extend(found);
        mutual.iter().map(|m| known.get(&m.alike).copied().flatten()).collect()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::super::level_corners::LEAST_CORRELATION;
    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};
    use crate::image::{GrayPlane, PyramidPair};

    /// Calls `work` with the level of a side without features.
    fn at<T>(pyramids: &PyramidPair, side: f64, work: impl FnOnce(LevelMatcher) -> T) -> T {
        let (stage, features) = (&RefinementLevel::default(), &AlignedFeatures::default());
        work(LevelMatcher { stage, level: pyramids.level(side), view: RelativeView::UPRIGHT, features })
    }

    fn refined(
        pyramids: &PyramidPair,
        side: f64,
        f: &FundamentalMatrix,
        clicks: &[PointPair],
    ) -> Option<Refined> {
        let clicks: Vec<_> = clicks.iter().map(|pair| Observation { pair: *pair, sigma: 1.0 }).collect();
        at(pyramids, side, |matcher| matcher.refine(f, &clicks, &CancelFlag::default()))
    }

    #[test]
    fn a_textured_pair_gives_its_geometry_and_matches_to_a_fraction_of_a_pixel() {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let pyramids = PyramidPair::new(&plane1, &plane2, 48.0);
        let start = scene.disturbed(1.0);
        let before = scene.error(&start);
        assert!(before > 1.0, "{before} px");
        let found = refined(&pyramids, f64::INFINITY, &start, &scene.clicks()).unwrap();
        let after = scene.error(&found.fundamental);
        // Some hundred matches to a tenth of a pixel each.
        assert!(after < 0.1, "{before} px before, {after} px after");
        let matches = &found.refinement.matches;
        assert!(matches.len() > 100, "{}", matches.len());
        let mut off: Vec<f64> =
            matches.iter().map(|m| (scene.partner(m.pair.point1) - m.pair.point2).norm()).collect();
        off.sort_by(f64::total_cmp);
        assert!(off[off.len() / 2] < 0.1, "median {} px", off[off.len() / 2]);
        let right = off.iter().filter(|distance| **distance < 0.5).count();
        assert!(10 * right > 9 * off.len(), "{right} of {}", off.len());
        let in_band = |m: &RefinedMatch| sampson_distance(&found.fundamental, &m.pair) < BANDS[2];
        assert!(matches.iter().all(|m| m.correlation > LEAST_CORRELATION && in_band(m)));
        // What it says of itself: the lines are off by about their deviation.
        let pairs: Vec<PointPair> = matches.iter().map(|m| m.pair).collect();
        let uncertainty = found.refinement.uncertainty.as_ref().unwrap();
        let deviation = uncertainty.median_line2_deviation(&pairs).unwrap();
        assert!(deviation > 0.1 * after && deviation < 10.0 * after, "{deviation} px said, {after} px seen");
        // The right geometry weighs more than one that no depth explains, if that finds matches at all.
        let columns = Matrix3::new(0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 40.0);
        let columns = FundamentalMatrix::from_rank_two(columns).unwrap();
        let wrong = refined(&pyramids, f64::INFINITY, &columns, &[]).map_or(0.0, |r| r.weight);
        assert!(found.weight > 2.0 * wrong, "{} {wrong}", found.weight);
    }

    #[test]
    fn results_are_in_full_size_pixels_at_every_level() {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let pyramids = PyramidPair::new(&plane1, &plane2, 48.0);
        let found = refined(&pyramids, 160.0, &scene.disturbed(0.5), &scene.clicks()).unwrap();
        let after = scene.error(&found.fundamental);
        assert!(after < 0.5, "{after} px");
        let matches = &found.refinement.matches;
        assert!(matches.iter().all(|m| FRAME.contains(m.pair.point1) && FRAME.contains(m.pair.point2)));
        let right =
            matches.iter().filter(|m| (scene.partner(m.pair.point1) - m.pair.point2).norm() < 1.0).count();
        assert!(10 * right > 8 * matches.len(), "{right} of {}", matches.len());
        assert!(matches.iter().any(|m| m.pair.point1.x > 200.0), "not of the level");
    }

    #[test]
    fn what_was_aligned_once_stays_the_same_whatever_came_between() {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let pyramids = PyramidPair::new(&plane1, &plane2, 48.0);
        let [first, _, again] = at(&pyramids, f64::INFINITY, |matcher| {
            let starts = [0.5, -1.0, 0.5].map(|by| scene.disturbed(by));
            starts.map(|f| matcher.refine(&f, &[], &CancelFlag::default()).unwrap())
        });
        assert_eq!(first.fundamental, again.fundamental);
        assert_eq!(first.refinement.matches, again.refinement.matches);
    }

    #[test]
    fn without_matches_or_when_stopped_there_is_no_refinement() {
        let scene = ExactScene::aside();
        let flat = GrayPlane::from_fn(FRAME, |_, _| 80.0);
        let nothing = PyramidPair::new(&flat, &flat, 48.0);
        assert!(refined(&nothing, f64::INFINITY, &scene.fundamental(), &scene.clicks()).is_none());
        let [plane1, plane2] = scene.planes();
        let pyramids = PyramidPair::new(&plane1, &plane2, 48.0);
        let stopped = CancelFlag::default();
        stopped.cancel();
        let refined = |matcher: LevelMatcher| matcher.refine(&scene.fundamental(), &[], &stopped);
        assert!(at(&pyramids, f64::INFINITY, refined).is_none());
    }
}
