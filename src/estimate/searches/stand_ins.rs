//! Stand-ins for clicks: two matches that a geometry explains, or two drawn at random.

use rand::RngExt;

use super::features::FeatureProposals;
use crate::estimate::evidence::features::MatchedFeatures;
use crate::estimate::evidence::patches::PatchLevels;
use crate::estimate::evidence::viewed::SearchInput;
use crate::estimate::sampling::{Purpose, stream};
use crate::estimate::{Clicks, PreparedPair};
use crate::geometry::{FundamentalMatrix, PointPair, apart_across_lines, sampson_distance};
use crate::image::RelativeView;

/// Number of matches among which two stand-ins are selected. It bounds the time, since all pairs of
/// matches are compared.
const CHOSEN_FROM: usize = 120;
/// Largest distance of a stand-in from its line, as a share of the longer side. It equals the
/// largest uncertainty of the lines of a reliable result.
const EXPLAINED: f64 = 0.002;
/// Smallest distance between drawn matches, as a share of the longer side. Lines through nearer
/// matches turn a lot if a match is a pixel off.
const APART: f64 = 0.2;
/// Largest number of draws in the search for distant matches. It bounds the time.
const TRIES: usize = 200;
/// Largest ratio of best to second-best distance of a distinctive feature: the limit of Lowe
/// (2004).
const DISTINCTIVE: f64 = 0.8;

/// Returns distinctive matches, found without a geometry: first features, then corners.
pub(super) fn putative_matches(
    prepared: &PreparedPair,
    features: &MatchedFeatures,
    patches: &PatchLevels,
) -> Vec<PointPair> {
    let features = features.matches.iter().filter(|m| m.ratio < DISTINCTIVE).map(|m| m.pair);
    let fine = patches.fine();
    let full_size = fine.scales.map(f64::recip);
    let corners = fine.support.distinctive().into_iter().map(|m| m.rescaled(full_size));
    let frames = prepared.frames();
    features.chain(corners).filter(|pair| pair.is_inside(frames)).collect()
}

/// Returns the clicks, with two matches that the leading proposal explains as stand-ins, unless two clicks are there.
pub(super) fn with_stand_ins(input: SearchInput, proposals: &FeatureProposals) -> Clicks {
    let SearchInput { prepared, clicks, .. } = input;
    let stand_ins = || {
        let leader = proposals.proposals.first()?;
        let view = proposals.views.first().copied().unwrap_or(RelativeView::UPRIGHT);
        let patches = prepared.patches_with_features(view, proposals.of);
        let putative = putative_matches(prepared, prepared.features(proposals.of), &patches);
        farthest_apart(prepared, &leader.proposed.fundamental, &leader.matches, &putative)
    };
    let pair = if clicks.anchors().len() < 2 { stand_ins() } else { None };
    pair.map_or_else(|| clicks.clone(), |pair| clicks.with_chosen(pair))
}

/// Returns the two matches whose epipolar lines are farthest apart, in the image where they are
/// nearer. They are putative matches that the geometry explains, or matches of `own` if it explains
/// few.
pub(super) fn farthest_apart(
    prepared: &PreparedPair,
    f: &FundamentalMatrix,
    own: &[PointPair],
    putative: &[PointPair],
) -> Option<[PointPair; 2]> {
    let frames = prepared.frames();
    let sides = frames.map(|frame| frame.longer_side());
    let near = EXPLAINED * sides[0].max(sides[1]);
    let mut explained: Vec<PointPair> =
        putative.iter().copied().filter(|m| sampson_distance(f, m) < near).collect();
    if explained.len() < own.len().min(CHOSEN_FROM / 2) {
        explained = own.to_vec();
    }
    let step = explained.len().div_ceil(CHOSEN_FROM).max(1);
    let few: Vec<PointPair> = explained.into_iter().step_by(step).collect();
    let apart = |p: &PointPair, q: &PointPair| {
        let [in1, in2] = apart_across_lines(f, p, q);
        (in1 / sides[0]).min(in2 / sides[1])
    };
    let mut best: Option<(f64, [PointPair; 2])> = None;
    for (k, p) in few.iter().enumerate() {
        for q in &few[..k] {
            let distance = apart(p, q);
            if best.is_none_or(|(most, _)| distance > most) {
                best = Some((distance, [*q, *p]));
            }
        }
    }
    best.map(|(_, pairs)| pairs)
}

/// Returns up to `count` random pairs of putative matches that are far from each other in both
/// images.
pub(super) fn drawn_stand_ins(
    prepared: &PreparedPair,
    putative: &[PointPair],
    count: usize,
    seed: u64,
) -> Vec<[PointPair; 2]> {
    let mut random = stream(seed, Purpose::PutativePairs, 0);
    let least = prepared.frames().map(|frame| APART * frame.longer_side());
    let mut drawn = Vec::new();
    if putative.len() < 2 || count == 0 {
        return drawn;
    }
    for _ in 0..TRIES {
        let [p, q] = [(); 2].map(|()| putative[random.random_range(0..putative.len())]);
        let apart = [(p.point1 - q.point1).norm(), (p.point2 - q.point2).norm()];
        if apart[0] > least[0] && apart[1] > least[1] {
            drawn.push([p, q]);
            if drawn.len() == count {
                break;
            }
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::ExactScene;

    #[test]
    fn drawn_matches_are_far_apart() {
        let scene = ExactScene::aside();
        let prepared = scene.prepared();
        let putative = scene.pairs(60);
        let least = prepared.frames().map(|frame| APART * frame.longer_side());
        let pairs = drawn_stand_ins(&prepared, &putative, 4, 5);
        assert_eq!(pairs.len(), 4);
        for [p, q] in &pairs {
            assert!((p.point1 - q.point1).norm() > least[0] && (p.point2 - q.point2).norm() > least[1]);
        }
        assert_eq!(pairs, drawn_stand_ins(&prepared, &putative, 4, 5), "the seed decides");
        assert!(drawn_stand_ins(&prepared, &putative[..1], 4, 5).is_empty());
    }
}
