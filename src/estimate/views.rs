//! How the two images are turned and scaled against each other, from the features that a geometry explains.

use super::PreparedPair;
use super::prepared::MatchedFeatures;
use crate::features::FeatureMatch;
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
    let explained = features.matches.iter().filter(|m| sampson_distance(f, &m.pair) < near);
    view_shared(&relations(features, explained), 0.0, frames)
}

/// How features are turned against their matches, and the logarithm of how much larger they are there.
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

/// The view that most features have, if at least a part of them has it.
fn view_shared(relations: &[(f64, f64)], agreeing: f64, frames: [Frame; 2]) -> Option<RelativeView> {
    if relations.len() < LEAST {
        return None;
    }
    // The turn that most others are near, then the median of those near it: angles have no order.
    let apart = |a: f64, b: f64| (a - b).sin().atan2((a - b).cos());
    let near_to =
        |turn: f64| relations.iter().filter(move |(other, _)| apart(*other, turn).abs() < SAME_TURN);
    let (mode, _) = relations.iter().max_by_key(|(turn, _)| near_to(*turn).count())?;
    if (near_to(*mode).count() as f64) < agreeing * relations.len() as f64 {
        return None;
    }
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

/// Features that are this much nearer to their match than to the next best are counted where there is no geometry.
const DISTINCTIVE: f64 = 0.85;
/// Smallest part of them that has to agree on a view.
const AGREEING: f64 = 0.25;

impl PreparedPair {
    /// How the images are turned and scaled against each other by the features that a geometry explains, or without one
    /// by those that many others agree with; `None` when there are too few. Finds the features the first time, which
    /// takes some tenths of a second.
    pub fn view_of_features(&self, fundamental: Option<&FundamentalMatrix>) -> Option<RelativeView> {
        let features = self.features();
        if let Some(f) = fundamental {
            return view_of(f, features, self.frames());
        }
        let distinctive = features.matches.iter().filter(|m| m.ratio < DISTINCTIVE);
        view_shared(&relations(features, distinctive), AGREEING, self.frames())
    }
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
