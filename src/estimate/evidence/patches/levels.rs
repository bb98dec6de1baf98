//! Corners, correlations and votes, which are computed once for an image pair and serve any clicks.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Matrix2, Matrix3, Vector2};

use super::aligned_features::AlignedFeatures;
use super::corner_patches::CornerPatches;
use super::feature_support::FeatureSupport;
use super::guided_fit::Settling;
use super::matches::RefinedMatch;
use super::refinement::{LevelMatcher, Refined, RefinementLevel, SharedPatches};
use super::support::{PatchSupport, Support, SupportLevel};
use super::unguided::{
    MutualBest, UnguidedMatch, distinctive_matches, lead_over, matched_corners, mutual_best, unguided_matches,
};
use super::voting::KappaVoting;
use crate::cancel::CancelFlag;
use crate::estimate::evidence::lazy::Lazy;
use crate::estimate::fit::largest_plane;
use crate::features::FeatureViews;
use crate::geometry::{Frame, FundamentalMatrix, Observation, Point, PointPair, rescaling};
use crate::image::{PyramidPair, RelativeView, warps_around};

/// Longer side of the images at which patches first rank hypotheses, px. In a smaller image a patch
/// covers more of the scene, but errors of a pixel are larger.
const COARSE_SIDE: f64 = 384.0;
/// Number of corners of each image at the coarse size. Each corner is compared with all corners of
/// the other image, so twice as many take four times as long.
const COARSE_CORNERS: usize = 600;
/// Longer side of the images at which hypotheses are ranked again, px: an octave above the coarse
/// size.
const FINE_SIDE: f64 = 2.0 * COARSE_SIDE;
/// Number of look-alikes of a corner that vote for κ, best first. The right one is not always the
/// first; each more adds wrong votes.
const VOTES_PER_CORNER: usize = 3;
/// Largest distance of a match from the homography of a mirror image, px of the coarse level: twice
/// the precision of corners.
const ONE_MIRROR: f64 = 4.0;
/// Longer sides of the levels at which `F` is refined, px. At the first level, a ranked geometry is
/// off by a few pixels at most. The last level is full size.
const REFINEMENT_SIDES: [f64; 2] = [800.0, f64::INFINITY];

/// Patches of an image pair under a view, at all sizes. Each level is made when it is first needed.
#[derive(Debug)]
pub(in crate::estimate) struct PatchLevels {
    corners: Arc<CornerLevels>,
    /// Matches of covariant features that support beside corners, and the kind of these features.
    features: Arc<[FeatureSupport]>,
    of: Option<FeatureViews>,
    /// The same matches at the levels of the refinement.
    aligned: [AlignedFeatures; REFINEMENT_SIDES.len()],
    /// Support of corners and features at the fine size, where proposals are ranked.
    with_features: Lazy<SupportLevel>,
    /// Matches found without a geometry.
    unguided: Lazy<Vec<UnguidedMatch>>,
    /// Matches found without a geometry that no other place resembles.
    distinctive: Lazy<Vec<PointPair>>,
}

/// Distinctive matches of corners with an image and with its mirror image.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
#[cfg_attr(test, derive(serde::Deserialize))]
pub(in crate::estimate) struct MirrorMatches {
    /// Number of matches with the mirror image of image 2 that one homography explains.
    pub flipped: usize,
    /// Number of all matches with the mirror image.
    pub all_flipped: usize,
    /// Number of matches with image 2 as it is that one homography explains.
    pub upright: usize,
    /// Number of corners of image 1 that were compared.
    pub corners: usize,
    /// Probability that a match that lies anywhere follows a homography.
    pub by_chance: f64,
}

/// Corners under a view, shared by levels with and without features.
#[derive(Debug)]
struct CornerLevels {
    pyramids: Arc<PyramidPair>,
    view: RelativeView,
    coarse: Lazy<SupportLevel>,
    voting: Lazy<KappaVoting>,
    /// Corners of the finer levels. In a small picture these levels are the same.
    patches: SharedPatches,
    fine: Lazy<SupportLevel>,
    refinement: [RefinementLevel; REFINEMENT_SIDES.len()],
    mirrored: Lazy<MirrorMatches>,
    mutual_best: Lazy<Vec<MutualBest>>,
}

