//! Whether the epipole is held by parallax: what a camera that stands still or only turns lacks while things move.
//!
//! Where one homography explains most matches, those matches say nothing about where the epipolar lines meet. What lies
//! off it moves against it along the line through the epipole. A thing that moves by itself does too, for the one
//! epipole on the line of its own motion, and an epipole has two degrees of freedom: it fits any **two** independent
//! motions. So the distinctive matches off the plane are taken, whether or not they agree with F, in groups that move
//! alike; groups that agree with F beyond two must be more than chance explains.
//!
//! A group whose parallax is `d` px long agrees within `b` px by chance with the probability that its direction is one of
//! those that pass the epipole so nearly: `p = 2/π · asin(b / d)`.
//!
//! Distinctive matches are found to a pixel, so parallax of less than some pixels does not show in them. The refined ones
//! are finer, but were found along the lines of F, in a band about them: what has nothing to do with F lies anywhere in
//! it, so that a group is within a third of the band's half width by chance with probability ⅓.

use nalgebra::Matrix3;

use crate::estimate::patches::{BAND, Support};
use crate::geometry::{FundamentalMatrix, PointPair, Vector, finite_point};

/// What lies off the largest plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OffPlane {
    /// Groups of matches that move alike, and how many of them agree with F.
    pub groups: usize,
    pub agreeing: usize,
    /// Probability that so many agree if they have nothing to do with F.
    pub chance: f64,
}

/// A match is off the plane from this far on, px of the level: corners are found to a pixel, and so is the plane.
const OFF_PLANE: f64 = 4.0;
/// Two matches move alike whose parallax differs by less than this, px of the level.
const ALIKE: f64 = 3.0;
/// The same of refined matches, in units of how near to the plane a match on it is.
const REFINED_OFF_PLANE: f64 = 2.0;
const REFINED_ALIKE: f64 = 1.5;
/// A third of the half width of the band that refined matches are found in, px, and the chance to be so near the line.
const REFINED_BAND: f64 = 0.4;
const REFINED_CHANCE: f64 = 1.0 / 3.0;
/// Matches of one thing are no farther apart than this fraction of the longer side.
const TOGETHER: f64 = 0.25;
/// Motions that an epipole fits whatever they are.
const FREE: usize = 2;

impl OffPlane {
    /// The matches off the plane with homography `h`, and how `f` agrees with them, in pixels of the level.
    pub fn new(support: &Support, f: &FundamentalMatrix, h: &Matrix3<f64>, side: f64) -> Self {
        let off: Vec<(PointPair, Vector)> = support
            .distinctive()
            .into_iter()
            .filter_map(|pair| {
                let on_plane = finite_point(&(h * pair.point1.to_homogeneous()))?;
                let parallax = pair.point2 - on_plane;
                (parallax.norm() > OFF_PLANE).then_some((pair, parallax))
            })
            .collect();
        let mut agreeing = 0;
        let mut chances = Vec::new();
        for group in moving_alike(&off, ALIKE, TOGETHER * side) {
            let near = |k: &&usize| {
                let pair = &off[**k].0;
                f.line2_from_point1(pair.point1).is_some_and(|line| line.distance(pair.point2) <= BAND)
            };
            // A group agrees as a whole.
            agreeing += usize::from(2 * group.iter().filter(near).count() > group.len());
            let length = group.iter().map(|k| off[*k].1.norm()).sum::<f64>() / group.len() as f64;
            chances.push((BAND / length).min(1.0).asin() * std::f64::consts::FRAC_2_PI);
        }
        let chance = at_least(&chances, agreeing.saturating_sub(FREE));
        Self { groups: chances.len(), agreeing, chance }
    }

