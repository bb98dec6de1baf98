//! Relative rotation and scale of the two images, from the features that a geometry explains.

use std::f64::consts::TAU;

use crate::estimate::PreparedPair;
use crate::estimate::evidence::features::MatchedFeatures;
use crate::features::{FeatureMatch, FeatureViews};
use crate::geometry::{Frame, FundamentalMatrix, PointPair, median, sampson_distance, wrapped};
use crate::image::RelativeView;

/// Distance from its line within which a feature is explained, as a share of the longer side: 4 px
/// in 800. The geometry need not be refined yet.
const EXPLAINED: f64 = 0.005;
/// Fewest explained features that determine a view: one more than the seven that any geometry
/// explains.
const LEAST: usize = 8;
/// Difference of rotations covered by one view, radians: patches are compared under rotations by
/// 20° either way.
const SAME_TURN: f64 = 0.26;
/// Ratio of scales covered by one view: patches are compared under scales of 4/3 either way.
const SAME_SCALE: f64 = 1.25;

/// Returns the view under which the features that `f` explains look alike: medians of their
/// rotations and scales. Returns `None` when `f` explains too few.
pub(in crate::estimate) fn view_of(
    f: &FundamentalMatrix,
    features: &MatchedFeatures,
    frames: [Frame; 2],
) -> Option<RelativeView> {
    let near = EXPLAINED * frames[0].longer_side();
    let explained = features.matches.iter().filter(|m| sampson_distance(f, &m.pair) < near);
    view_shared(&relations(features, explained), 0.0, frames)
}

/// Returns the view under which matches without orientation and scale look alike: from the
/// differences between neighbouring matches of the list.
pub(in crate::estimate) fn view_of_pairs(pairs: &[PointPair], frames: [Frame; 2]) -> Option<RelativeView> {
    let step = (pairs.len() / 2).max(1);
    let relation = |(a, b): (&PointPair, &PointPair)| {
        let [in1, in2] = [b.point1 - a.point1, b.point2 - a.point2];
        let turn = in2.y.atan2(in2.x) - in1.y.atan2(in1.x);
        let scale = (in2.norm() / in1.norm()).ln();
        (turn.is_finite() && scale.is_finite()).then_some((turn, scale))
    };
    let relations: Vec<(f64, f64)> = pairs.iter().zip(pairs.iter().skip(step)).filter_map(relation).collect();
    view_shared(&relations, 0.0, frames)
}

/// Returns the rotation from each feature to its match, and the logarithm of the ratio of scales.
fn relations<'a>(
    features: &MatchedFeatures,
    matches: impl Iterator<Item = &'a FeatureMatch>,
) -> Vec<(f64, f64)> {
    let relation = |m: &FeatureMatch| {
        let (a, b) = (features.sets[0].features()[m.feature1], features.sets[1].features()[m.feature2]);
        (b.orientation - a.orientation, (b.scale / a.scale).ln())
    };
    matches.map(relation).collect()
}

/// Returns the view shared by most features, if at least a fraction `agreeing` shares it.
fn view_shared(relations: &[(f64, f64)], agreeing: f64, frames: [Frame; 2]) -> Option<RelativeView> {
    if relations.len() < LEAST {
        return None;
    }
    // The mode, then the median around it: angles have no order.
    let apart = |a: f64, b: f64| wrapped(a - b);
    let near_to =
        |turn: f64| relations.iter().filter(move |(other, _)| apart(*other, turn).abs() < SAME_TURN);
    let counts = numbers_of_near(relations.iter().map(|(turn, _)| wrapped(*turn)));
    let (number, (mode, _)) = counts.into_iter().zip(relations).max_by_key(|(number, _)| *number)?;
    if (number as f64) < agreeing * relations.len() as f64 {
        return None;
    }
    let turn = mode + median(near_to(*mode).map(|(turn, _)| apart(*turn, *mode)));
    let scale = median(near_to(*mode).map(|(_, scale)| *scale)).exp();
    let like_sizes = frames[1].longer_side() / frames[0].longer_side();
    let view = RelativeView { scale: Some(scale), rotation: apart(turn, 0.0) };
    let upright = RelativeView { scale: Some(like_sizes), rotation: 0.0 };
    Some(if is_same_view(&view, &upright) { RelativeView::UPRIGHT } else { view })
}

/// Returns for each angle the number of angles within [`SAME_TURN`] of it, its own included. Angles are wrapped.
fn numbers_of_near(angles: impl Iterator<Item = f64> + Clone) -> Vec<usize> {
    let mut sorted: Vec<f64> = angles.clone().collect();
    sorted.sort_by(f64::total_cmp);
    let count = sorted.len();
    // Once more after a whole turn on either side: an angle near half a turn has neighbours there.
    let around: Vec<f64> =
        [-TAU, 0.0, TAU].iter().flat_map(|turn| sorted.iter().map(move |angle| angle + turn)).collect();
    let near = |angle: f64| {
        let [first, end] =
            [-SAME_TURN, SAME_TURN].map(|by| around.partition_point(|other| other - angle < by));
        (end - first).min(count)
    };
    angles.map(near).collect()
}

