//! The most informative next click: where the competing geometries disagree.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;
use serde::Serialize;

use crate::estimate::{Estimate, PreparedPair};
use crate::geometry::{
    Frame, FundamentalMatrix, Line, Point, PointPair, Vector, finite_point, median, rescaled,
};

/// Longer side of the image searched for textured points, px.
const SIDE: f64 = 384.0;
/// Number of textured points considered.
const PLACES: usize = 600;
/// Distance of these points from the border at the reduced size, px.
const BORDER: usize = 10;
/// Maximum number of rivals.
const RIVALS: usize = 12;
/// Exponent that turns the ratio of a rival's support to the best support into a weight.
const SHARPNESS: i32 = 4;
/// Distance between two lines at which the gain begins to saturate, as a fraction of the longer side.
/// Any click distinguishes lines that are farther apart.
const SATURATION: f64 = 0.05;
/// Minimum disagreement worth a click, as a fraction of the longer side.
const LEAST: f64 = 0.0025;
/// Minimum distance from a placed point, as a fraction of the longer side. Nearer clicks add
/// nothing.
const APART: f64 = 0.03;
/// Minimum number of matches that can surround a place.
const FEWEST_AROUND: usize = 3;
/// Maximum distance of a place from matches of the result, as a fraction of the longer side. Farther
/// away, the other image may not show the same part of the scene. Half of this distance leaves few
/// places on sparsely matched pictures; twice of it reaches across the border of the common part.
const NEAR: f64 = 0.08;
/// Smallest number of matches near a place, as a share of the median number near a match. Outside the
/// common part of the images, a few corners fit F by chance.
const LEAST_SHARE: f64 = 0.25;
/// Number of matches from which the median number is computed.
const COUNTED: usize = 200;
/// Number of samples per line for its mean distance from another line.
const SAMPLES: usize = 9;

/// Geometry that competes with a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rival {
    /// Fundamental matrix of the rival.
    pub fundamental: FundamentalMatrix,
    /// Weight from 0 to 1.
    pub weight: f64,
}

/// Proposed position of the next click.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NextClick {
    /// Position in image 1, full-size px.
    pub point: Point,
    /// Distance in image 2 between the epipolar lines of this point under the result and under its
    /// rivals, px. Mean over the rivals by weight.
    pub disagreement: f64,
}

impl Rival {
    /// Returns the best hypotheses of the search behind a result.
    pub fn of(found: &Estimate) -> Vec<Self> {
        let hypotheses = found.hypotheses();
        let Some(best) = hypotheses.first() else { return Vec::new() };
        // Support is a score to maximise, the line score one to minimise.
        let ratio = |other: &Estimate| match (best.support_score(), best.line_score()) {
            (Some(best), _) => Some(other.support_score()? / best),
            (None, Some(best)) => Some(best / other.line_score()?),
            (None, None) => None,
        };
        let rival = |other: &Estimate| {
            let ratio = ratio(other).filter(|ratio| ratio.is_finite())?;
            Some(Self { fundamental: *other.fundamental(), weight: ratio.clamp(0.0, 1.0).powi(SHARPNESS) })
        };
        hypotheses.iter().take(RIVALS).filter_map(rival).collect()
    }
}

/// Returns the textured point of image 1 whose epipolar lines under the result and its rivals are
/// farthest apart in image 2. Skips points near placed pairs or the epipole, and points that are not
/// surrounded by near `matches` of the result. Returns `None` when all geometries agree. Takes some
/// milliseconds.
pub fn next_click(
    prepared: &PreparedPair,
    fundamental: &FundamentalMatrix,
    rivals: &[Rival],
    placed: &[PointPair],
    matches: &[PointPair],
) -> Option<NextClick> {
    let [frame1, frame2] = prepared.frames();
    let total: f64 = rivals.iter().map(|rival| rival.weight).sum();
    let level = prepared.pyramids().level(SIDE);
    let (apart_by, near) = (APART * frame1.longer_side(), NEAR * frame1.longer_side());
    let epipole = finite_point(&fundamental.epipole1());
    let is_apart = |point: &Point| {
        let taken = placed.iter().map(|pair| pair.point1).chain(epipole);
        taken.into_iter().all(|other| (other - point).norm() > apart_by)
    };
    let counted = matches.iter().step_by(matches.len().div_ceil(COUNTED).max(1));
    let usual = median(counted.map(|pair| near_matches(matches, pair.point1, near).count() as f64));
    let is_common = |point: &Point| {
        let neighbours: Vec<Vector> = near_matches(matches, *point, near).collect();
        if matches.len() < FEWEST_AROUND {
            return neighbours.len() == matches.len();
        }
        neighbours.len() as f64 >= LEAST_SHARE * usual && surround(&neighbours)
    };
    let side = frame2.longer_side();
    let seen = |point: Point| {
        let own = fundamental.line2_from_point1(point)?;
        frame2.clip(&own)?;
        // A rival whose line misses image 2 is skipped: there is nothing to click.
        let distances = rivals.iter().filter_map(|rival| {
            let line = rival.fundamental.line2_from_point1(point)?;
            Some((rival.weight / total, apart(&own, &line, frame2)?))
        });
        let (worth, disagreement) = distances.fold((0.0, 0.0), |(worth, mean), (weight, distance)| {
            let saturation = SATURATION * side;
            (worth + weight * distance * saturation / (distance + saturation), mean + weight * distance)
        });
        Some((worth, NextClick { point, disagreement }))
    };
    let corners = level.corners(0, PLACES, BORDER);
    let places: Vec<(f64, NextClick)> = corners
        .into_par_iter()
        .map(|corner| rescaled(corner, 1.0 / level.scales[0]))
        .filter(|point| is_apart(point) && is_common(point))
        .filter_map(seen)
        .collect();
    // Of equal points the first is kept, which is the most textured.
    let best = places.into_iter().reduce(|best, other| if other.0 > best.0 { other } else { best });
    best.map(|(_, place)| place).filter(|place| place.disagreement >= LEAST * side)
}

