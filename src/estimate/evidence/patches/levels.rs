//! What patches need to be computed once per image pair, whatever the clicks: corners, correlations, votes.

use std::sync::Arc;

use nalgebra::Matrix3;

use super::aligned_features::AlignedFeatures;
use super::corner_patches::CornerPatches;
use super::feature_support::{FeatureSupport, SupportingMatch};
use super::guided_fit::{GuidedMatcher, Settling};
use super::refinement::{Refined, RefinementLevel, SharedPatches};
use super::support::{PatchSupport, Support, SupportLevel};
use super::voting::KappaVoting;
use crate::cancel::CancelFlag;
use crate::estimate::evidence::lazy::Lazy;
use crate::features::FeatureViews;
use crate::geometry::{FundamentalMatrix, Observation, PointPair, rescaling};
use crate::image::{PairLevel, PyramidPair, RelativeView, warps_around};

/// Longer side of the images at which patches first rank hypotheses, px: small enough for all
/// corners to be compared with all. Not measured.
const COARSE_SIDE: f64 = 384.0;
/// Corners of each image at the coarse size. The correlation matrix grows with their square. Not
/// measured.
const COARSE_CORNERS: usize = 600;
/// Longer side of the images at which hypotheses are ranked again, px: the right geometry stands
/// out more clearly than at half the size.
const FINE_SIDE: f64 = 768.0;
/// Look-alikes of a corner that vote for κ. More add mostly wrong votes. Not measured.
const VOTES_PER_CORNER: usize = 3;
/// Longer sides of the levels at which `F` is refined, px. The last is full size; the first brings
/// `F` near enough for a narrow band there.
const REFINEMENT_SIDES: [f64; 2] = [800.0, f64::INFINITY];

/// The patches of an image pair under a view, at all sizes, each made when it is first needed.
#[derive(Debug)]
pub(in crate::estimate) struct PatchLevels {
    corners: Arc<CornerLevels>,
    /// Matches of covariant features that support beside corners, and of which.
    features: Arc<[FeatureSupport]>,
    of: Option<FeatureViews>,
    /// The same at the levels of the refinement.
    aligned: [AlignedFeatures; REFINEMENT_SIDES.len()],
    /// Support where proposals are ranked, with the features.
    with_features: Lazy<SupportLevel>,
}

/// What corners say under a view, whether or not features stand beside them.
#[derive(Debug)]
struct CornerLevels {
    view: RelativeView,
    coarse: Lazy<SupportLevel>,
    voting: Lazy<KappaVoting>,
    /// Corners of the finer levels, which of a small picture are the same.
    patches: SharedPatches,
    fine: Lazy<SupportLevel>,
    refinement: [RefinementLevel; REFINEMENT_SIDES.len()],
}

impl PatchLevels {
    /// Levels of which nothing is made yet.
    pub fn new(view: RelativeView) -> Self {
        let patches = SharedPatches::default();
        let corners = CornerLevels {
            view,
            coarse: Lazy::default(),
            voting: Lazy::default(),
            fine: Lazy::default(),
            refinement: REFINEMENT_SIDES.map(|_| RefinementLevel::on(&patches)),
            patches,
        };
        Self {
            corners: Arc::new(corners),
            features: Arc::default(),
            of: None,
            aligned: Default::default(),
            with_features: Lazy::default(),
        }
    }

    /// The same corners, with matches of features beside them, in full-size pixels.
    pub fn with_features(&self, of: FeatureViews, features: Vec<FeatureSupport>) -> Self {
        let features: Arc<[FeatureSupport]> = features.into();
        Self {
            corners: Arc::clone(&self.corners),
            of: Some(of),
            aligned: REFINEMENT_SIDES.map(|_| AlignedFeatures::new(Arc::clone(&features))),
            with_features: Lazy::default(),
            features,
        }
    }

    /// How the images are turned and scaled against each other.
    pub fn view(&self) -> RelativeView {
        self.corners.view
    }

    /// Which covariant features support beside corners.
    pub fn features(&self) -> Option<FeatureViews> {
        self.of
    }

    /// Support where proposals are made: of corners alone.
    pub fn coarse(&self, pyramids: &PyramidPair) -> &SupportLevel {
        let corners = &self.corners;
        corners.coarse.get_or_make(|| corners.coarse(pyramids))
    }

    /// The corner pairs of the coarse level that vote for κ.
    pub fn voting(&self, pyramids: &PyramidPair) -> &KappaVoting {
        let vote = || KappaVoting::new(&self.coarse(pyramids).support, VOTES_PER_CORNER);
        self.corners.voting.get_or_make(vote)
    }

    /// Patches that agree with a geometry (full-size pixels) where proposals are ranked.
    pub fn measure(&self, pyramids: &PyramidPair, f: &FundamentalMatrix) -> Option<PatchSupport> {
        let fine = self.fine(pyramids);
        Some(fine.support.measure(&f.rescaled(fine.scales[0], fine.scales[1])?))
    }

