//! Matches found without epipolar lines: in the whole of image 2, or wherever else a match is
//! possible. Only these matches are evidence for a geometry: matches found along its lines agree
//! with it by construction.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::feature_support::FLOOR;
use super::level_corners::{CORRELATION_NOISE, ELSEWHERE};
use super::look_alikes::Putative;
use super::matches::LevelMatch;
use super::refinement::LevelMatcher;
use super::support::{Support, SupportLevel};
use crate::geometry::{Point, PointPair};
use crate::image::{Alignment, PatchSampler, Placement, Warp, align, correlation};

/// A match found without a geometry and aligned at full size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::estimate) struct UnguidedMatch {
    /// The matched points, full-size pixels.
    pub pair: PointPair,
    /// Probability that this is the right match among similar places.
    pub prior: f32,
}

/// Least probability of a distinctive match among the similar places of both images. Two descriptors at 0.8
/// times the distance of the next have it; nine of ten wrong matches are above that ratio (Lowe 2004,
/// section 7.1).
const DISTINCTIVE: f32 = 0.71;
/// Least probability of a likely match: it is likelier than all similar places together.
pub(in crate::estimate) const LIKELY: f32 = 0.5;

/// Side of the squares of image 1 in which only one match counts, px. Corners and features find
/// the same place twice.
const SAME_PLACE: f64 = 2.0;

impl UnguidedMatch {
    /// Returns whether this is more likely the right match than not, among similar places.
    pub fn is_likely(&self) -> bool {
        self.prior > LIKELY
    }
}

/// A mutual best match of corners.
#[derive(Debug)]
pub(super) struct MutualBest {
    /// The match as it is aligned at full size. `None` if its surroundings do not fit.
    found: Option<UnguidedMatch>,
    /// Whether no other place of either image resembles it.
    is_distinctive: bool,
}

/// Returns the mutual best matches of corners, aligned at full size.
pub(super) fn mutual_best(fine: &SupportLevel, matcher: &LevelMatcher) -> Vec<MutualBest> {
    let mut of_corner2: HashMap<u32, Vec<Putative>> = HashMap::new();
    for pair in &fine.support.pairs {
        of_corner2.entry(pair.corner2).or_default().push(*pair);
    }
    let from_fine = fine.scales.map(f64::recip);
    let of_group = |group: Vec<Putative>| {
        let best = &group[0];
        let rivals1 = of_corner2.get(&best.corner2).map_or(0.0, |pairs| {
            let place = fine.support.pair(best).point1;
            rivals(pairs, best, |m| (fine.support.pair(m).point1 - place).norm())
        });
        let prior = prior_of_best(&fine.support, &group);
        let pair = aligned(&fine.support.pair(best).rescaled(from_fine), matcher);
        MutualBest {
            found: pair.map(|pair| UnguidedMatch { pair, prior }),
            is_distinctive: prior > DISTINCTIVE && 1.0 / (1.0 + rivals1) > DISTINCTIVE,
        }
    };
    fine.support.mutual_best(|_| true).into_par_iter().map(of_group).collect()
}

/// Returns the matches with a probability above `least`, the first at each place of image 1.
pub(in crate::estimate) fn one_a_place(
    found: &[UnguidedMatch],
    least: f32,
) -> impl Iterator<Item = PointPair> {
    let mut taken = HashSet::new();
    let pairs = found.iter().filter(move |m| m.prior > least).map(|m| m.pair);
    pairs.filter(move |PointPair { point1, .. }| {
        taken.insert([point1.x, point1.y].map(|v| (v / SAME_PLACE).round() as i64))
    })
}

/// Returns the mutual best matches of corners and of features, aligned at full size.
pub(super) fn unguided_matches(corners: &[MutualBest], matcher: &LevelMatcher) -> Vec<UnguidedMatch> {
    let full_size = matcher.level.scales.map(f64::recip);
    let at_full_size =
        |m: LevelMatch| UnguidedMatch { pair: m.found.pair.rescaled(full_size), prior: m.prior };
    let mut found: Vec<UnguidedMatch> = corners.iter().filter_map(|best| best.found).collect();
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
    let from_fine = fine.scales.map(f64::recip);
    let best = fine.support.mutual_best(|pair| possible(&pair.rescaled(from_fine)));
    let found = |group: Vec<Putative>| {
        let pair = aligned(&fine.support.pair(&group[0]).rescaled(from_fine), matcher)?;
        Some(UnguidedMatch { pair, prior: prior_of_best(&fine.support, &group) })
    };
    best.into_par_iter().filter_map(found).collect()
}

/// Returns the mutual best matches that no other place of either image resembles, aligned at full size.
/// Repeated structure, such as the corners of a chessboard, has none.
pub(super) fn distinctive_matches(corners: &[MutualBest], matcher: &LevelMatcher) -> Vec<PointPair> {
    let mut found: Vec<PointPair> =
        corners.iter().filter(|best| best.is_distinctive).filter_map(|best| Some(best.found?.pair)).collect();
    // The ratio of a feature belongs to both images.
    let full_size = matcher.level.scales.map(f64::recip);
    let features = matcher.features.all(&matcher.level).into_iter().filter(|m| m.prior > DISTINCTIVE);
    found.extend(features.map(|m| m.found.pair.rescaled(full_size)));
    found
}