impl PatchLevels {
    /// Returns levels that are not yet made.
    pub fn new(pyramids: &Arc<PyramidPair>, view: RelativeView) -> Self {
        let patches = SharedPatches::default();
        let corners = CornerLevels {
            pyramids: Arc::clone(pyramids),
            view,
            coarse: Lazy::default(),
            voting: Lazy::default(),
            fine: Lazy::default(),
            refinement: REFINEMENT_SIDES.map(|_| RefinementLevel::on(&patches)),
            mirrored: Lazy::default(),
            mutual_best: Lazy::default(),
            patches,
        };
        Self {
            corners: Arc::new(corners),
            features: Arc::default(),
            of: None,
            aligned: Default::default(),
            with_features: Lazy::default(),
            unguided: Lazy::default(),
            distinctive: Lazy::default(),
        }
    }

    /// Returns levels with the same corners and these matches of features, full-size pixels.
    pub fn with_features(&self, of: FeatureViews, features: Vec<FeatureSupport>) -> Self {
        let features: Arc<[FeatureSupport]> = features.into();
        Self {
            corners: Arc::clone(&self.corners),
            of: Some(of),
            aligned: REFINEMENT_SIDES.map(|_| AlignedFeatures::new(Arc::clone(&features))),
            with_features: Lazy::default(),
            unguided: Lazy::default(),
            distinctive: Lazy::default(),
            features,
        }
    }

    pub fn view(&self) -> RelativeView {
        self.corners.view
    }

    /// Returns the kind of covariant features that support beside corners.
    pub fn features(&self) -> Option<FeatureViews> {
        self.of
    }

    /// Returns the support at the coarse size, where proposals are made: of corners alone.
    pub fn coarse(&self) -> &SupportLevel {
        let corners = &self.corners;
        corners.coarse.get_or_make(|| corners.coarse())
    }

    /// Returns the distinctive matches with image 2 and with its mirror image, at the coarse size.
    pub fn mirrored(&self) -> MirrorMatches {
        *self.corners.mirrored.get_or_make(|| self.corners.mirrored())
    }

    /// Returns the corner pairs of the coarse level that vote for κ.
    pub fn voting(&self) -> &KappaVoting {
        let vote = || KappaVoting::new(&self.coarse().support, VOTES_PER_CORNER);
        self.corners.voting.get_or_make(vote)
    }

    /// Returns the support of a geometry (full-size pixels) at the fine size.
    pub fn measure(&self, f: &FundamentalMatrix) -> Option<PatchSupport> {
        let fine = self.fine();
        Some(fine.support.measure(&f.rescaled(fine.scales)?))
    }

    /// Returns the support at the fine size, where proposals are ranked: of corners, and of
    /// features if there are any.
    pub fn fine(&self) -> &SupportLevel {
        let corners = &self.corners;
        let fine = corners.fine.get_or_make(|| corners.fine());
        if self.features.is_empty() {
            return fine;
        }
        self.with_features.get_or_make(|| {
            let at_level = |m: &FeatureSupport| RefinedMatch {
                pair: m.pair.rescaled(fine.scales),
                correlation: m.correlation,
            };
            let features = self.features.iter().map(at_level).collect();
            SupportLevel { support: fine.support.clone().with_features(features), ..*fine }
        })
    }

