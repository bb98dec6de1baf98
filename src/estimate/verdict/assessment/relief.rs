//! Test whether parallax that no smooth warp explains points along the epipolar lines.
//!
//! A camera that turns behind a lens, a curved sheet and a rolling shutter all move points
//! smoothly, which looks like the parallax of a camera that moves. So does a poster that is not
//! quite flat. None of them determines the epipole.
//!
//! Null hypothesis: the matches follow one smooth warp, `x2 = H(x1) + p(x1) + r(x1)`, with a
//! homography `H`, polynomials `p` of degree 4, and cubic splines `r` of the row (a rolling shutter).
//! Matches beside the warp are wrong, and lie in any direction from their place
//! on it. If the epipole is right, they lie along their epipolar lines.
//!
//! Only matches that were found without the geometry are evidence: the others lie on the lines by
//! construction. A match must also be likelier than its place on the warp. Along an edge and on repeated
//! structure, the match and its place look alike. Matches then slide in one direction, as if they had
//! parallax.

use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::estimate::evidence::patches::{LIKELY, UnguidedMatch, one_a_place};
use crate::estimate::fit::{Follows, Warp, largest_plane};
use crate::estimate::verdict::constants::{ALONG, ANY_EPIPOLE, CLEARLY_LIKELY, LARGEST_PARALLAX};
use crate::estimate::verdict::trust::{Relief, Witnesses};
use crate::geometry::{Frame, FundamentalMatrix, Line, Point, PointPair, Vector, transfer_error};

/// Log-odds of a match against another place in image 2. `None` if that place does not resemble its point in
/// image 1, or is the place of the match itself. The match counts then.
pub(super) type LeadOver<'a> = &'a (dyn Fn(&PointPair, Point) -> Option<f32> + Sync);

/// A match beside the warp.
pub(super) struct Beside {
    pair: PointPair,
    /// Its displacement from its place on the warp, px.
    off: Vector,
    /// Parts of its displacement along and across its epipolar line, px.
    along: f64,
    across: f64,
}

impl Beside {
    /// Takes apart the displacement of a match from its place on the warp, by its epipolar line in image 2.
    pub(super) fn new(pair: PointPair, off: Vector, line2: &Line) -> Self {
        // The part across the line, from the distances of both ends.
        let across = (line2.signed_distance(pair.point2) - line2.signed_distance(pair.point2 - off)).abs();
        Self::at(pair, off, across)
    }

    /// Takes apart the displacement of a match whose part across its line is known.
    pub(super) fn at(pair: PointPair, off: Vector, across: f64) -> Self {
        let along = (off.norm_squared() - across * across).max(0.0).sqrt();
        Self { pair, off, along, across }
    }
}

/// A geometry, and the matches that a smooth warp may explain. All are in full-size pixels.
pub(super) struct WarpTest<'a> {
    pub f: &'a FundamentalMatrix,
    /// Matches along the lines of the geometry, to which the warp is fitted.
    pub matches: &'a [PointPair],
    /// Their largest plane.
    pub h: &'a Matrix3<f64>,
    /// Matches that were found without the geometry.
    pub unguided: &'a [UnguidedMatch],
    pub lead_over: LeadOver<'a>,
    pub frame: Frame,
    /// Largest error of a match on the warp, px.
    pub tolerance: f64,
    pub seed: u64,
}

impl WarpTest<'_> {
    /// Counts the matches that were found without the geometry and lie beside a smooth warp, along their epipolar lines
    /// and across them. `None` if no warp can be fitted.
    pub fn relief(&self) -> Option<Relief> {
        let Self { matches, h, frame, tolerance, seed, .. } = *self;
        let fit = |follows| Warp::fit(matches, h, frame, tolerance, follows);
        let (warp, finer) = (fit(Follows::Rows)?, fit(Follows::RowsClosely)?);
        let (mut on_warp, mut besides) = self.beside(&warp, LIKELY);
        let [clear, finer] = [(&warp, CLEARLY_LIKELY), (&finer, LIKELY)].map(|(warp, least)| {
            let (on_warp, besides) = self.beside(warp, least);
            counted(&besides, on_warp, tolerance)
        });
        let first = counted(&besides, on_warp, tolerance);
        for _ in 0..ANY_EPIPOLE {
            let pairs: Vec<PointPair> = besides.iter().map(|m| m.pair).collect();
            let Some((h, _)) = largest_plane(&pairs, tolerance, seed) else { break };
            let all = besides.len();
            besides.retain(|m| transfer_error(&h, &m.pair) >= tolerance);
            on_warp += all - besides.len();
        }
        Some(Relief { beside: first, further: counted(&besides, on_warp, tolerance), finer, clear })
    }

    /// Returns the number of matches on the warp, and the matches beside it, of those with a probability above
    /// `least`. Matches far from the warp are left out.
    fn beside(&self, warp: &Warp, least: f32) -> (usize, Vec<Beside>) {
        let side = self.frame.longer_side();
        let mut on_warp = 0;
        let mut beside = Vec::new();
        for pair in one_a_place(self.unguided, least) {
            let Some(off) = warp.beside(&pair) else { continue };
            let distance = off.norm();
            if distance <= self.tolerance {
                on_warp += 1;
            } else if distance < LARGEST_PARALLAX * side
                && let Some(line) = self.f.line2_from_point1(pair.point1)
            {
                beside.push(Beside::new(pair, off, &line));
            }
        }
        likelier_beside(on_warp, beside, self.lead_over)
    }
}