/// Ratio of best to second-best distance below which a feature votes for a view when no geometry is
/// known. It is looser than the usual 0.8, since only the most frequent view counts.
const DISTINCTIVE: f64 = 0.85;
/// Smallest share of the voting features that must agree on a view: more than twice the 11 % that
/// one view would get of arbitrary rotations.
const AGREEING: f64 = 0.25;

impl PreparedPair {
    /// Returns the relative view of the images, from the features that a geometry explains. Without
    /// a geometry, from the distinctive features that agree with many others. Returns `None` when
    /// there are too few. The first call finds the features, which takes some tenths of a second.
    pub fn view_of_features(&self, fundamental: Option<&FundamentalMatrix>) -> Option<RelativeView> {
        let features = self.features(FeatureViews::Frontal);
        if let Some(f) = fundamental {
            return view_of(f, features, self.frames());
        }
        let distinctive = features.matches.iter().filter(|m| m.ratio < DISTINCTIVE);
        view_shared(&relations(features, distinctive), AGREEING, self.frames())
    }
}

/// Returns whether patches compared under one view cover the other view.
pub(in crate::estimate) fn is_same_view(a: &RelativeView, b: &RelativeView) -> bool {
    let turn = wrapped(a.rotation - b.rotation).abs();
    let scale = match (a.scale, b.scale) {
        (Some(a), Some(b)) => (a / b).max(b / a),
        (None, None) => 1.0,
        _ => f64::INFINITY,
    };
    turn < SAME_TURN && scale < SAME_SCALE
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const FRAMES: [Frame; 2] = [Frame { width: 400, height: 300 }, Frame { width: 800, height: 600 }];

    #[test]
    fn the_view_of_most_features_wins_across_the_wrap_of_angles() {
        // Half a turn to the left is half a turn to the right.
        let mut relations: Vec<(f64, f64)> =
            (0..9).map(|k| (if k % 2 == 0 { PI - 0.01 } else { 0.01 - PI }, 3f64.ln())).collect();
        // More features than have either sign alone.
        relations.extend([(1.0, 0.1); 6]);
        let view = view_shared(&relations, 0.0, FRAMES).unwrap();
        assert!(view.rotation.abs() > PI - 0.011, "{view:?}");
        assert!((view.scale.unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(view_shared(&relations[..LEAST - 1], 0.0, FRAMES), None);
        assert!(view_shared(&relations[..LEAST], 0.0, FRAMES).is_some());
    }

    #[test]
    fn too_few_agreeing_features_give_no_view() {
        // Of sixteen rotations, four agree.
        let mut relations: Vec<(f64, f64)> = (0..12).map(|k| (0.4 * f64::from(k) - 1.0, 0.0)).collect();
        relations.extend([(-2.0, 0.5); 4]);
        assert!((view_shared(&relations, 0.25, FRAMES).unwrap().rotation + 2.0).abs() < 1e-12);
        assert_eq!(view_shared(&relations, 0.26, FRAMES), None);
    }

    #[test]
    fn images_that_differ_only_in_size_are_upright() {
        let of = |turn: f64, scale: f64| view_shared(&[(turn, scale.ln()); 10], 0.0, FRAMES).unwrap();
        assert_eq!(of(0.0, 2.0), RelativeView::UPRIGHT);
        assert_eq!(of(SAME_TURN - 0.01, 2.0 * (SAME_SCALE - 0.01)), RelativeView::UPRIGHT);
        assert_eq!(of(SAME_TURN + 0.01, 2.0).scale, Some(2.0));
        // Features of equal size in both images: half the share of the second image.
        assert!((of(0.0, 1.0).scale.unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn views_are_the_same_within_the_warps_of_patches() {
        let view = |scale: f64, rotation: f64| RelativeView { scale: Some(scale), rotation };
        assert!(is_same_view(&view(1.0, PI - 0.1), &view(1.24, 0.1 - PI)));
        assert!(is_same_view(&view(1.24, 0.0), &view(1.0, 0.25)));
        assert!(
            !is_same_view(&view(1.0, 0.0), &view(1.26, 0.0))
                && !is_same_view(&view(1.26, 0.0), &view(1.0, 0.0))
        );
        assert!(!is_same_view(&view(1.0, 0.0), &view(1.0, 0.27)));
        assert!(is_same_view(&RelativeView::UPRIGHT, &RelativeView::UPRIGHT));
        assert!(
            !is_same_view(&RelativeView::UPRIGHT, &view(1.0, 0.0)),
            "a scale in proportion differs from any number"
        );
    }
}
