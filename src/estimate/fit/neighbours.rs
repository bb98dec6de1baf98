//! Matches that their neighbours confirm.
//!
//! A corner that is matched by accident lies anywhere on its epipolar line, and its residual may be as
//! small as that of a right match. Where the scene is nearly flat, a few such matches far off the plane
//! would alone seem to determine the epipole. Their neighbours in image 1 tell them apart: the match of a
//! right neighbour moves nearly alike (the statistics of Bian et al., CVPR 2017, by the measured shares).

use nalgebra::{Matrix2, Vector2};

use crate::geometry::{Frame, PointPair, median};

/// Number of neighbours that are asked.
const NEIGHBOURS: usize = 8;
/// Largest change of a displacement from one match to its neighbour, as a share of their distance. With
/// 0.3 and 0.8 nearly the same wrong matches are found (`lab/notes.md`).
const BEND: f64 = 0.5;
/// Displacements of neighbours differ by this even where they are close, px: matches at edges of depth.
const LOOSE: f64 = 3.0;
/// Limits of the share of neighbours that agree. No finite number of matches shows that all do.
const SHARES: std::ops::RangeInclusive<f64> = 0.05..=0.95;

/// Returns which matches are rather right than wrong, given how many of their neighbours move alike.
/// `right` is the share of right matches among all. Image 2 has the size `frame2`.
///
/// A share `q` of the neighbours of right matches agree with them: the share measured over all matches. A
/// match at a random place of its line agrees with a neighbour with probability `p = 2 reach / side`. So the
/// log odds of a match are `ln (right / (1 − right))`, plus `ln (q / p)` for each neighbour that agrees and
/// `ln ((1 − q) / (1 − p))` for each other.
pub(super) fn confirmed(pairs: &[PointPair], frame2: Frame, right: f64) -> Vec<bool> {
    if pairs.len() <= NEIGHBOURS {
        return vec![true; pairs.len()];
    }
    let steps = |(own, near): (&PointPair, [usize; NEIGHBOURS])| {
        near.map(|j| (pairs[j].point1 - own.point1, pairs[j].point2 - own.point2))
    };
    let steps: Vec<(Vector2<f64>, Vector2<f64>)> = pairs.iter().zip(nearest(pairs)).flat_map(steps).collect();
    // Most neighbours turn and grow alike.
    let far = || steps.iter().filter(|(step1, _)| step1.norm() > 1.0);
    let along = median(far().map(|(a, b)| a.dot(b) / a.norm_squared()));
    let across = median(far().map(|(a, b)| a.perp(b) / a.norm_squared()));
    let scale = along.hypot(across);
    let side = frame2.width.min(frame2.height) as f64;
    let agreeing = |(a, b): &(Vector2<f64>, Vector2<f64>)| {
        let expected = Vector2::new(along * a.x - across * a.y, across * a.x + along * a.y);
        let reach = BEND * scale * a.norm() + LOOSE;
        ((b - expected).norm() < reach, (2.0 * reach / side).min(0.5))
    };
    let found: Vec<(bool, f64)> = steps.iter().map(agreeing).collect();
    let share = found.iter().filter(|(agrees, _)| *agrees).count() as f64 / found.len() as f64;
    let share = share.clamp(*SHARES.start(), *SHARES.end());
    let right = right.clamp(*SHARES.start(), *SHARES.end());
    let prior = (right / (1.0 - right)).ln();
    let odds = |(agrees, chance): &(bool, f64)| {
        if *agrees { (share / chance).ln() } else { ((1.0 - share) / (1.0 - chance)).ln() }
    };
    found.chunks(NEIGHBOURS).map(|of| prior + of.iter().map(odds).sum::<f64>() > 0.0).collect()
}

/// Returns how much surfaces are foreshortened from one image to the other: the ratio of the singular values of the
/// affine map of a match and its neighbours, the median over the matches. `None` for too few matches.
pub(in crate::estimate) fn foreshortening(pairs: &[PointPair]) -> Option<f64> {
    if pairs.len() <= NEIGHBOURS {
        return None;
    }
    let of = |(own, near): (&PointPair, [usize; NEIGHBOURS])| -> Option<f64> {
        let (mut spread, mut moved) = (Matrix2::zeros(), Matrix2::zeros());
        for j in near {
            let step1 = pairs[j].point1 - own.point1;
            spread += step1 * step1.transpose();
            moved += (pairs[j].point2 - own.point2) * step1.transpose();
        }
        let values = (moved * spread.try_inverse()?).singular_values();
        Some(values.max() / values.min()).filter(|ratio| ratio.is_finite())
    };
    let ratios: Vec<f64> = pairs.iter().zip(nearest(pairs)).filter_map(of).collect();
    (!ratios.is_empty()).then(|| median(ratios))
}