    /// Returns the levels at which `F` is refined, coarsest first, each once.
    fn refinement(&self) -> Vec<LevelMatcher<'_>> {
        let CornerLevels { pyramids, view, refinement, .. } = &*self.corners;
        let parts = REFINEMENT_SIDES.iter().zip(refinement).zip(&self.aligned);
        let mut levels: Vec<_> = parts
            .map(|((side, stage), features)| {
                let level = pyramids.level_seen(*side, *view);
                LevelMatcher { stage, level, view: *view, features }
            })
            .collect();
        levels.dedup_by_key(|matcher| matcher.level.scales);
        levels
    }

    /// Finds the corners that refinement needs.
    pub fn prepare_refinement(&self) {
        for matcher in self.refinement() {
            matcher.corners();
        }
    }

    /// Refines `f` level by level up to full size. Returns `None` when the first level has too few
    /// matches, or when stopped.
    pub fn refine(
        &self,
        f: &FundamentalMatrix,
        clicks: &[Observation],
        cancel: &CancelFlag,
    ) -> Option<Refined> {
        let mut refined: Option<Refined> = None;
        for matcher in self.refinement() {
            let start = refined.as_ref().map_or(*f, |r| r.fundamental);
            match matcher.refine(&start, clicks, cancel) {
                Some(result) => {
                    let before = refined.map_or_else(Vec::new, |before| before.steps);
                    refined = Some(result.after(before));
                }
                None => break,
            }
        }
        refined
    }

    /// Fits the geometry to the matches along its lines at full size, weighted by their own noise.
    /// Compares it with geometries on which fewer but more precise matches agree. Returns `None`
    /// when too few matches determine it.
    pub fn settle(
        &self,
        start: &FundamentalMatrix,
        settling: &Settling,
        cancel: &CancelFlag,
    ) -> Option<Refined> {
        self.refinement().pop()?.settled(start, settling, cancel)
    }

    /// Returns a geometry as it is, with the matches along its lines at full size.
    pub fn matched(&self, f: &FundamentalMatrix) -> Option<Refined> {
        self.refinement().pop()?.unchanged(f)
    }

    /// Returns the mutual best matches of corners among the pairs that are `possible`, aligned.
    /// All are in full-size pixels.
    pub fn unguided_corners(&self, possible: impl Fn(&PointPair) -> bool) -> Vec<UnguidedMatch> {
        let full_size = self.refinement().pop();
        full_size.map_or_else(Vec::new, |matcher| matched_corners(self.fine(), &matcher, possible))
    }

    /// Returns the matches found in the whole of image 2, without any geometry.
    pub fn unguided(&self) -> &[UnguidedMatch] {
        self.unguided.get_or_make(|| {
            let full_size = self.refinement().pop();
            full_size.map_or_else(Vec::new, |matcher| unguided_matches(self.mutual_best(&matcher), &matcher))
        })
    }

    /// Returns the matches found in the whole of image 2, without any geometry, that no other place of
    /// either image resembles.
    pub fn distinctive(&self) -> &[PointPair] {
        self.distinctive.get_or_make(|| {
            let full_size = self.refinement().pop();
            full_size
                .map_or_else(Vec::new, |matcher| distinctive_matches(self.mutual_best(&matcher), &matcher))
        })
    }

    /// Returns the log-odds of a match against another place in image 2, as [`lead_over`] does. Matches are precise to
    /// about a pixel of the first level.
    pub fn lead_over(&self, pair: &PointPair, other2: Point) -> Option<f32> {
        lead_over(pair, other2, self.refinement().first()?)
    }

    /// Returns the mutual best matches of corners, aligned at full size. Features change none of them.
    fn mutual_best(&self, full_size: &LevelMatcher) -> &[MutualBest] {
        self.corners.mutual_best.get_or_make(|| mutual_best(self.fine(), full_size))
    }
}

/// Returns the homography for images of other sizes.
pub(in crate::estimate) fn resized(h: &Matrix3<f64>, scales: [f64; 2]) -> Option<Matrix3<f64>> {
    let [first, second] = scales.map(rescaling);
    Some(second * h * first.try_inverse()?)
}

impl CornerLevels {
    fn coarse(&self) -> SupportLevel {
        let level = self.pyramids.level_seen(COARSE_SIDE, self.view);
        let warps = warps_around(&level.warp(self.view));
        let patches = CornerPatches::new(&level, COARSE_CORNERS, warps);
        SupportLevel { scales: level.scales, support: Support::new(&patches) }
    }

    fn mirrored(&self) -> MirrorMatches {
        let level = self.pyramids.level_seen(COARSE_SIDE, self.view);
        // Left and right exchanged, or top and bottom.
        let flips = [Vector2::new(-1.0, 1.0), Vector2::new(1.0, -1.0)];
        let warps = flips.map(|flip| level.warp(self.view) * Matrix2::from_diagonal(&flip));
        let patches = CornerPatches::new(&level, COARSE_CORNERS, warps.to_vec());
        let coarse = self.coarse.get_or_make(|| self.coarse());
        let (flipped, upright) = (Support::new(&patches).distinctive(), coarse.support.distinctive());
        let on_a_plane =
            |found: &[PointPair]| largest_plane(found, ONE_MIRROR, 0).map_or(0, |(_, most)| most);
        let Frame { width, height } = level.planes[1].frame();
        MirrorMatches {
            flipped: on_a_plane(&flipped),
            all_flipped: flipped.len(),
            upright: on_a_plane(&upright),
            corners: patches.points1.len(),
            by_chance: PI * ONE_MIRROR.powi(2) / (width * height) as f64,
        }
    }

    fn fine(&self) -> SupportLevel {
        let level = self.pyramids.level_seen(FINE_SIDE, self.view);
        let patches = self.patches.get(&level, self.view);
        SupportLevel { scales: level.scales, support: Support::new(&patches) }
    }
}