/// Aligns a match of corners. Both are in full-size pixels.
fn aligned(pair: &PointPair, matcher: &LevelMatcher) -> Option<PointPair> {
    let LevelMatcher { level, view, .. } = matcher;
    let pair = pair.rescaled(level.scales);
    let start = Placement { at: pair.point2, affine: level.warp(*view) };
    let at = align(level.planes, pair.point1, start, &Alignment::STRICT)?.at;
    Some(PointPair { point2: at, ..pair }.rescaled(level.scales.map(f64::recip)))
}

/// Returns the log-odds of a match against another place in image 2. Both are in full-size pixels. `None` if the other
/// place does not resemble the point of image 1, or if alignment leads from there back to the match.
pub(super) fn lead_over(pair: &PointPair, other2: Point, matcher: &LevelMatcher) -> Option<f32> {
    let LevelMatcher { level, view, .. } = matcher;
    let places = [pair.point2, other2].map(|point2| PointPair { point2, ..*pair }.rescaled(level.scales));
    let first = PatchSampler::new(level.planes[0], &Warp::identity()).patch(places[0].point1)?;
    let [own, other] = places.map(|PointPair { point1, point2 }| {
        // Along an edge, alignment need not settle.
        let start = Placement { at: point2, affine: level.warp(*view) };
        let Placement { at, affine } =
            align(level.planes, point1, start, &Alignment::STRICT).unwrap_or(start);
        let second = PatchSampler::new(level.planes[1], &affine).patch(at)?;
        Some((at, correlation(&first, &second)))
    });
    let (at, other) = other.filter(|(_, correlation)| *correlation > FLOOR)?;
    let [from_own, from_other] = places.map(|place| (at - place.point2).norm());
    let own = own.map_or(FLOOR, |(_, correlation)| correlation);
    (from_other < from_own).then_some((own - other) / CORRELATION_NOISE)
}

/// Returns the probability that the best of the look-alikes of a corner is the right one.
fn prior_of_best(support: &Support, group: &[Putative]) -> f32 {
    let place = support.pair(&group[0]).point2;
    1.0 / (1.0 + rivals(group, &group[0], |m| (support.pair(m).point2 - place).norm()))
}

/// Returns the odds of all pairs elsewhere together, against the best one. `away` is the distance of a pair
/// from the best one, px.
fn rivals(pairs: &[Putative], best: &Putative, away: impl Fn(&Putative) -> f64) -> f32 {
    let elsewhere = pairs.iter().filter(|m| away(m) > ELSEWHERE);
    elsewhere.map(|m| ((m.correlation - best.correlation) / CORRELATION_NOISE).exp()).sum()
}

#[cfg(test)]
mod tests {
    use super::super::levels::PatchLevels;
    use super::*;
    use crate::estimate::exact::ExactScene;
    use crate::geometry::{Frame, Vector};
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
    fn a_repeated_pattern_has_no_distinctive_matches() {
        // Blocks of random brightness that repeat after `period` px. The second picture is moved by 7 px.
        let found = |period: usize| {
            let block = |x: usize, y: usize| {
                let cell = ((x % period / 5) as u64).wrapping_mul(0x9E37_79B9)
                    ^ ((y % period / 6) as u64).wrapping_mul(0x85EB_CA6B);
                (cell.wrapping_mul(0xC2B2_AE35_85EB_CA77) >> 56) as f32
            };
            let picture = |moved| GrayPlane::from_fn(Frame::new(320, 240), |x, y| block(x + moved, y));
            levels(&picture(0), &picture(7))
        };
        let once = found(1000);
        let once = once.distinctive();
        let right =
            once.iter().filter(|m| (m.point1 - m.point2 - Vector::new(7.0, 0.0)).norm() < 0.3).count();
        assert!(once.len() > 20 && 20 * right > 19 * once.len(), "{right} of {}", once.len());
        let tiles = found(40);
        assert!(tiles.unguided().len() > 20 && tiles.distinctive().is_empty());
    }

    #[test]
    fn a_match_leads_over_places_that_look_less_like_it_and_not_over_equal_ones() {
        // Equal after each 8 px downwards. In image 2, the lower part has something more.
        let pattern = |more: f32| {
            GrayPlane::from_fn(Frame::new(160, 120), |x, y| {
                let wave = |rate: f32, at: usize| (rate * at as f32).sin();
                let more = if y > 76 { more * wave(0.9, x) } else { 0.0 };
                128.0 + 60.0 * wave(0.5, x) + 30.0 * wave(0.25 * std::f32::consts::PI, y) + more
            })
        };
        let levels = levels(&pattern(0.0), &pattern(40.0));
        let own = PointPair::new(80.0, 60.0, 80.0, 60.0);
        let lead =
            |pair: &PointPair, dx: f64, dy: f64| levels.lead_over(pair, Point::new(80.0 + dx, 60.0 + dy));
        let equal = lead(&own, 0.0, 8.0).unwrap();
        assert!(equal.abs() < 0.1, "{equal}");
        let (ahead, behind) =
            (lead(&own, 0.0, 32.0), lead(&PointPair::new(80.0, 60.0, 80.0, 92.0), 0.0, 0.0));
        assert!(ahead.unwrap() > 1.0 && behind.unwrap() < -1.0, "{ahead:?} {behind:?}");
        // Unlike, and the same place.
        assert_eq!([lead(&own, 6.0, 0.0), lead(&own, 0.5, 0.0)], [None; 2]);
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
        let [mirrored, pair] = [&flipped, &other].map(|second| levels(&plane, second).mirrored());
        assert!(
            5 * mirrored.flipped > mirrored.corners && mirrored.flipped > mirrored.upright,
            "{mirrored:?}"
        );
        assert!(50 * pair.flipped < pair.corners && pair.flipped < pair.upright, "{pair:?}");
    }
}
