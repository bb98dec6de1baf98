//! Matches of features at a level of the refinement, aligned to their surroundings.
//!
//! The position of a feature is precise to a quarter of its scale, that of a patch to a fraction of a
//! pixel. If the surroundings of a match are alike under the affine map of its two features, the match
//! is as precise as one of corners, and counts like one.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::feature_support::FeatureSupport;
use super::matches::{LevelMatch, MATCH_SIGMA, RefinedMatch};
use super::near_lines::is_within;
use crate::geometry::{FundamentalMatrix, PointPair};
use crate::image::{Alignment, PairLevel, PatchSampler, Placement, Warp, align, correlation};

/// Matches of features at one level, each aligned when it is first near a geometry. The
/// alignment does not depend on `F`.
#[derive(Debug, Default)]
pub(super) struct AlignedFeatures {
    features: Arc<[FeatureSupport]>,
    aligned: Vec<OnceLock<LevelMatch>>,
}

/// Least correlation of an aligned patch: above the correlation of chance matches after alignment.
const LEAST_CORRELATION: f32 = 0.8;

impl AlignedFeatures {
    /// Returns matches, none of which is aligned yet.
    pub fn new(features: Arc<[FeatureSupport]>) -> Self {
        Self { aligned: features.iter().map(|_| OnceLock::new()).collect(), features }
    }

    /// Returns the matches within `band` px of their epipolar lines, in pixels of the level.
    pub fn near(&self, level: &PairLevel, f: &FundamentalMatrix, band: f64) -> Vec<LevelMatch> {
        self.features
            .par_iter()
            .zip(&self.aligned)
            .filter(|(feature, _)| is_within(f, &feature.pair.rescaled(level.scales), band))
            .map(|(feature, aligned)| *aligned.get_or_init(|| placed(level, feature)))
            .filter(|m| is_within(f, &m.found.pair, band))
            .collect()
    }

    /// Returns all matches that could be aligned, in pixels of the level.
    pub fn all(&self, level: &PairLevel) -> Vec<LevelMatch> {
        self.features
            .par_iter()
            .zip(&self.aligned)
            .map(|(feature, aligned)| *aligned.get_or_init(|| placed(level, feature)))
            .filter(|m| m.sigma <= MATCH_SIGMA)
            .collect()
    }
}

/// Returns the match at the place where its surroundings fit, or else at its features.
fn placed(level: &PairLevel, feature: &FeatureSupport) -> LevelMatch {
    let pair = feature.pair.rescaled(level.scales);
    let affine: Warp = feature.affine * (level.scales[1] / level.scales[0]);
    let start = Placement { at: pair.point2, affine };
    let moved = align(level.planes, pair.point1, start, &Alignment::STRICT).filter(|placement| {
        let first = PatchSampler::new(level.planes[0], &Warp::identity()).patch(pair.point1);
        let second = PatchSampler::new(level.planes[1], &placement.affine).patch(placement.at);
        first.zip(second).is_some_and(|(first, second)| correlation(&first, &second) > LEAST_CORRELATION)
    });
    let found = |pair: PointPair, affine: Warp, sigma: f64| LevelMatch {
        found: RefinedMatch { pair, correlation: feature.correlation },
        affine,
        sigma,
        prior: feature.prior,
    };
    match moved {
        Some(Placement { at, affine }) => found(PointPair { point2: at, ..pair }, affine, MATCH_SIGMA),
        None => found(pair, affine, (feature.sigma * level.scales[0]).max(MATCH_SIGMA)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::geometry::{Point, Vector};
    use crate::image::PyramidPair;

    fn scene() -> (ExactScene, PyramidPair) {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        (scene, PyramidPair::new(&plane1, &plane2, 48.0))
    }

    /// Returns a match of a point that is off by `by`.
    fn off(scene: &ExactScene, point1: Point, by: Vector) -> FeatureSupport {
        let pair = PointPair { point1, point2: scene.partner(point1) + by };
        FeatureSupport::new(pair, 0.9, Warp::identity(), 0.5)
    }

    #[test]
    fn a_feature_that_is_a_bit_off_is_moved_and_counts_like_a_corner_and_another_stays() {
        let (scene, pyramids) = scene();
        let level = pyramids.level(f64::INFINITY);
        let corners = level.corners(0, 60, 20);
        let near: Vec<FeatureSupport> =
            corners.iter().map(|corner| off(&scene, *corner, Vector::new(0.5, -0.4))).collect();
        let found: Vec<LevelMatch> = near.iter().map(|feature| placed(&level, feature)).collect();
        let moved: Vec<&LevelMatch> = found.iter().filter(|m| m.sigma <= MATCH_SIGMA).collect();
        assert!(3 * moved.len() > 2 * found.len(), "{} of {}", moved.len(), found.len());
        let mut errors: Vec<f64> =
            moved.iter().map(|m| (scene.partner(m.found.pair.point1) - m.found.pair.point2).norm()).collect();
        errors.sort_by(f64::total_cmp);
        let middle = errors[errors.len() / 2];
        assert!(middle < 0.1, "{middle} px");
        // Different surroundings.
        let wrong: Vec<FeatureSupport> =
            corners.iter().map(|corner| off(&scene, *corner, Vector::new(19.0, 23.0))).collect();
        let stayed = wrong.iter().filter(|feature| {
            let LevelMatch { found, sigma, .. } = placed(&level, feature);
            sigma > MATCH_SIGMA && found.pair == feature.pair
        });
        assert!(10 * stayed.count() > 9 * wrong.len());
    }

    #[test]
    fn only_what_is_near_the_lines_is_asked_for_and_it_is_the_same_each_time() {
        let (scene, pyramids) = scene();
        let level = pyramids.level(f64::INFINITY);
        let features: Vec<FeatureSupport> = level
            .corners(0, 60, 20)
            .into_iter()
            .enumerate()
            .map(|(k, point1)| off(&scene, point1, Vector::new(0.0, if k % 2 == 0 { 0.3 } else { 25.0 })))
            .collect();
        let half = features.len().div_ceil(2);
        let aligned = AlignedFeatures::new(features.into());
        let near = |band: f64| aligned.near(&level, &scene.fundamental(), band);
        let wide = near(4.0);
        assert!(wide.len() >= half - 2 && wide.len() <= half + 4, "{} of {half}", wide.len());
        assert!(near(0.5).iter().all(|found| wide.contains(found)) && near(4.0) == wide);
        assert!(AlignedFeatures::default().near(&level, &scene.fundamental(), 4.0).is_empty());
    }
}
