//! Probability that a match of covariant features is right, before any geometry is known.
//!
//! Three observations contribute, each with its own factor of the odds:
//!
//! - the **ratio** of best to second-best distance;
//! - **local support**: the two frames of a match predict the positions of its neighbours.
//!   Neighbouring matches count if they lie there and have a similar rotation and scale (as in
//!   `AdaLAM`, Cavalli et al. 2020);
//! - **the clicks**, which count like several neighbours.

use multiversion::multiversion;
use nalgebra::Matrix2;
use rayon::prelude::*;

use crate::features::{Feature, FeatureMatch, FeatureSet};
use crate::geometry::{Frame, PointPair, angle_between};
use crate::lanes::{LANES, SetLanes};

/// Radius of the neighbourhood of a match, as a share of the longer side of either image. A larger
/// one reaches other surfaces, a smaller one leaves matches without neighbours.
const REACH: f64 = 0.1;
/// Largest deviation from the predicted position, as a share of the neighbour's distance: a
/// rotation by 20°. It allows for perspective and for the errors of one orientation and scale.
const STRAY: f64 = 0.35;
/// Largest difference between the rotations of neighbours, radians. Of wrong matches, whose
/// rotations are arbitrary, 19 % pass; with half of it, 10 %.
const TURN: f64 = 0.6;
/// Largest difference between the logarithms of scale of neighbours: a factor of 1.6.
const ZOOM: f64 = 0.5;
/// Number of matches that a nearby click counts as. Support counts by its logarithm, so half or
/// twice of it changes the log-odds by about half of `by_support`.
const CLICK_VOTES: f64 = 3.0;

/// Model of the log-odds of a match:
/// `base + clamp(by_ratio · (even_ratio − ratio)) + by_support · ln(1 + support)`.
struct Odds {
    /// Log-odds of a match without support at the even ratio.
    base: f64,
    /// Gain of the log-odds when the ratio falls by 1.
    by_ratio: f64,
    /// Ratio that changes nothing.
    even_ratio: f64,
    /// Smallest and largest contribution of the ratio. Extreme ratios are too rare to fit.
    limits: [f64; 2],
    /// Factor of `ln(1 + support)`.
    by_support: f64,
}

/// Odds fitted to shares of right matches where the geometry was known, by ratio and number of
/// neighbours. A match with a ratio of 0.86 and two neighbours is about as likely right as wrong.
const ODDS: Odds = Odds { base: -1.5, by_ratio: 6.5, even_ratio: 0.86, limits: [-1.4, 4.0], by_support: 1.2 };

/// A match with the local map that its features determine.
#[derive(Debug, Clone, Copy)]
struct LocalMap {
    pair: PointPair,
    /// Scales of the features, px.
    scales: [f64; 2],
    /// Map of offsets in image 1 to offsets in image 2, from the two frames.
    affine: Matrix2<f64>,
    /// Rotation from image 1 to image 2, radians.
    turn: f64,
    /// Logarithm of the scale in image 2 over the scale in image 1.
    zoom: f64,
}

impl LocalMap {
    fn new(m: &FeatureMatch, a: &Feature, b: &Feature) -> Self {
        let (turn, zoom) = (b.orientation - a.orientation, (b.scale / a.scale).ln());
        Self { pair: m.pair, scales: [a.scale, b.scale], affine: a.affine_to(b), turn, zoom }
    }

    /// Returns whether another pair lies where this match predicts it, at an informative distance.
    fn expects(&self, other: &PointPair, sides: [f64; 2]) -> bool {
        let v = other.point1 - self.pair.point1;
        let w = other.point2 - self.pair.point2;
        let (dv, dw) = (v.norm(), w.norm());
        // The same blob found twice is no neighbour.
        if dv < 2.0 * self.scales[0] || dw < 2.0 * self.scales[1] {
            return false;
        }
        if dv > REACH * sides[0] && dw > REACH * sides[1] {
            return false;
        }
        let expected = self.affine * v;
        (expected - w).norm() < STRAY * dw.max(expected.norm())
    }

    fn alike(&self, other: &Self) -> bool {
        angle_between(self.turn, other.turn) < TURN && (self.zoom - other.zoom).abs() < ZOOM
    }
}

