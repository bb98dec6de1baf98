//! Where one more clicked pair would tell most: the place where the geometries in question disagree.

use rayon::prelude::*;
use serde::Serialize;

use crate::estimate::{Estimate, PreparedPair};
use crate::geometry::{Frame, FundamentalMatrix, Line, Point, PointPair, rescaled};

/// Longer side of the image in which textured places are looked for, px.
const SIDE: f64 = 384.0;
/// Textured places that are looked at, and how far they keep from the border at that size, px.
const PLACES: usize = 600;
const BORDER: usize = 10;
/// Rivals that are looked at.
const RIVALS: usize = 12;
/// The less support a rival has against the best one, the less it counts: the ratio to this power.
const SHARPNESS: i32 = 4;
/// Lines this share of the longer side apart are told apart by any click: more adds little.
const PLAIN: f64 = 0.05;
/// Smaller disagreements, as a share of the longer side, are no reason to click.
const LEAST: f64 = 0.0025;
/// Places nearer to a placed point than this share of the longer side tell nothing new.
const APART: f64 = 0.03;
/// Points of a line that its distance from another is the mean of.
const SAMPLES: usize = 9;

/// A geometry that competes with a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rival {
    /// The geometry.
    pub fundamental: FundamentalMatrix,
    /// How much it counts, 0 to 1.
    pub weight: f64,
}

/// A place for one more click.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NextClick {
    /// Where in image 1, full-size px.
    pub point: Point,
    /// How far the epipolar lines of this point under the result and under its rivals are apart in image 2, mean of the
    /// rivals by their weight, px.
    pub disagreement: f64,
}

impl Rival {
    /// The best hypotheses of the search that found a result.
    pub fn of(found: &Estimate) -> Vec<Self> {
        let hypotheses = found.hypotheses();
        let Some(best) = hypotheses.first() else { return Vec::new() };
        // Support is better when it is more, the score of lines when it is less.
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

/// The textured place of image 1 where the epipolar lines of the result and of its rivals are farthest apart in image 2,
/// off the pairs that are placed already; `None` when they agree everywhere. Takes some milliseconds.
pub fn next_click(
    prepared: &PreparedPair,
    fundamental: &FundamentalMatrix,
    rivals: &[Rival],
    placed: &[PointPair],
) -> Option<NextClick> {
    let [frame1, frame2] = prepared.frames();
    let total: f64 = rivals.iter().map(|rival| rival.weight).sum();
    let level = prepared.pyramids().level(SIDE);
    let is_apart =
        |point: &Point| placed.iter().all(|pair| (pair.point1 - point).norm() > APART * frame1.longer_side());
    let side = frame2.longer_side();
    let seen = |point: Point| {
        let own = fundamental.line2_from_point1(point)?;
        frame2.clip(&own)?;
        // What would be seen outside the image under a rival tells nothing: there is nothing to click.
        let distances = rivals.iter().filter_map(|rival| {
            let line = rival.fundamental.line2_from_point1(point)?;
            Some((rival.weight / total, apart(&own, &line, frame2)?))
        });
        let (worth, disagreement) = distances.fold((0.0, 0.0), |(worth, mean), (weight, distance)| {
            let plain = PLAIN * side;
            (worth + weight * distance * plain / (distance + plain), mean + weight * distance)
        });
        Some((worth, NextClick { point, disagreement }))
    };
    let corners = level.corners(0, PLACES, BORDER);
    let places: Vec<(f64, NextClick)> = corners
        .into_par_iter()
        .map(|corner| rescaled(corner, 1.0 / level.scales[0]))
        .filter(is_apart)
        .filter_map(seen)
        .collect();
    // The first of equals: the one with most texture.
    let best = places.into_iter().reduce(|best, other| if other.0 > best.0 { other } else { best });
    best.map(|(_, place)| place).filter(|place| place.disagreement >= LEAST * side)
}

/// Mean distance of what is seen of each line from the other one, px; `None` when one of them is not seen.
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

    /// Corners all over, but for the flat left half of an image.
    fn prepared() -> PreparedPair {
        let tiles =
            |x: usize, y: usize| if x >= 200 && (x / 24 + y / 24).is_multiple_of(2) { 200.0 } else { 60.0 };
        let plane = GrayPlane::from_fn(FRAME, tiles);
        PreparedPair::new(&plane, &plane)
    }

    /// Points are seen in the row `a y + b`.
    fn rows(a: f64, b: f64) -> FundamentalMatrix {
        let f = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -a, -b);
        FundamentalMatrix::from_rank_two(f).unwrap()
    }

    #[test]
    fn the_place_is_where_the_lines_are_farthest_apart_and_both_seen() {
        // The rows differ by a fifth of the way from row 100, and below row 316 the rival leaves the image.
        let rival = Rival { fundamental: rows(1.2, -20.0), weight: 1.0 };
        let found = next_click(&prepared(), &rows(1.0, 0.0), &[rival], &[]).unwrap();
        assert!((280.0..316.5).contains(&found.point.y) && found.point.x > 190.0, "{found:?}");
        assert!((found.disagreement - 0.2 * (found.point.y - 100.0)).abs() < 1e-6);
        // Where a pair was placed there is nothing to learn.
        let placed = PointPair { point1: found.point, point2: found.point };
        let other = next_click(&prepared(), &rows(1.0, 0.0), &[rival], &[placed]).unwrap();
        assert!((other.point - found.point).norm() > 14.0);
    }

    #[test]
    fn a_weak_rival_counts_little_and_one_that_agrees_not_at_all() {
        let near = Rival { fundamental: rows(1.2, -20.0), weight: 1.0 };
        let weak = Rival { fundamental: rows(0.2, 270.0), weight: 1e-4 };
        let found = next_click(&prepared(), &rows(1.0, 0.0), &[near, weak], &[]).unwrap();
        assert!(found.point.y > 280.0, "{found:?}");
        let same = Rival { fundamental: rows(1.0, 0.1), weight: 1.0 };
        assert_eq!(next_click(&prepared(), &rows(1.0, 0.0), &[same], &[]), None);
        assert_eq!(next_click(&prepared(), &rows(1.0, 0.0), &[], &[]), None);
    }
}
