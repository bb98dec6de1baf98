//! Whether the epipole is held by parallax: what a camera that stands still or only turns lacks while things move.
//!
//! Where one homography explains most matches, those matches say nothing about where the epipolar lines meet. What lies
//! off it moves against it along the line through the epipole. A thing that moves by itself does too, for the one
//! epipole on the line of its own motion, and an epipole has two degrees of freedom: it fits any **two** independent
//! motions. So the matches off the plane are taken in groups that move alike, whether or not they agree with F, and how
//! many of `n` groups agree is held against chance: each two of them determine one of `n (n − 1) / 2` epipoles, and
//!
//! ```text
//!     N = n (n − 1) / 2 · P(at least k − 2 of the n − 2 others agree by chance)
//! ```
//!
//! is the number of epipoles that do as well as the one of F, if nothing has to do with any (the number of false alarms
//! of Desolneux, Moisan & Morel 2000, which Moisan & Stival 2004 use for F itself).
//!
//! A thing that turns or comes nearer moves differently from end to end, in agreement with one epipole by itself. What
//! moves by itself has a size, though: N is taken without the groups in any one place, at its largest. A camera that
//! moved has parallax in more than one.
//!
//! A group whose parallax is `d` px long agrees within `b` px by chance with the probability that its direction is one of
//! those that pass the epipole so nearly: `p = 2/π · asin(b / d)`.
//!
//! Distinctive matches are found to a pixel, so parallax of less than some pixels does not show in them. The refined ones
//! are finer, but were found along the lines of F, in a band about them: what has nothing to do with F lies anywhere in
//! it, so that a group is within a third of the band's half width by chance with probability ⅓.

use nalgebra::Matrix3;

use crate::estimate::patches::{BAND, Support};
use crate::geometry::{FundamentalMatrix, Point, PointPair, Vector, finite_point};

/// What lies off the largest plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OffPlane {
    /// Groups of matches that move alike, and how many of them agree with F.
    pub groups: usize,
    pub agreeing: usize,
    /// Epipoles, of those that two groups determine, with which so many agree if they have nothing to do with any.
    pub by_chance: f64,
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
/// How far from its middle a thing that moves by itself reaches, as a fraction of the longer side.
const THING: f64 = 0.15;

/// Matches off the plane that move alike.
#[derive(Debug, Clone, Copy)]
struct Group {
    /// Their middle in image 1.
    place: Point,
    agrees: bool,
    /// Probability that a group like this agrees by chance.
    chance: f64,
}

impl OffPlane {
    /// The distinctive matches off the plane with homography `h`, and how `f` agrees with them, in pixels of the level;
    /// `side` is the longer side of image 1.
    pub fn new(support: &Support, f: &FundamentalMatrix, h: &Matrix3<f64>, side: f64) -> Self {
        let off = parallaxes(&support.distinctive(), h, OFF_PLANE);
        let group = |members: Vec<usize>| {
            let near = |k: &&usize| {
                let pair = &off[**k].0;
                f.line2_from_point1(pair.point1).is_some_and(|line| line.distance(pair.point2) <= BAND)
            };
            let length = members.iter().map(|k| off[*k].1.norm()).sum::<f64>() / members.len() as f64;
            Group {
                place: middle(&off, &members),
                // A group agrees as a whole.
                agrees: 2 * members.iter().filter(near).count() > members.len(),
                chance: (BAND / length).min(1.0).asin() * std::f64::consts::FRAC_2_PI,
            }
        };
        let groups: Vec<Group> = moving_alike(&off, ALIKE).into_iter().map(group).collect();
        Self::of(&groups, THING * side)
    }

    /// The same of refined matches, in full-size pixels; a match is on the plane within `tolerance` px.
    pub fn refined(
        matches: &[PointPair],
        f: &FundamentalMatrix,
        h: &Matrix3<f64>,
        tolerance: f64,
        side: f64,
    ) -> Self {
        let off = parallaxes(matches, h, REFINED_OFF_PLANE * tolerance);
        let group = |members: Vec<usize>| {
            let distances = members.iter().filter_map(|k| {
                Some(f.line2_from_point1(off[*k].0.point1)?.signed_distance(off[*k].0.point2))
            });
            Group {
                place: middle(&off, &members),
                agrees: (distances.sum::<f64>() / members.len() as f64).abs() < REFINED_BAND,
                chance: REFINED_CHANCE,
            }
        };
        let groups: Vec<Group> =
            moving_alike(&off, REFINED_ALIKE * tolerance).into_iter().map(group).collect();
        Self::of(&groups, THING * side)
    }

    fn of(groups: &[Group], thing: f64) -> Self {
        let agreeing = groups.iter().filter(|group| group.agrees).count();
        // Without what is around each agreeing group in turn.
        let without = |left_out: &Group| {
            number_by_chance(
                groups.iter().filter(|group| (group.place - left_out.place).norm() > thing).copied(),
            )
        };
        let by_chance = groups
            .iter()
            .filter(|group| group.agrees)
            .map(without)
            .fold(number_by_chance(groups.iter().copied()), f64::max);
        Self { groups: groups.len(), agreeing, by_chance }
    }
}

/// Matches that are more than `least` px off the plane, each with its parallax.
fn parallaxes(matches: &[PointPair], h: &Matrix3<f64>, least: f64) -> Vec<(PointPair, Vector)> {
    let parallax = |pair: &PointPair| {
        let parallax = pair.point2 - finite_point(&(h * pair.point1.to_homogeneous()))?;
        (parallax.norm() > least).then_some((*pair, parallax))
    };
    matches.iter().filter_map(parallax).collect()
}