/// Returns the log-odds that each match is right, given the features of both images and the clicks.
pub(super) fn log_odds(
    sets: [&FeatureSet; 2],
    matches: &[FeatureMatch],
    frames: [Frame; 2],
    clicks: &[PointPair],
) -> Vec<f64> {
    let maps: Vec<LocalMap> = matches
        .iter()
        .map(|m| LocalMap::new(m, &sets[0].features()[m.feature1], &sets[1].features()[m.feature2]))
        .collect();
    let sides = frames.map(|f| f.longer_side());
    let blocks: Vec<PairBlock> = maps.chunks(LANES).map(PairBlock::new).collect();
    maps.par_iter()
        .zip(matches)
        .map_init(Vec::new, |near, (map, m)| {
            within_reach(&blocks, &map.pair, sides, near);
            let others = near.iter().map(|k| &maps[*k as usize]);
            let neighbours =
                others.filter(|other| map.expects(&other.pair, sides) && map.alike(other)).count();
            let clicked = clicks.iter().filter(|click| map.expects(click, sides)).count();
            let support = neighbours as f64 + CLICK_VOTES * clicked as f64;
            let of_ratio =
                (ODDS.by_ratio * (ODDS.even_ratio - m.ratio)).clamp(ODDS.limits[0], ODDS.limits[1]);
            ODDS.base + of_ratio + ODDS.by_support * support.ln_1p()
        })
        .collect()
}

/// Positions of a block of matches in both images; NaN in empty lanes.
struct PairBlock {
    x1: [f32; LANES],
    y1: [f32; LANES],
    x2: [f32; LANES],
    y2: [f32; LANES],
}

impl PairBlock {
    fn new(maps: &[LocalMap]) -> Self {
        let [x1, y1, x2, y2] = [[f32::NAN; LANES]; 4];
        let mut block = Self { x1, y1, x2, y2 };
        for (k, LocalMap { pair, .. }) in maps.iter().enumerate() {
            let [x1, y1, x2, y2] = pair.numbers().map(|v| v as f32);
            (block.x1[k], block.y1[k], block.x2[k], block.y2[k]) = (x1, y1, x2, y2);
        }
        block
    }
}

/// Fills `near` with the indices of the matches within [`REACH`] of a pair in one of the images, and of
/// some slightly farther off.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512bw+avx512dq+avx2", "x86_64+avx2", "aarch64+neon"))]
fn within_reach(blocks: &[PairBlock], pair: &PointPair, sides: [f64; 2], near: &mut Vec<u32>) {
    /// Allowance for rounding to single precision, px.
    const SLACK: f64 = 0.1;
    near.clear();
    let [x1, y1, x2, y2] = [pair.point1.x, pair.point1.y, pair.point2.x, pair.point2.y];
    let (x1, y1, x2, y2) = (x1 as f32, y1 as f32, x2 as f32, y2 as f32);
    let reach = [(REACH * sides[0] + SLACK) as f32, (REACH * sides[1] + SLACK) as f32];
    let limits = [reach[0] * reach[0], reach[1] * reach[1]];
    for (index, block) in blocks.iter().enumerate() {
        let mut is_near = [0u8; LANES];
        for (k, is_near) in is_near.iter_mut().enumerate() {
            let (u1, v1) = (block.x1[k] - x1, block.y1[k] - y1);
            let (u2, v2) = (block.x2[k] - x2, block.y2[k] - y2);
            *is_near = u8::from(u1 * u1 + v1 * v1 <= limits[0]) | u8::from(u2 * u2 + v2 * v2 <= limits[1]);
        }
        for lane in SetLanes::of(is_near) {
            near.push((index * LANES + lane) as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::geometry::Point;

    #[test]
    fn every_match_that_another_may_expect_is_within_reach() {
        let at = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 12) / f64::from(1u32 << 20);
        let place = |k: u32| Point::new(800.0 * at(2 * k), 600.0 * at(2 * k + 1));
        let map = |k: u32| LocalMap {
            pair: PointPair { point1: place(k), point2: place(k + 500) + Vector2::new(0.3, 0.1) },
            scales: [2.0; 2],
            affine: Matrix2::identity(),
            turn: 0.0,
            zoom: 0.0,
        };
        let maps: Vec<LocalMap> = (0..203).map(map).collect();
        let blocks: Vec<PairBlock> = maps.chunks(LANES).map(PairBlock::new).collect();
        let sides = [800.0, 700.0];
        let mut near = Vec::new();
        for map in &maps {
            within_reach(&blocks, &map.pair, sides, &mut near);
            let expected = maps.iter().zip(0..).filter(|(other, _)| {
                let (v, w) = (other.pair.point1 - map.pair.point1, other.pair.point2 - map.pair.point2);
                v.norm() <= REACH * sides[0] || w.norm() <= REACH * sides[1]
            });
            assert_eq!(near, expected.map(|(_, k)| k).collect::<Vec<u32>>());
        }
    }
}