    /// The same of refined matches, in full-size pixels; a match is on the plane within `tolerance` px.
    pub fn refined(
        matches: &[PointPair],
        f: &FundamentalMatrix,
        h: &Matrix3<f64>,
        tolerance: f64,
        side: f64,
    ) -> Self {
        let off: Vec<(PointPair, Vector)> = matches
            .iter()
            .filter_map(|pair| {
                let parallax = pair.point2 - finite_point(&(h * pair.point1.to_homogeneous()))?;
                (parallax.norm() > REFINED_OFF_PLANE * tolerance).then_some((*pair, parallax))
            })
            .collect();
        let groups = moving_alike(&off, REFINED_ALIKE * tolerance, TOGETHER * side);
        let is_near = |group: &&Vec<usize>| {
            let distances = group.iter().filter_map(|k| {
                Some(f.line2_from_point1(off[*k].0.point1)?.signed_distance(off[*k].0.point2))
            });
            (distances.sum::<f64>() / group.len() as f64).abs() < REFINED_BAND
        };
        let agreeing = groups.iter().filter(is_near).count();
        let chance = at_least(&vec![REFINED_CHANCE; groups.len()], agreeing.saturating_sub(FREE));
        Self { groups: groups.len(), agreeing, chance }
    }
}

/// Numbers of the matches that belong to one motion each: those that move like the first of them, near it. A surface
/// that runs in depth moves differently from end to end, which nothing does that moves as a whole.
fn moving_alike(off: &[(PointPair, Vector)], alike: f64, together: f64) -> Vec<Vec<usize>> {
    let mut is_grouped = vec![false; off.len()];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (seed, (pair, parallax)) in off.iter().enumerate() {
        if is_grouped[seed] {
            continue;
        }
        let is_alike = |(other, its): &(PointPair, Vector)| {
            (its - parallax).norm() < alike && (other.point1 - pair.point1).norm() < together
        };
        let members: Vec<usize> =
            (seed..off.len()).filter(|k| !is_grouped[*k] && is_alike(&off[*k])).collect();
        for k in &members {
            is_grouped[*k] = true;
        }
        groups.push(members);
    }
    groups
}

/// Probability that at least `count` of independent events with these probabilities happen.
fn at_least(chances: &[f64], count: usize) -> f64 {
    // Probability of each number below `count`; what is more is not told apart.
    let mut of_number = vec![0.0; count];
    if let Some(none) = of_number.first_mut() {
        *none = 1.0;
    }
    for p in chances {
        for k in (0..count).rev() {
            let fewer = if k > 0 { of_number[k - 1] } else { 0.0 };
            of_number[k] = of_number[k] * (1.0 - p) + fewer * p;
        }
    }
    (1.0 - of_number.iter().sum::<f64>()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_of_independent_events() {
        assert!((at_least(&[0.5; 4], 0) - 1.0).abs() < 1e-12);
        assert!((at_least(&[0.5; 4], 4) - 1.0 / 16.0).abs() < 1e-12);
        assert!((at_least(&[0.1, 0.3], 1) - (1.0 - 0.9 * 0.7)).abs() < 1e-12);
        assert!(at_least(&[0.2], 2) < 1e-12, "more than there are");
    }

    #[test]
    fn what_moves_alike_nearby_is_one_motion() {
        let moved =
            |x: f64, y: f64, dx: f64, dy: f64| (PointPair::new(x, y, x + dx, y + dy), Vector::new(dx, dy));
        let off = [
            moved(10.0, 10.0, 8.0, 0.0),
            moved(40.0, 10.0, 9.0, 1.0),
            moved(70.0, 12.0, 10.0, 1.5),
            moved(20.0, 10.0, -8.0, 0.0),
            moved(400.0, 10.0, 8.0, 0.0),
        ];
        let groups = moving_alike(&off, ALIKE, 100.0);
        assert_eq!(groups, [vec![0, 1, 2], vec![3], vec![4]]);
        let deeper =
            [moved(10.0, 10.0, 8.0, 0.0), moved(20.0, 10.0, 10.0, 0.0), moved(30.0, 10.0, 12.0, 0.0)];
        assert_eq!(moving_alike(&deeper, ALIKE, 100.0).len(), 2, "a surface in depth");
    }
}