    /// Support where proposals are ranked: of corners, and of features where there are some.
    pub fn fine(&self, pyramids: &PyramidPair) -> &SupportLevel {
        let corners = &self.corners;
        let fine = corners.fine.get_or_make(|| corners.fine(pyramids));
        if self.features.is_empty() {
            return fine;
        }
        self.with_features.get_or_make(|| {
            let at_level = |m: &FeatureSupport| SupportingMatch {
                pair: m.pair.rescaled(fine.scales),
                correlation: m.correlation,
            };
            let features = self.features.iter().map(at_level).collect();
            SupportLevel { support: fine.support.clone().with_features(features), ..*fine }
        })
    }

    /// The levels that `F` is refined at, coarsest first, none twice.
    fn refinement<'a>(&'a self, pyramids: &'a PyramidPair) -> Vec<(PairLevel<'a>, &'a RefinementLevel)> {
        let level = |side: &f64| pyramids.level_seen(*side, self.view());
        let mut levels: Vec<_> = REFINEMENT_SIDES.iter().map(level).zip(&self.corners.refinement).collect();
        levels.dedup_by_key(|(level, _)| level.scales);
        levels
    }

    /// Finds the corners that refinement needs.
    pub fn prepare_refinement(&self, pyramids: &PyramidPair) {
        for (level, stage) in self.refinement(pyramids) {
            stage.prepare(&level, self.view());
        }
    }

    /// Refines `f` level by level up to full size; `None` when there are too few matches at the first, or when stopped.
    pub fn refine(
        &self,
        pyramids: &PyramidPair,
        f: &FundamentalMatrix,
        clicks: &[PointPair],
        click_sigma: f64,
        cancel: &CancelFlag,
    ) -> Option<Refined> {
        let clicks: Vec<Observation> =
            clicks.iter().map(|pair| Observation { pair: *pair, sigma: click_sigma }).collect();
        let mut refined: Option<Refined> = None;
        for ((level, stage), aligned) in self.refinement(pyramids).into_iter().zip(&self.aligned) {
            let start = refined.as_ref().map_or(*f, |r| r.fundamental);
            match stage.refine(&level, self.view(), aligned, &start, &clicks, cancel) {
                Some(result) => refined = Some(result),
                None => break,
            }
        }
        refined
    }

    /// Fits the geometry to the matches along its lines at full size, by their own noise, and compares it with the
    /// geometries that fewer but more precise matches agree on. `None` when too few matches determine it.
    pub fn settle(
        &self,
        pyramids: &PyramidPair,
        start: &FundamentalMatrix,
        settling: &Settling,
        cancel: &CancelFlag,
    ) -> Option<Refined> {
        let (level, stage) = self.refinement(pyramids).pop()?;
        let features = &self.aligned[self.refinement(pyramids).len() - 1];
        let matcher = GuidedMatcher { stage, level: &level, view: self.view(), features };
        matcher.settled(start, settling, cancel)
    }

    /// Matches within `reach` (a fraction of the longer side) of where a homography of full-size pixels maps them, found
    /// at full size without any epipolar geometry; full-size pixels.
    pub fn matches_near_plane(&self, pyramids: &PyramidPair, h: &Matrix3<f64>, reach: f64) -> Vec<PointPair> {
        let Some((level, stage)) = self.refinement(pyramids).pop() else { return Vec::new() };
        let Some(h) = resized(h, level.scales) else { return Vec::new() };
        let radius = reach * level.planes[0].frame().longer_side();
        let full_size = level.scales.map(f64::recip);
        let found = stage.matches_near_plane(&level, self.view(), &h, radius);
        found.into_iter().map(|m| m.pair.rescaled(full_size)).collect()
    }
}

/// The homography of images of other sizes.
pub(in crate::estimate) fn resized(h: &Matrix3<f64>, scales: [f64; 2]) -> Option<Matrix3<f64>> {
    let [first, second] = scales.map(rescaling);
    Some(second * h * first.try_inverse()?)
}

impl CornerLevels {
    fn coarse(&self, pyramids: &PyramidPair) -> SupportLevel {
        let level = pyramids.level_seen(COARSE_SIDE, self.view);
        let warps = warps_around(&level.warp(self.view));
        let patches = CornerPatches::new(&level, COARSE_CORNERS, warps);
        SupportLevel { scales: level.scales, support: Support::new(&patches) }
    }

    fn fine(&self, pyramids: &PyramidPair) -> SupportLevel {
        let level = pyramids.level_seen(FINE_SIDE, self.view);
        let patches = self.patches.get(&level, self.view);
        SupportLevel { scales: level.scales, support: Support::new(&patches) }
    }
}
