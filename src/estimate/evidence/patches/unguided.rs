//! Matches found without epipolar lines: in the whole of image 2, or wherever else a match is
//! possible. Only these matches are evidence for a geometry: matches found along its lines agree
//! with it by construction.

use rayon::prelude::*;

use super::level_corners::{CORRELATION_NOISE, ELSEWHERE};
use super::look_alikes::Putative;
use super::matches::LevelMatch;
use super::refinement::LevelMatcher;
use super::support::{Support, SupportLevel};
use crate::geometry::PointPair;
use crate::image::{Alignment, Placement, align};

/// A match found without a geometry and aligned at full size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct UnguidedMatch {
    /// The matched points, full-size pixels.
    pub pair: PointPair,
    /// Probability that this is the right match among similar places.
    pub prior: f32,
}

/// Least probability of a likely match: it is likelier than all similar places together.
pub(in crate::estimate) const LIKELY: f32 = 0.5;

impl UnguidedMatch {
    /// Returns whether this is more likely the right match than not, among similar places.
    pub fn is_likely(&self) -> bool {
        self.prior > LIKELY
    }
}

/// Returns the mutual best matches of corners and of features, aligned at full size.
pub(super) fn unguided_matches(fine: &SupportLevel, matcher: &LevelMatcher) -> Vec<UnguidedMatch> {
    let full_size = matcher.level.scales.map(f64::recip);
    let at_full_size =
        |m: LevelMatch| UnguidedMatch { pair: m.found.pair.rescaled(full_size), prior: m.prior };
    let mut found = matched_corners(fine, matcher, |_| true);
    found.extend(matcher.features.all(&matcher.level).into_iter().map(at_full_size));
    found
}

/// Returns the mutual best matches of corners among the pairs that are `possible` (full-size
/// pixels), aligned at full size.
pub(super) fn matched_corners(
    fine: &SupportLevel,
    matcher: &LevelMatcher,
    possible: impl Fn(&PointPair) -> bool,
) -> Vec<UnguidedMatch> {
    let LevelMatcher { level, view, .. } = matcher;
    let from_fine = fine.scales.map(f64::recip);
    let full_size = level.scales.map(f64::recip);
    let affine = level.warp(*view);
    let best = fine.support.mutual_best(|pair| possible(&pair.rescaled(from_fine)));
    let aligned = |group: Vec<Putative>| {
        let prior = prior_of_best(&fine.support, &group);
        let pair = fine.support.pair(&group[0]).rescaled(from_fine).rescaled(level.scales);
        let start = Placement { at: pair.point2, affine };
        let at = align(level.planes, pair.point1, start, &Alignment::STRICT)?.at;
        Some(UnguidedMatch { pair: PointPair { point2: at, ..pair }.rescaled(full_size), prior })
    };
    best.into_par_iter().filter_map(aligned).collect()
}

/// Returns the probability that the best of the look-alikes of a corner is the right one.
fn prior_of_best(support: &Support, group: &[Putative]) -> f32 {
    let best = support.pair(&group[0]).point2;
    let others: f32 = group[1..]
        .iter()
        .filter(|m| (support.pair(m).point2 - best).norm() > ELSEWHERE)
        .map(|m| ((m.correlation - group[0].correlation) / CORRELATION_NOISE).exp())
        .sum();
    1.0 / (1.0 + others)
}

#[cfg(test)]
mod tests {
    use super::super::levels::PatchLevels;
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::geometry::Vector;
    use crate::image::{GrayPlane, PyramidPair, RelativeView};

    fn levels(plane1: &GrayPlane, plane2: &GrayPlane) -> PatchLevels {
        let pyramids = PyramidPair::new(plane1, plane2, 48.0);
        PatchLevels::new(&std::sync::Arc::new(pyramids), RelativeView::UPRIGHT)
    }

    #[test]
    fn matches_are_found_and_aligned_without_a_geometry() {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let levels = levels(&plane1, &plane2);
        let found = levels.unguided();
        let off = |m: &UnguidedMatch| -> Vector { scene.partner(m.pair.point1) - m.pair.point2 };
        let likely: Vec<&UnguidedMatch> = found.iter().filter(|m| m.is_likely()).collect();
        let right = likely.iter().filter(|m| off(m).norm() < 0.3).count();
        assert!(likely.len() > 25 && 10 * right > 9 * likely.len(), "{right} of {}", likely.len());
    }

    #[test]
    fn corners_have_fewer_look_alikes_where_their_match_is_possible() {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let levels = levels(&plane1, &plane2);
        let right = |possible: &dyn Fn(&PointPair) -> bool| {
            let found = levels.unguided_corners(possible);
            assert!(found.iter().all(|m| m.prior > 0.0 && m.prior <= 1.0));
            let is_right = |m: &&UnguidedMatch| {
                m.is_likely() && (scene.partner(m.pair.point1) - m.pair.point2).norm() < 0.3
            };
            found.iter().filter(is_right).count()
        };
        let anywhere = right(&|_| true);
        let near = right(&|m| (scene.partner(m.point1) - m.point2).norm() < 16.0);
        assert!(near > anywhere, "{near} near, {anywhere} anywhere");
        assert_eq!(right(&|_| false), 0);
    }

    #[test]
    fn corners_match_a_mirror_image_when_it_is_flipped() {
        let [plane, other] = ExactScene::aside().planes();
        let frame = plane.frame();
        let flipped = GrayPlane::from_fn(frame, |x, y| plane.values()[y * frame.width + frame.width - 1 - x]);
        let [[mirrored, corners], [upright, _]] =
            [&flipped, &other].map(|second| levels(&plane, second).mirrored());
        assert!(5 * mirrored > corners, "{mirrored} of {corners}");
        assert!(50 * upright < corners, "{upright} of {corners}");
    }
}
