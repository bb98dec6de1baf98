//! How likely a match of covariant features is right, before any geometry is known.
//!
//! Three witnesses, each worth its own factor of the odds (what right and wrong matches were seen to have):
//!
//! - the **ratio** of its distance to that of the next best elsewhere;
//! - **local support**: a match says, by its two frames, where its neighbours should be; how
//!   many of the matches around are there, turned and scaled alike (as in `AdaLAM`, Cavalli et al. 2020);
//! - **the clicks**, which say the same as neighbours and are certain.

use nalgebra::Matrix2;
use rayon::prelude::*;

use crate::features::{Feature, FeatureMatch, FeatureSet};
use crate::geometry::{Frame, PointPair, angle_between};

/// Radius of the neighbourhood of a match, as a share of the longer side of either image. Surfaces
/// are often smooth over a tenth of the image. Not measured.
const REACH: f64 = 0.1;
/// Largest deviation from the predicted position, in distances of the neighbour: perspective, and
/// the errors of one orientation and one scale.
const STRAY: f64 = 0.35;
/// Largest difference between turns of neighbours, radians. Not measured.
const TURN: f64 = 0.6;
/// Largest difference between logarithms of scales of neighbours: a factor of 1.6. Not measured.
const ZOOM: f64 = 0.5;
/// Matches that a nearby click is worth: a click is right more often than a match. Not measured.
const CLICK_VOTES: f64 = 3.0;

/// What the logarithm of the odds of a match is made of, `base + clamp(by_ratio · (even_ratio − ratio)) +
/// by_support · ln(1 + support)`.
struct Odds {
    /// Logarithm of the odds at the even ratio, of a match without support.
    base: f64,
    /// By how much the logarithm grows when the ratio falls by 1.
    by_ratio: f64,
    /// Ratio that speaks neither for a match nor against it.
    even_ratio: f64,
    /// What a ratio adds at least and at most: there are few matches with an extreme one to fit to.
    limits: [f64; 2],
    /// By how much the logarithm grows with that of one more than the support.
    by_support: f64,
}

/// Odds fitted to shares of right matches, counted by ratio and by number of neighbours where the geometry was known: at a
/// ratio of 0.86 and two neighbours a match is about as likely right as wrong.
const ODDS: Odds = Odds { base: -1.5, by_ratio: 6.5, even_ratio: 0.86, limits: [-1.4, 4.0], by_support: 1.2 };

/// A match with what its features say about the map around it.
#[derive(Debug, Clone, Copy)]
struct LocalMap {
    pair: PointPair,
    /// Scales of the features, px.
    scales: [f64; 2],
    /// Maps offsets in image 1 to offsets in image 2, as the two frames say.
    affine: Matrix2<f64>,
    /// Turn from image 1 to image 2, radians.
    turn: f64,
    /// Scale of image 2 over that of image 1, logarithm.
    zoom: f64,
}

impl LocalMap {
    fn new(m: &FeatureMatch, a: &Feature, b: &Feature) -> Self {
        let (turn, zoom) = (b.orientation - a.orientation, (b.scale / a.scale).ln());
        Self { pair: m.pair, scales: [a.scale, b.scale], affine: a.affine_to(b), turn, zoom }
    }

    /// Whether another pair is where this match expects it, at a distance that says something.
    fn expects(&self, other: &PointPair, sides: [f64; 2]) -> bool {
        let v = other.point1 - self.pair.point1;
        let w = other.point2 - self.pair.point2;
        let (dv, dw) = (v.norm(), w.norm());
        // The same blob once more is no neighbour.
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

/// The logarithm of the odds that each match is right, given the features of both images and what was clicked.
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
    maps.par_iter()
        .zip(matches)
        .map(|(map, m)| {
            let neighbours =
                maps.iter().filter(|other| map.expects(&other.pair, sides) && map.alike(other)).count();
            let clicked = clicks.iter().filter(|click| map.expects(click, sides)).count();
            let support = neighbours as f64 + CLICK_VOTES * clicked as f64;
            let of_ratio =
                (ODDS.by_ratio * (ODDS.even_ratio - m.ratio)).clamp(ODDS.limits[0], ODDS.limits[1]);
            ODDS.base + of_ratio + ODDS.by_support * support.ln_1p()
        })
        .collect()
}
