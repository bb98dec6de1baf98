//! Relative rotation and scale of two images, from the surroundings of clicked pairs.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::alignment::Aligner;
use crate::estimate::PreparedPair;
use crate::geometry::{PointPair, rescaled};
use crate::image::{Placement, RelativeView};

/// Number of rotations tried.
const TURNS: usize = 36;
/// Number of scales tried on either side of equal sizes: up to a quarter and four times.
const SCALES: i32 = 6;
const SCALE_STEP: f64 = 1.26;
/// Longer sides of the compared images, px.
const SIDES: [f64; 2] = [145.0, 290.0];
/// Minimum correlation of the surroundings under a view, mean of all pairs and sizes.
const LEAST_CORRELATION: f64 = 0.6;
/// Minimum advantage in correlation over the upright view.
const ADVANTAGE: f64 = 0.15;

/// Returns the view under which the surroundings of the paired points correlate best; `None` if the
/// correlation is low. The view is upright unless another view is clearly better. Takes a few
/// milliseconds.
pub fn view_at(prepared: &PreparedPair, pairs: &[PointPair]) -> Option<RelativeView> {
    let [frame1, frame2] = prepared.frames();
    let like_sizes = frame2.longer_side() / frame1.longer_side();
    let scales = (-SCALES..=SCALES).map(|k| like_sizes * SCALE_STEP.powi(k));
    let views: Vec<RelativeView> = scales
        .flat_map(|scale| {
            let turn = |k: usize| TAU * k as f64 / TURNS as f64;
            (0..TURNS).map(move |k| RelativeView { scale: Some(scale), rotation: turn(k) })
        })
        .collect();
    let scored: Vec<f64> = views.par_iter().map(|view| likeness(prepared, pairs, *view)).collect();
    let best = (0..views.len()).max_by(|a, b| scored[*a].total_cmp(&scored[*b]).then(b.cmp(a)))?;
    let upright = likeness(prepared, pairs, RelativeView::UPRIGHT);
    if scored[best].max(upright) < LEAST_CORRELATION {
        return None;
    }
    Some(if scored[best] > upright + ADVANTAGE { views[best] } else { RelativeView::UPRIGHT })
}

/// Returns the correlation of the surroundings under a view, mean of all pairs and sizes.
fn likeness(prepared: &PreparedPair, pairs: &[PointPair], view: RelativeView) -> f64 {
    let correlations = SIDES.iter().flat_map(|side| {
        let level = prepared.pyramids().level_seen(*side, view);
        let affine = level.warp(view);
        pairs.iter().map(move |pair| {
            let [from, to] = level.planes;
            let aligner = Aligner { from, to, at: rescaled(pair.point1, level.scales[0]) };
            aligner.correlation(&Placement { at: rescaled(pair.point2, level.scales[1]), affine })
        })
    });
    let (sum, count) = correlations.fold((0.0, 0.0), |(sum, count), c| (sum + c, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}
