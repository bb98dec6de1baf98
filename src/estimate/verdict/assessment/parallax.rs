//! Test whether parallax determines the epipoles. A stationary or rotating camera sees no parallax,
//! but objects may move.
//!
//! If one homography explains most matches, these matches do not determine where the epipolar lines
//! meet. The parallax of a static point off the plane points along the line through the epipole. A
//! moving object has a motion in any direction. An epipole has two degrees of freedom, so some
//! epipole fits any **two** independent motions. Therefore the matches off the plane are grouped by
//! common motion, without F. If a group is unrelated to F, its parallax of `d` px has any
//! direction, and comes within `e` px of the line with probability
//!
//! ```text
//!     p = 2/π · asin(e / d).
//! ```
//!
//! Then `−ln p` is exponentially distributed, and a sum of `n` of them has the gamma distribution
//! (Fisher 1932). Each two of `n` groups determine an epipole, which the other groups test:
//!
//! ```text
//!     N = n (n − 1) / 2 · P(Γ(n − 2) ≥ − Σ ln p of all but the two best)
//! ```
//!
//! is the expected number of epipoles that do as well as the epipole of F by chance. It is a number
//! of false alarms (Desolneux, Moisan & Morel 2000; Moisan & Stival 2004 for F).
//! Several groups of equal motion may be one body, like two halves of a picture pulled apart. So N
//! is also computed of motions: each counts once, with its mean. Some matches are always wrong. On
//! repeated patterns (lines of print) they are shifted along the pattern, like points at another
//! depth. Therefore a motion supports F only with more matches than are wrong in total.
//!
//! Three kinds of matches are used. Distinctive matches are precise to a pixel, so they do not show
//! smaller parallax. The likely unguided matches near the plane, and corners matched near their place
//! on it, are aligned to a fraction of a pixel. Both kinds are found without F. Clicked pairs are the
//! third kind. F was fitted to them, but the fit uses up no more than the two groups that N leaves out.

use nalgebra::Matrix3;

use crate::estimate::evidence::patches::BAND;
use crate::estimate::fit::MEDIAN;
use crate::estimate::fit::false_alarms::PRECISION;
use crate::estimate::verdict::constants::{
    CLICK_DEVIATIONS, DEVIATIONS, ONE_GROUP, ONE_MOTION, WRONG_TOGETHER,
};
use crate::estimate::verdict::trust::{Distinctive, OffPlane, fewer_than};
use crate::geometry::{FundamentalMatrix, PointPair, Vector, finite_point, median};

/// Matches off the plane that move alike.
#[derive(Debug, Clone, Copy)]
struct MotionGroup {
    matches: usize,
    parallax: Vector,
    /// Median distance from the epipolar lines, px.
    off_line: f64,
    /// Standard deviation of this distance, px.
    precision: f64,
}

/// Returns the standard deviation of the coordinates of matches, most of which agree with `f`, px.
/// It follows from their distances from the lines. It is no evidence for `f` if most matches lie on
/// one plane: the lines of any epipole pass through them.
pub(super) fn precision(matches: &[PointPair], f: &FundamentalMatrix) -> f64 {
    let distance = |m: &PointPair| Some(f.line2_from_point1(m.point1)?.distance(m.point2));
    (median(matches.iter().filter_map(distance)) / MEDIAN).max(PRECISION)
}

impl MotionGroup {
    /// Returns `− ln p`.
    fn surprise(&self) -> f64 {
        let ratio = (self.off_line.max(self.precision) / self.parallax.norm()).min(1.0);
        -(ratio.asin() * std::f64::consts::FRAC_2_PI).ln()
    }
}

impl OffPlane {
    /// Groups the matches off the plane with homography `h` and compares them with `f`. `sigma` is
    /// the standard deviation of a coordinate, `side` the longer side of image 1, px.
    pub fn new(
        matches: &[PointPair],
        f: &FundamentalMatrix,
        h: &Matrix3<f64>,
        side: f64,
        sigma: f64,
    ) -> Self {
        // Many matches are tested, so noise seldom reaches twice the limit.
        let off = parallaxes(matches, h, 2.0 * DEVIATIONS * sigma);
        let group = |members: Vec<usize>| {
            let count = members.len() as f64;
            let distance = |PointPair { point1, point2 }: PointPair| {
                Some(f.line2_from_point1(point1)?.signed_distance(point2))
            };
            MotionGroup {
                matches: members.len(),
                parallax: members.iter().map(|k| off[*k].1).sum::<Vector>() / count,
                // Only the epipole has no line, and is off it by nothing.
                off_line: median(members.iter().filter_map(|k| distance(off[*k].0))).abs(),
                precision: sigma / count.sqrt(),
            }
        };
        let groups: Vec<MotionGroup> =
            moving_alike(&off, CLICK_DEVIATIONS * sigma, ONE_GROUP * side).into_iter().map(group).collect();
        Self::of(&groups, sigma, WRONG_TOGETHER * matches.len() as f64)
    }

