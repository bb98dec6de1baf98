//! Matches found in the whole of image 2, without any geometry. They alone testify for a geometry:
//! matches found along its lines agree with it by construction.

use rayon::prelude::*;

use super::aligned_features::AlignedFeatures;
use super::level_corners::{CORRELATION_NOISE, ELSEWHERE};
use super::look_alikes::Putative;
use super::support::{Support, SupportLevel};
use crate::geometry::PointPair;
use crate::image::{Alignment, PairLevel, Placement, RelativeView, align};

/// A match found without a geometry and aligned at full size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct UnguidedMatch {
    /// The matched points, full-size pixels.
    pub pair: PointPair,
    /// Probability that this is the right match among similar places.
    pub prior: f32,
}

/// Least probability of a likely match: it is likelier than all similar places together.
const LIKELY: f32 = 0.5;

impl UnguidedMatch {
    /// Returns whether this is more likely the right match than not, among similar places.
    pub fn is_likely(&self) -> bool {
        self.prior > LIKELY
    }
}

/// Returns the mutual best matches of corners and of features, aligned at `level`, the full size.
pub(super) fn unguided_matches(
    fine: &SupportLevel,
    level: &PairLevel,
    view: RelativeView,
    features: &AlignedFeatures,
) -> Vec<UnguidedMatch> {
    let to_level = [0, 1].map(|image| level.scales[image] / fine.scales[image]);
    let full_size = level.scales.map(f64::recip);
    let affine = level.warp(view);
    let best = best_look_alikes(&fine.support);
    let corners = best.into_par_iter().filter_map(|(pair, prior)| {
        let pair = pair.rescaled(to_level);
        let start = Placement { at: pair.point2, affine };
        let at = align(level.planes, pair.point1, start, &Alignment::STRICT)?.at;
        Some(UnguidedMatch { pair: PointPair { point2: at, ..pair }.rescaled(full_size), prior })
    });
    let mut found: Vec<UnguidedMatch> = corners.collect();
    found.extend(
        features
            .all(level)
            .into_iter()
            .map(|m| UnguidedMatch { pair: m.found.pair.rescaled(full_size), prior: m.prior }),
    );
    found
}

/// Returns the corners that are each other's best look-alike, each with the probability that it is
/// the right one among its look-alikes.
fn best_look_alikes(support: &Support) -> Vec<(PointPair, f32)> {
    let with_prior = |group: &[Putative]| {
        let best = support.pair(&group[0]);
        let others: f32 = group[1..]
            .iter()
            .filter(|m| (support.pair(m).point2 - best.point2).norm() > ELSEWHERE)
            .map(|m| ((m.correlation - group[0].correlation) / CORRELATION_NOISE).exp())
            .sum();
        (best, 1.0 / (1.0 + others))
    };
    support.mutual_best().map(with_prior).collect()
}

#[cfg(test)]
mod tests {
    use super::super::levels::PatchLevels;
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::geometry::Vector;
    use crate::image::{GrayPlane, PyramidPair};

    #[test]
    fn matches_are_found_and_aligned_without_a_geometry() {
        let scene = ExactScene::aside();
        let [plane1, plane2] = scene.planes();
        let pyramids = PyramidPair::new(&plane1, &plane2, 48.0);
        let levels = PatchLevels::new(RelativeView::UPRIGHT);
        let found = levels.unguided(&pyramids);
        let off = |m: &UnguidedMatch| -> Vector { scene.partner(m.pair.point1) - m.pair.point2 };
        let likely: Vec<&UnguidedMatch> = found.iter().filter(|m| m.is_likely()).collect();
        let right = likely.iter().filter(|m| off(m).norm() < 0.3).count();
        assert!(likely.len() > 25 && 10 * right > 9 * likely.len(), "{right} of {}", likely.len());
    }

    #[test]
    fn corners_match_a_mirror_image_when_it_is_flipped() {
        let [plane, other] = ExactScene::aside().planes();
        let frame = plane.frame();
        let flipped = GrayPlane::from_fn(frame, |x, y| plane.values()[y * frame.width + frame.width - 1 - x]);
        let count = |second: &GrayPlane| {
            let pyramids = PyramidPair::new(&plane, second, 48.0);
            PatchLevels::new(RelativeView::UPRIGHT).mirrored(&pyramids)
        };
        let [[mirrored, corners], [upright, _]] = [count(&flipped), count(&other)];
        assert!(5 * mirrored > corners, "{mirrored} of {corners}");
        assert!(50 * upright < corners, "{upright} of {corners}");
    }
}