fn middle(off: &[(PointPair, Vector)], members: &[usize]) -> Point {
    let sum: Vector = members.iter().map(|k| off[*k].0.point1.coords).sum();
    Point::from(sum / members.len() as f64)
}

/// Numbers of the matches that belong to one motion each: those that move like the first of them, wherever they are. A
/// surface that runs in depth moves differently from end to end, which nothing does that is only shifted.
fn moving_alike(off: &[(PointPair, Vector)], alike: f64) -> Vec<Vec<usize>> {
    let mut is_grouped = vec![false; off.len()];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (seed, (_, parallax)) in off.iter().enumerate() {
        if is_grouped[seed] {
            continue;
        }
        let members: Vec<usize> = (seed..off.len())
            .filter(|k| !is_grouped[*k] && (off[*k].1 - parallax).norm() < alike)
            .collect();
        for k in &members {
            is_grouped[*k] = true;
        }
        groups.push(members);
    }
    groups
}

/// N above.
fn number_by_chance(groups: impl Iterator<Item = Group>) -> f64 {
    let (mut count, mut agreeing, mut sum) = (0usize, 0usize, 0.0);
    for group in groups {
        count += 1;
        agreeing += usize::from(group.agrees);
        sum += group.chance;
    }
    if count < 3 {
        return f64::INFINITY;
    }
    let epipoles = (count * (count - 1) / 2) as f64;
    epipoles * at_least(agreeing.saturating_sub(2), count - 2, sum / count as f64)
}

/// Upper bound of the probability that at least `k` of `n` independent events happen, which have a mean probability of
/// `p` (Chernoff 1952, for unequal probabilities Hoeffding 1963).
fn at_least(k: usize, n: usize, p: f64) -> f64 {
    let share = k as f64 / n as f64;
    if share <= p {
        return 1.0;
    }
    let term = |a: f64, b: f64| if a > 0.0 { a * (a / b).ln() } else { 0.0 };
    (-(n as f64) * (term(share, p) + term(1.0 - share, 1.0 - p))).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_holds_and_is_near() {
        // Binomial tails: 5 of 10 at ½ is 0.623, 9 of 10 at 0.3 is 1.4e-4, 4 of 4 at ½ is exact.
        assert!((at_least(4, 4, 0.5) - 1.0 / 16.0).abs() < 1e-12);
        assert_eq!(at_least(5, 10, 0.5), 1.0);
        let bound = at_least(9, 10, 0.3);
        assert!(bound > 1.4e-4 && bound < 1.4e-3, "{bound}");
        assert_eq!(at_least(0, 4, 0.2), 1.0);
    }

    #[test]
    fn what_moves_alike_is_one_motion_wherever_it_is() {
        let moved =
            |x: f64, y: f64, dx: f64, dy: f64| (PointPair::new(x, y, x + dx, y + dy), Vector::new(dx, dy));
        let off = [
            moved(10.0, 10.0, 8.0, 0.0),
            moved(40.0, 10.0, 9.0, 1.0),
            moved(70.0, 12.0, 10.0, 1.5),
            moved(20.0, 10.0, -8.0, 0.0),
            moved(400.0, 10.0, 8.0, 0.0),
        ];
        assert_eq!(moving_alike(&off, ALIKE), [vec![0, 1, 2, 4], vec![3]]);
        let deeper =
            [moved(10.0, 10.0, 8.0, 0.0), moved(20.0, 10.0, 10.0, 0.0), moved(30.0, 10.0, 12.0, 0.0)];
        assert_eq!(moving_alike(&deeper, ALIKE).len(), 2, "a surface in depth");
    }

    /// Groups of which each fourth is in a row of places, `apart` px from each other.
    fn groups(agreeing: usize, other: usize, apart: f64) -> Vec<Group> {
        let at = |k: usize| Point::new(apart * k as f64, 100.0);
        let group = |k: usize| Group { place: at(k), agrees: k < agreeing, chance: 0.1 };
        (0..agreeing + other).map(group).collect()
    }

    #[test]
    fn two_motions_fit_any_epipole_and_many_places_hold_one() {
        for (agreeing, other) in [(0, 9), (2, 0), (2, 20), (3, 20), (5, 25)] {
            let found = OffPlane::of(&groups(agreeing, other, 100.0), 90.0);
            assert_eq!((found.groups, found.agreeing), (agreeing + other, agreeing));
            assert!(found.by_chance > 0.1, "{agreeing} of {}: {}", agreeing + other, found.by_chance);
        }
        let held = OffPlane::of(&groups(12, 4, 100.0), 90.0);
        assert!(held.by_chance < 1e-4, "{}", held.by_chance);
    }

    #[test]
    fn one_thing_alone_holds_no_epipole_however_many_motions_it_has() {
        // Twenty groups within 60 px of each other, and others elsewhere that do not agree.
        let mut all = groups(20, 0, 3.0);
        all.extend(groups(0, 6, 100.0).into_iter().map(|g| Group { place: g.place + Vector::new(200.0, 0.0), ..g }));
        let thing = OffPlane::of(&all, 90.0);
        assert!(thing.by_chance > 1.0, "{}", thing.by_chance);
        let spread = OffPlane::of(&all, 20.0);
        assert!(spread.by_chance < 1e-3, "{}", spread.by_chance);
    }
}