/// Returns the vectors from a place of image 1 to the matches near it.
fn near_matches(matches: &[PointPair], point: Point, near: f64) -> impl Iterator<Item = Vector> {
    matches.iter().map(move |pair| pair.point1 - point).filter(move |vector| vector.norm() <= near)
}

/// Returns whether the directions of vectors leave no gap of half a turn. A place surrounded by matches
/// is visible in the other image; a place beside all matches may lie outside it.
fn surround(vectors: &[Vector]) -> bool {
    let mut angles: Vec<f64> = vectors.iter().map(|v| v.y.atan2(v.x)).collect();
    angles.sort_unstable_by(f64::total_cmp);
    let next = angles.iter().skip(1).copied().chain(angles.first().map(|first| first + TAU));
    !angles.is_empty() && angles.iter().zip(next).all(|(angle, next)| next - angle < PI)
}

/// Returns the mean distance of the visible part of each line from the other, px; `None` when a
/// line is not visible.
fn apart(a: &Line, b: &Line, frame: Frame) -> Option<f64> {
    let one_way = |from: &Line, to: &Line| {
        let segment = frame.clip(from)?;
        let along =
            |k: usize| segment.start + (segment.end - segment.start) * (k as f64 / (SAMPLES - 1) as f64);
        Some((0..SAMPLES).map(|k| to.distance(along(k))).sum::<f64>() / SAMPLES as f64)
    };
    Some(0.5 * (one_way(a, b)? + one_way(b, a)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::GrayPlane;
    use nalgebra::Matrix3;

    const FRAME: Frame = Frame { width: 480, height: 360 };

    /// Returns images with corners everywhere except in a flat left half.
    fn prepared() -> PreparedPair {
        let tiles =
            |x: usize, y: usize| if x >= 200 && (x / 24 + y / 24).is_multiple_of(2) { 200.0 } else { 60.0 };
        let plane = GrayPlane::from_fn(FRAME, tiles);
        PreparedPair::new(&plane, &plane)
    }

    /// Returns the geometry that maps every point to the row `a y + b`.
    fn rows(a: f64, b: f64) -> FundamentalMatrix {
        let f = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -a, -b);
        FundamentalMatrix::from_rank_two(f).unwrap()
    }

    #[test]
    fn the_next_click_is_where_both_lines_are_visible_and_farthest_apart() {
        // The rows differ by a fifth of the distance from row 100. Below row 316 the rival leaves
        // the image.
        let rival = Rival { fundamental: rows(1.2, -20.0), weight: 1.0 };
        let found = next_click(&prepared(), &rows(1.0, 0.0), &[rival], &[], &[]).unwrap();
        assert!((280.0..316.5).contains(&found.point.y) && found.point.x > 190.0, "{found:?}");
        assert!((found.disagreement - 0.2 * (found.point.y - 100.0)).abs() < 1e-6);
        // A point near a placed pair is not proposed again.
        let placed = PointPair { point1: found.point, point2: found.point };
        let other = next_click(&prepared(), &rows(1.0, 0.0), &[rival], &[placed], &[]).unwrap();
        assert!((other.point - found.point).norm() > 14.0);
        // Nor is a point where nothing matches.
        let matched = PointPair::new(300.0, 200.0, 310.0, 200.0);
        let near = next_click(&prepared(), &rows(1.0, 0.0), &[rival], &[], &[matched]).unwrap();
        assert!((near.point - matched.point1).norm() <= 0.08 * 480.0, "{near:?}");
        // It lies between matches, not beside them.
        let around = [(420.0, 120.0), (460.0, 130.0), (430.0, 180.0)];
        let mut all: Vec<PointPair> = around.iter().map(|(x, y)| PointPair::new(*x, *y, *x, *y)).collect();
        let between = next_click(&prepared(), &rows(1.0, 0.0), &[rival], &[], &all).unwrap();
        assert!((420.0..460.0).contains(&between.point.x) && (120.0..180.0).contains(&between.point.y));
        // A few matches far from many are wrong.
        let crowd = (0..40).map(|k| {
            let at = (220.0 + 7.0 * f64::from(k % 8), 40.0 + 9.0 * f64::from(k / 8));
            PointPair::new(at.0, at.1, at.0, at.1)
        });
        let crowded: Vec<PointPair> = all.iter().copied().chain(crowd).collect();
        let among = next_click(&prepared(), &rows(1.0, 0.0), &[rival], &[], &crowded).unwrap();
        assert!(among.point.x < 280.0 && among.point.y < 90.0, "{among:?}");
        all.truncate(1);
        all.extend([matched; 3]);
        assert_eq!(next_click(&prepared(), &rows(1.0, 0.0), &[rival], &[], &all), None);
    }

    #[test]
    fn weak_rivals_count_little_and_agreeing_rivals_not_at_all() {
        let near = Rival { fundamental: rows(1.2, -20.0), weight: 1.0 };
        let weak = Rival { fundamental: rows(0.2, 270.0), weight: 1e-4 };
        let found = next_click(&prepared(), &rows(1.0, 0.0), &[near, weak], &[], &[]).unwrap();
        assert!(found.point.y > 280.0, "{found:?}");
        let same = Rival { fundamental: rows(1.0, 0.1), weight: 1.0 };
        assert_eq!(next_click(&prepared(), &rows(1.0, 0.0), &[same], &[], &[]), None);
        assert_eq!(next_click(&prepared(), &rows(1.0, 0.0), &[], &[], &[]), None);
    }
}