/// Returns the nearest other matches of each match in image 1.
fn nearest(pairs: &[PointPair]) -> Vec<[usize; NEIGHBOURS]> {
    let mut by_column: Vec<usize> = (0..pairs.len()).collect();
    by_column.sort_by(|a, b| pairs[*a].point1.x.total_cmp(&pairs[*b].point1.x).then(a.cmp(b)));
    let mut all = vec![[0; NEIGHBOURS]; pairs.len()];
    for (rank, k) in by_column.iter().enumerate() {
        let own = pairs[*k].point1;
        let (mut before, mut after) = (by_column[..rank].iter().rev(), by_column[rank + 1..].iter());
        let (mut left, mut right) = (before.next(), after.next());
        let columns = |j: Option<&usize>| j.map_or(f64::INFINITY, |j| (pairs[*j].point1.x - own.x).abs());
        let mut best: Vec<(f64, usize)> = Vec::with_capacity(NEIGHBOURS + 1);
        // From column to column, until none can be nearer.
        while let Some(j) = if columns(left) <= columns(right) { left } else { right } {
            if best.len() == NEIGHBOURS && columns(Some(j)).powi(2) > best[NEIGHBOURS - 1].0 {
                break;
            }
            let found = ((pairs[*j].point1 - own).norm_squared(), *j);
            let place = best.partition_point(|other| (other.0, other.1) < found);
            best.insert(place, found);
            best.truncate(NEIGHBOURS);
            if columns(left) <= columns(right) { left = before.next() } else { right = after.next() }
        }
        // Places that are no numbers have no neighbours.
        all[*k] = std::array::from_fn(|n| best.get(n).map_or(*k, |other| other.1));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Vector};

    const FRAME: Frame = Frame { width: 640, height: 480 };

    /// Returns 300 matches of a plane, turned by 30°, and 6 at accidental places.
    fn matches() -> Vec<PointPair> {
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let place = |k: usize| {
            let part = |step: f64| (k as f64 * step).fract();
            Point::new(600.0 * part(0.618_034), 440.0 * part(0.754_878))
        };
        let moved = |p: Point| Point::new(cos * p.x - sin * p.y + 0.1 * p.x, sin * p.x + cos * p.y);
        let right = (0..300).map(|k| PointPair { point1: place(k), point2: moved(place(k)) });
        let wrong = (300..306).map(|k| PointPair {
            point1: place(k),
            point2: moved(place(k)) + Vector::new(60.0 + 9.0 * k as f64 % 70.0, -40.0),
        });
        right.chain(wrong).collect()
    }

    #[test]
    fn accidental_matches_are_not_confirmed() {
        let found = confirmed(&matches(), FRAME, 0.9);
        assert!(found[..300].iter().all(|is| *is));
        assert!(found[300..].iter().all(|is| !is));
    }

    #[test]
    fn the_nearest_are_those_of_all() {
        let all = matches();
        for (k, found) in nearest(&all).into_iter().enumerate() {
            let distance = |j: &usize| (all[*j].point1 - all[k].point1).norm_squared();
            let mut others: Vec<usize> = (0..all.len()).filter(|j| *j != k).collect();
            others.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
            assert_eq!(found[..], others[..NEIGHBOURS], "match {k}");
        }
    }

    #[test]
    fn where_neighbours_seldom_agree_none_is_blamed() {
        let mut all = matches();
        for (k, pair) in all.iter_mut().enumerate() {
            pair.point2.x += 97.0 * (k as f64 * 0.345).fract();
            pair.point2.y += 83.0 * (k as f64 * 0.871).fract();
        }
        let found = confirmed(&all, FRAME, 0.9);
        assert!(found.iter().filter(|is| **is).count() > 290);
    }

    #[test]
    fn a_surface_seen_from_the_side_is_foreshortened() {
        let ratio = |width: f64| {
            let place = |k: u32| (f64::from(k % 10) * 30.0, f64::from(k / 10) * 25.0);
            let pairs: Vec<PointPair> =
                (0..80).map(place).map(|(x, y)| PointPair::new(x, y, width * x - 0.3 * y, 1.2 * y)).collect();
            foreshortening(&pairs).unwrap()
        };
        assert!(ratio(1.2) < 1.4 && ratio(0.5) > 2.0, "{} {}", ratio(1.2), ratio(0.5));
        assert_eq!(foreshortening(&[PointPair::new(1.0, 2.0, 3.0, 4.0); 8]), None);
    }
}