    /// Returns the evidence of groups, of whose matches `wrong` are expected to be wrong.
    fn of(groups: &[MotionGroup], sigma: f64, wrong: f64) -> Self {
        let agrees = |group: &&MotionGroup| group.off_line <= DEVIATIONS * sigma;
        let motions = motions(groups, CLICK_DEVIATIONS * sigma);
        let is_held = |motion: &&Vec<&MotionGroup>| {
            motion.iter().map(|group| group.matches).sum::<usize>() as f64 > wrong
        };
        let agreeing_motions = motions.iter().filter(is_held).filter(|motion| motion.iter().any(&agrees));
        let by_chance = |motions: &mut dyn Iterator<Item = &Vec<&MotionGroup>>| {
            number_by_chance(motions.map(|motion| mean_surprise(motion)).collect())
        };
        Self {
            groups: groups.len(),
            agreeing: groups.iter().filter(agrees).count(),
            motions: agreeing_motions.count(),
            by_chance: number_by_chance(groups.iter().map(MotionGroup::surprise).collect()),
            // A motion of few matches may contradict F, but not support it.
            motions_by_chance: by_chance(&mut motions.iter())
                .max(by_chance(&mut motions.iter().filter(is_held))),
        }
    }
}

/// Counts the distinctive matches, and those that contradict `f`: they are off their lines by twice the error of corners
/// and of a good `F`. All are in pixels of the level.
pub(super) fn contradicting(distinctive: &[PointPair], f: &FundamentalMatrix) -> Distinctive {
    let is_off = |pair: &&PointPair| {
        f.line2_from_point1(pair.point1).is_none_or(|line| line.distance(pair.point2) > 2.0 * BAND)
    };
    Distinctive { all: distinctive.len(), off: distinctive.iter().filter(is_off).count() }
}

/// Returns the matches that are more than `least` px off the plane, each with its parallax.
fn parallaxes(matches: &[PointPair], h: &Matrix3<f64>, least: f64) -> Vec<(PointPair, Vector)> {
    let parallax = |pair: &PointPair| {
        let parallax = pair.point2 - finite_point(&(h * pair.point1.to_homogeneous()))?;
        (parallax.norm() > least).then_some((*pair, parallax))
    };
    matches.iter().filter_map(parallax).collect()
}

/// Groups matches near each other that move alike. Returns the indices of the matches of each
/// group. All matches of a group move like its first one, so a surface in depth, whose parallax
/// varies, is split into several groups.
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

/// Collects groups of equal motion from the whole image.
fn motions(groups: &[MotionGroup], alike: f64) -> Vec<Vec<&MotionGroup>> {
    let mut motions: Vec<Vec<&MotionGroup>> = Vec::new();
    for group in groups {
        let is_alike = |motion: &&mut Vec<&MotionGroup>| {
            let first = motion[0].parallax;
            (first - group.parallax).norm() <= alike.max(ONE_MOTION * first.norm())
        };
        match motions.iter_mut().find(is_alike) {
            Some(motion) => motion.push(group),
            None => motions.push(vec![group]),
        }
    }
    motions
}

fn mean_surprise(motion: &[&MotionGroup]) -> f64 {
    motion.iter().map(|group| group.surprise()).sum::<f64>() / motion.len() as f64
}

/// Returns N above, from the values of `− ln p`.
fn number_by_chance(mut surprises: Vec<f64>) -> f64 {
    let count = surprises.len();
    if count < 3 {
        return f64::INFINITY;
    }
    surprises.sort_by(f64::total_cmp);
    let others = &surprises[..count - 2];
    (count * (count - 1) / 2) as f64 * gamma_tail(others.len(), others.iter().sum())
}