/// Moves the matches that are likelier on the warp than beside it to those on the warp. The prior odds of the
/// warp are the ratio of both numbers, but even if most matches lie beside it.
pub(super) fn likelier_beside(
    on_warp: usize,
    beside: Vec<Beside>,
    lead_over: LeadOver,
) -> (usize, Vec<Beside>) {
    let all = on_warp + beside.len();
    let warp_odds = (on_warp as f32 / beside.len().max(1) as f32).max(1.0).ln();
    let is_likelier =
        |m: &Beside| lead_over(&m.pair, m.pair.point2 - m.off).is_none_or(|lead| lead > warp_odds);
    let beside: Vec<Beside> = beside.into_par_iter().filter(is_likelier).collect();
    (all - beside.len(), beside)
}

/// Counts the matches beside a warp by their direction.
pub(super) fn counted(beside: &[Beside], on_warp: usize, tolerance: f64) -> Witnesses {
    let count = |is: fn(&Beside, f64) -> bool| beside.iter().filter(|m| is(m, tolerance)).count();
    Witnesses {
        on_warp,
        along: count(|m, _| m.across <= ALONG * m.along),
        across: count(|m, _| m.along <= ALONG * m.across),
        off: count(|m, tolerance| m.across > ALONG * m.along && m.across > tolerance),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME, rows};
    use crate::geometry::homography;

    fn test<'a>(
        f: &'a FundamentalMatrix,
        matches: &'a [PointPair],
        h: &'a Matrix3<f64>,
        unguided: &'a [UnguidedMatch],
    ) -> WarpTest<'a> {
        WarpTest { f, matches, h, unguided, lead_over: &|_, _| None, frame: FRAME, tolerance: 1.0, seed: 0 }
    }

    fn of(matches: &[PointPair], f: &FundamentalMatrix) -> Witnesses {
        all(matches, f).beside
    }

    fn all(matches: &[PointPair], f: &FundamentalMatrix) -> Relief {
        let h = homography(matches).unwrap();
        let found: Vec<UnguidedMatch> =
            matches.iter().map(|pair| UnguidedMatch { pair: *pair, prior: 0.9 }).collect();
        test(f, matches, &h, &found).relief().unwrap()
    }

    /// A camera that turns behind a lens: a homography between radially distorted images.
    fn through_a_lens(point1: Point) -> PointPair {
        let (middle, half) = (FRAME.centre(), 0.5 * FRAME.longer_side());
        let bent = |p: Point, k: f64| {
            let x = (p - middle) / half;
            middle + x * (half * (1.0 + k * x.norm_squared()))
        };
        let straight = bent(point1, 0.1) - middle;
        let turned = middle
            + Vector::new(0.98 * straight.x - 0.1 * straight.y + 20.0, 0.1 * straight.x + 0.98 * straight.y)
                / (1.0 + 4e-4 * straight.x);
        PointPair { point1, point2: bent(turned, -0.08) }
    }

    fn grid() -> impl Iterator<Item = Point> {
        (0..400).map(|k| Point::new(8.0 + 15.0 * f64::from(k % 20), 6.0 + 11.0 * f64::from(k / 20)))
    }

    #[test]
    fn a_camera_that_turns_behind_a_lens_has_no_witnesses_and_a_scene_in_depth_has() {
        let scene = ExactScene::aside();
        let f = scene.fundamental();
        let turned: Vec<PointPair> = grid().map(through_a_lens).collect();
        let found = of(&turned, &f);
        assert!(found.on_warp > 390 && !found.show_the_epipole(), "{found:?}");
        // A fifth of wrong matches, each somewhere else.
        let mut partly = turned.clone();
        for (k, m) in partly.iter_mut().enumerate().filter(|(k, _)| k % 5 == 0) {
            let angle = 2.4 * k as f64;
            m.point2 += Vector::new(angle.cos(), angle.sin()) * (2.0 + 12.0 * (k as f64 * 0.618).fract());
        }
        let found = of(&partly, &f);
        assert!(found.along + found.across > 20 && !found.show_the_epipole(), "{found:?}");
        let deep: Vec<PointPair> =
            grid().map(|p| PointPair { point1: p, point2: scene.partner(p) }).collect();
        let found = of(&deep, &f);
        assert!(found.along > 50 && found.across == 0 && found.show_the_epipole(), "{found:?}");
        // Lines across the parallax.
        let columns =
            FundamentalMatrix::from_rank_two(Matrix3::new(0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0));
        let found = of(&deep, &columns.unwrap());
        assert!(found.across > found.along && !found.show_the_epipole(), "{found:?}");
    }

    #[test]
    fn matches_that_are_equalled_elsewhere_show_no_epipole() {
        let scene = ExactScene::aside();
        let pairs: Vec<PointPair> =
            grid().map(|p| PointPair { point1: p, point2: scene.partner(p) }).collect();
        let h = homography(&pairs).unwrap();
        let clear = |prior: f32| {
            let found: Vec<UnguidedMatch> =
                pairs.iter().map(|pair| UnguidedMatch { pair: *pair, prior }).collect();
            let found = test(&scene.fundamental(), &pairs, &h, &found).relief().unwrap();
            assert!(found.beside.show_the_epipole(), "{found:?}");
            found.clear.show_the_epipole()
        };
        assert!(clear(0.9) && !clear(0.51));
    }

    #[test]
    fn matches_whose_places_on_the_warp_look_alike_show_no_epipole() {
        let scene = ExactScene::aside();
        let f = scene.fundamental();
        let pairs: Vec<PointPair> =
            grid().map(|p| PointPair { point1: p, point2: scene.partner(p) }).collect();
        let h = homography(&pairs).unwrap();
        let found: Vec<UnguidedMatch> =
            pairs.iter().map(|pair| UnguidedMatch { pair: *pair, prior: 0.9 }).collect();
        // Log-odds of each match against its place on the warp.
        let [clear, equal] = [3.0, 0.0].map(|lead| {
            let lead_over: LeadOver = &|_, _| Some(lead);
            WarpTest { lead_over, ..test(&f, &pairs, &h, &found) }.relief().unwrap().beside
        });
        assert!(clear.show_the_epipole(), "{clear:?}");
        assert!(clear.along > 50 && equal.along + equal.off == 0, "{equal:?}");
        assert_eq!(equal.on_warp, clear.on_warp + clear.along + clear.off);
    }

    #[test]
    fn the_warp_is_likelier_beforehand_if_most_matches_follow_it_and_even_otherwise() {
        let beside = |count: usize| -> Vec<Beside> {
            let pair = PointPair::new(50.0, 50.0, 55.0, 50.0);
            (0..count).map(|_| Beside::at(pair, Vector::new(5.0, 0.0), 0.0)).collect()
        };
        let left = |on_warp: usize, lead: f32| {
            let (on_warp_then, left) = likelier_beside(on_warp, beside(10), &|_, other2| {
                assert_eq!(other2, Point::new(50.0, 50.0));
                Some(lead)
            });
            assert_eq!(on_warp_then, on_warp + 10 - left.len());
            left.len()
        };
        // ln(100 / 10) = 2.3
        assert_eq!([left(100, 2.2), left(100, 2.4)], [0, 10]);
        assert_eq!([left(2, -0.1), left(2, 0.1)], [0, 10]);
        assert_eq!(likelier_beside(3, Vec::new(), &|_, _| None).0, 3);
    }

    #[test]
    fn rows_that_swing_are_a_smooth_warp() {
        let swung = |p: Point| {
            let shift = 6.0 * (p.y * 0.05).sin();
            PointPair { point1: p, point2: Point::new(p.x + shift, p.y + 0.5 * shift) }
        };
        let matches: Vec<PointPair> = grid().map(swung).collect();
        let found = of(&matches, &ExactScene::aside().fundamental());
        assert!(found.on_warp > 380, "{found:?}");
    }

    #[test]
    fn two_flat_things_that_slide_along_the_lines_are_no_relief_beside_further_planes() {
        let slid = |point1: Point| {
            let shift = match (point1.x, point1.y) {
                (x, y) if x < 90.0 && y < 110.0 => 9.0,
                (x, y) if x > 220.0 && y > 130.0 => -6.0,
                _ => 0.0,
            };
            PointPair { point1, point2: point1 + Vector::new(shift, 0.0) }
        };
        let slid: Vec<PointPair> = grid().map(slid).collect();
        let found = all(&slid, &rows(0.0));
        // Beside the edges of the things, the warp pulls some matches of the background along.
        assert!(found.beside.along > 100 && found.further.along < 20, "{found:?}");
        assert!(!found.further.show_the_epipole(), "{found:?}");
    }
}
