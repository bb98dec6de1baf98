//! How the two images are turned and scaled against each other, from the features that a geometry explains.

use super::prepared::MatchedFeatures;
use crate::geometry::{Frame, FundamentalMatrix, sampson_distance};
use crate::image::RelativeView;

/// A feature within this distance of its line is explained, as a fraction of the longer side: what a geometry that is
/// not refined yet leaves open.
const EXPLAINED: f64 = 0.005;
/// Fewer explained features than this say nothing.
const LEAST: usize = 8;
/// Turns and scales nearer than this to a view are covered by it: patches are compared under turns by 20° and scales of
/// 4/3 either way.
const SAME_TURN: f64 = 0.26;
const SAME_SCALE: f64 = 1.25;

/// The view under which the features that `f` explains look alike: medians of their turns and scales; `None` when it
/// explains too few.
pub(super) fn view_of(
    f: &FundamentalMatrix,
    features: &MatchedFeatures,
    frames: [Frame; 2],
) -> Option<RelativeView> {
    let near = EXPLAINED * frames[0].longer_side();
    let explained: Vec<(f64, f64)> = features
        .matches
        .iter()
        .filter(|m| sampson_distance(f, &m.pair) < near)
        .map(|m| {
            let (a, b) = (features.sets[0].features()[m.feature1], features.sets[1].features()[m.feature2]);
            (b.orientation - a.orientation, (b.scale / a.scale).ln())
        })
        .collect();
    if explained.len() < LEAST {
        return None;
    }
    // The turn that most others are near, then the median of those near it: angles have no order.
    let apart = |a: f64, b: f64| (a - b).sin().atan2((a - b).cos());
    let near_to =
        |turn: f64| explained.iter().filter(move |(other, _)| apart(*other, turn).abs() < SAME_TURN);
    let (mode, _) = explained.iter().max_by_key(|(turn, _)| near_to(*turn).count())?;
    let mut turns: Vec<f64> = near_to(*mode).map(|(turn, _)| apart(*turn, *mode)).collect();
    let mut scales: Vec<f64> = near_to(*mode).map(|(_, scale)| *scale).collect();
    turns.sort_by(f64::total_cmp);
    scales.sort_by(f64::total_cmp);
    let (turn, scale) = (mode + turns[turns.len() / 2], scales[scales.len() / 2].exp());
    let like_sizes = frames[1].longer_side() / frames[0].longer_side();
    let view = RelativeView { scale: Some(scale), rotation: apart(turn, 0.0) };
    let upright = RelativeView { scale: Some(like_sizes), rotation: 0.0 };
    Some(if is_same(&view, &upright) { RelativeView::UPRIGHT } else { view })
}

/// Whether patches compared under one view are compared well under the other.
pub(super) fn is_same(a: &RelativeView, b: &RelativeView) -> bool {
    let turn = (a.rotation - b.rotation).sin().atan2((a.rotation - b.rotation).cos()).abs();
    let scale = match (a.scale, b.scale) {
        (Some(a), Some(b)) => (a / b).max(b / a),
        (None, None) => 1.0,
        _ => f64::INFINITY,
    };
    turn < SAME_TURN && scale < SAME_SCALE
}
