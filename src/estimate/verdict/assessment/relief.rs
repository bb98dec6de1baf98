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
//! construction.

use nalgebra::Matrix3;

use crate::estimate::evidence::patches::{LIKELY, UnguidedMatch, one_a_place};
use crate::estimate::fit::{Follows, Warp, largest_plane};
use crate::estimate::verdict::constants::{ALONG, ANY_EPIPOLE, CLEARLY_LIKELY, LARGEST_PARALLAX};
use crate::estimate::verdict::trust::{Relief, Witnesses};
use crate::geometry::{Frame, FundamentalMatrix, Line, PointPair, Vector, transfer_error};

/// A match beside the warp.
pub(super) struct Beside {
    pair: PointPair,
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
        Self { pair, along, across }
    }
}

/// Counts the matches that were found without the geometry and lie beside a smooth warp of `matches`,
/// along the lines of `f` and across them. All are in full-size pixels; `h` is the largest plane, and
/// `tolerance` the largest error of a match on the warp. `None` if no warp can be fitted.
pub(super) fn relief(
    found: &[UnguidedMatch],
    matches: &[PointPair],
    h: &Matrix3<f64>,
    f: &FundamentalMatrix,
    frame: Frame,
    tolerance: f64,
    seed: u64,
) -> Option<Relief> {
    let fit = |follows| Warp::fit(matches, h, frame, tolerance, follows);
    let side = frame.longer_side();
    let beside = |warp: &Warp, least| besides(found, warp, f, side, tolerance, least);
    let (warp, finer) = (fit(Follows::Rows)?, fit(Follows::RowsClosely)?);
    let (mut on_warp, mut besides) = beside(&warp, LIKELY);
    let [clear, finer] = [(&warp, CLEARLY_LIKELY), (&finer, LIKELY)].map(|(warp, least)| {
        let (on_warp, besides) = beside(warp, least);
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
fn besides(
    found: &[UnguidedMatch],
    warp: &Warp,
    f: &FundamentalMatrix,
    side: f64,
    tolerance: f64,
    least: f32,
) -> (usize, Vec<Beside>) {
    let mut on_warp = 0;
    let mut beside = Vec::new();
    for pair in one_a_place(found, least) {
        let Some(off) = warp.beside(&pair) else { continue };
        let distance = off.norm();
        if distance <= tolerance {
            on_warp += 1;
        } else if distance < LARGEST_PARALLAX * side
            && let Some(line) = f.line2_from_point1(pair.point1)
        {
            beside.push(Beside::new(pair, off, &line));
        }
    }
    (on_warp, beside)
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
    use crate::geometry::{Point, homography};

    fn of(matches: &[PointPair], f: &FundamentalMatrix) -> Witnesses {
        all(matches, f).beside
    }

    fn all(matches: &[PointPair], f: &FundamentalMatrix) -> Relief {
        let h = homography(matches).unwrap();
        let found: Vec<UnguidedMatch> =
            matches.iter().map(|pair| UnguidedMatch { pair: *pair, prior: 0.9 }).collect();
        relief(&found, matches, &h, f, FRAME, 1.0, 0).unwrap()
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
            let found = relief(&found, &pairs, &h, &scene.fundamental(), FRAME, 1.0, 0).unwrap();
            assert!(found.beside.show_the_epipole(), "{found:?}");
            found.clear.show_the_epipole()
        };
        assert!(clear(0.9) && !clear(0.51));
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