/// Returns the probability that a sum of `n` exponentially distributed numbers of mean 1 is at
/// least `sum`.
fn gamma_tail(n: usize, sum: f64) -> f64 {
    fewer_than(n, sum).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_of_the_gamma_distribution() {
        assert!((gamma_tail(1, 2.0) - (-2f64).exp()).abs() < 1e-12);
        assert!((gamma_tail(3, 2.0) - (-2f64).exp() * 5.0).abs() < 1e-12);
        assert!((gamma_tail(5, 0.0) - 1.0).abs() < 1e-12);
        assert!(gamma_tail(40, 160.0) < 1e-20);
    }

    #[test]
    fn neighbours_that_move_alike_are_one_group() {
        let moved =
            |x: f64, y: f64, dx: f64, dy: f64| (PointPair::new(x, y, x + dx, y + dy), Vector::new(dx, dy));
        let off = [
            moved(10.0, 10.0, 8.0, 0.0),
            moved(40.0, 10.0, 9.0, 1.0),
            moved(70.0, 12.0, 10.0, 1.5),
            moved(20.0, 10.0, -8.0, 0.0),
            moved(400.0, 10.0, 8.0, 0.0),
        ];
        assert_eq!(moving_alike(&off, 3.0, 100.0), [vec![0, 1, 2], vec![3], vec![4]]);
        let deeper =
            [moved(10.0, 10.0, 8.0, 0.0), moved(20.0, 10.0, 10.0, 0.0), moved(30.0, 10.0, 12.0, 0.0)];
        assert_eq!(moving_alike(&deeper, 3.0, 100.0).len(), 2, "a surface in depth");
    }

    /// Returns groups of different parallax. Agreeing ones are 0.3 px off their lines, the others
    /// by 0.7 of their parallax.
    fn groups(agreeing: usize, other: usize) -> Vec<MotionGroup> {
        let group = |k: usize| {
            let parallax = Vector::new(8.0 + 5.0 * k as f64, 0.0);
            let off_line = if k < agreeing { 0.3 } else { 0.7 * parallax.x };
            MotionGroup { matches: 3, parallax, off_line, precision: 0.3 }
        };
        (0..agreeing + other).map(group).collect()
    }

    #[test]
    fn some_epipole_fits_any_two_motions_but_not_more() {
        for (agreeing, other) in [(0, 9), (2, 0), (2, 20), (3, 20)] {
            let found = OffPlane::of(&groups(agreeing, other), 0.3, 0.5);
            assert_eq!((found.groups, found.agreeing), (agreeing + other, agreeing));
            assert_eq!(found.motions, agreeing);
            assert!(found.by_chance > 0.1, "{agreeing} of {}: {}", agreeing + other, found.by_chance);
        }
        let held = OffPlane::of(&groups(8, 4), 0.3, 0.5);
        assert!(held.by_chance < 1e-3, "{}", held.by_chance);
    }

    #[test]
    fn many_groups_of_one_motion_count_once() {
        let half = |k: u32| MotionGroup {
            matches: 40,
            parallax: Vector::new(18.0 + 0.1 * f64::from(k), 2.0),
            off_line: 0.1,
            precision: 0.15,
        };
        // One half, seen in twelve places, and three false groups, one of which agrees by chance.
        let halves: Vec<MotionGroup> = (0..12).map(half).chain(groups(1, 2)).collect();
        let found = OffPlane::of(&halves, 0.3, 0.5);
        assert_eq!((found.groups, found.agreeing, found.motions), (15, 13, 2));
        assert!(found.by_chance < 1e-3 && found.motions_by_chance > 1.0, "{found:?}");
        let alone = OffPlane::of(&halves[..12], 0.3, 0.5);
        assert!(alone.motions_by_chance.is_infinite() && alone.motions == 1, "{alone:?}");
    }

    #[test]
    fn motions_with_no_more_matches_than_are_wrong_do_not_count() {
        // One body that is seen everywhere, and matches shifted along a repeated pattern.
        let body = MotionGroup { matches: 900, ..groups(1, 0)[0] };
        let scrolled: Vec<MotionGroup> = std::iter::once(body).chain(groups(9, 0).split_off(1)).collect();
        let motions = |wrong: f64| OffPlane::of(&scrolled, 0.3, wrong);
        assert_eq!((motions(2.9).motions, motions(3.0).motions), (9, 1));
        assert!(motions(2.9).motions_by_chance < 1e-3 && motions(3.0).motions_by_chance > 1.0);
        // Contradicting groups are not left out.
        let contradicted = |wrong: f64| OffPlane::of(&groups(6, 30), 0.3, wrong).motions_by_chance;
        assert!(contradicted(4.0) >= contradicted(0.0));
    }

    #[test]
    fn matches_far_from_their_lines_contradict_a_geometry() {
        let f = crate::estimate::exact::rows(0.0);
        let row = |dy: f64| PointPair::new(15.0, 50.0, 25.0, 50.0 + dy);
        let off = 2.0 * BAND;
        let found = contradicting(&[row(0.0), row(0.9 * off), row(1.1 * off)], &f);
        assert_eq!(found, Distinctive { all: 3, off: 1 });
    }
}
