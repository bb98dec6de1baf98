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

use std::collections::HashSet;

use nalgebra::{DMatrix, DVector, Matrix3};

use crate::estimate::evidence::patches::{LIKELY, UnguidedMatch};
use crate::estimate::fit::largest_plane;
use crate::estimate::verdict::trust::{ALONG, ANY_EPIPOLE, Relief, Witnesses};
use crate::geometry::{
    Frame, FundamentalMatrix, Line, Point, PointPair, Vector, finite_point, transfer_error,
};

/// Degree of the polynomials. Degree 4 follows a strong lens to a tenth of a pixel.
const DEGREE: i32 = 4;
/// Number of knots of the cubic splines of the row inside the picture: a rolling shutter that swings up
/// to three times. Piecewise linear functions of as many knots leave a third of such a swing, which
/// looked like parallax on 7 of 24 results; splines leave it on 1 of 24.
const KNOTS: i32 = 10;
/// Number of knots of the finer warp. Where a shutter swings 2.8 times, 346 matches lie along the lines
/// beside ten knots of linear functions, 134 beside ten of splines, and 3 beside thirteen.
const FINER_KNOTS: i32 = 14;
/// Degree in `x` of the part that differs from row to row: each row is shifted, stretched and bent
/// by the perspective of a turn.
const ACROSS_ROW: i32 = 2;
/// First width of the robust cost, as a share of the longer side: a homography beside a strong lens
/// is off by about as much.
const WIDEST: f64 = 0.01;
/// Ratio of the widths of successive fits.
const NARROWING: f64 = 0.8;
/// Largest number of matches that the warp is fitted to: some twenty for each coefficient.
const FITTED: usize = 1000;
/// Pull towards the homography, in matches. It determines terms that the matches leave open.
const PULL: f64 = 1e-3;
/// Side of the squares of image 1 in which only one match counts, px. Corners and features find
/// the same place twice.
const SAME_PLACE: f64 = 2.0;
/// Least probability of a match that is clearly likelier than all similar places together: by a half. On
/// wallpaper nearly all matches are equalled elsewhere. With 0.7 three of 50 wide pairs would be doubtful.
const CLEARLY_LIKELY: f32 = 0.6;
/// Largest distance from the warp, as a share of the longer side. Wrong matches lie anywhere, most
/// of them farther off.
const FARTHEST: f64 = 0.05;
/// A smooth warp fitted to matches.
struct Warp {
    homography: Matrix3<f64>,
    middle: Point,
    half: f64,
    half_height: f64,
    /// Number of knots of the splines of the row inside the picture.
    knots: i32,
    coefficients: [DVector<f64>; 2],
}

impl Warp {
    /// Fits a warp to most of the matches, starting at the homography `h` of pixels. `tolerance` is
    /// the error of a match that follows the warp, px. `None` if the fit fails.
    fn fit(
        matches: &[PointPair],
        h: &Matrix3<f64>,
        frame: Frame,
        tolerance: f64,
        knots: i32,
    ) -> Option<Self> {
        let side = frame.longer_side();
        let mut warp = Self {
            homography: *h,
            middle: frame.centre(),
            half: 0.5 * side,
            half_height: 0.5 * frame.height as f64,
            knots,
            coefficients: [DVector::zeros(0), DVector::zeros(0)],
        };
        let step = matches.len().div_ceil(FITTED).max(1);
        let rows: Vec<(DVector<f64>, Vector)> = matches
            .iter()
            .step_by(step)
            .map(|m| {
                let mapped = finite_point(&(h * m.point1.to_homogeneous()))?;
                Some((warp.terms(m.point1), m.point2 - mapped))
            })
            .collect::<Option<_>>()?;
        let terms = rows.first()?.0.len();
        warp.coefficients = [DVector::zeros(terms), DVector::zeros(terms)];
        let mut width = WIDEST * side;
        while width > 0.5 * tolerance {
            let mut normal = DMatrix::identity(terms, terms) * PULL;
            let mut right = [DVector::zeros(terms), DVector::zeros(terms)];
            for (terms, shift) in &rows {
                let off = shift - warp.shift(terms);
                let weight = 1.0 / (1.0 + off.norm_squared() / (width * width));
                normal.syger(weight, terms, terms, 1.0);
                right[0].axpy(weight * shift.x, terms, 1.0);
                right[1].axpy(weight * shift.y, terms, 1.0);
            }
            let cholesky = normal.cholesky()?;
            warp.coefficients = right.map(|right| cholesky.solve(&right));
            width *= NARROWING;
        }
        Some(warp)
    }

    /// Returns the displacement of the point of image 2 from its place on the warp, px.
    fn beside(&self, m: &PointPair) -> Option<Vector> {
        let mapped = finite_point(&(self.homography * m.point1.to_homogeneous()))?;
        Some(m.point2 - mapped - self.shift(&self.terms(m.point1)))
    }

    fn shift(&self, terms: &DVector<f64>) -> Vector {
        Vector::new(self.coefficients[0].dot(terms), self.coefficients[1].dot(terms))
    }

    /// Returns the products of powers of both coordinates, and the functions of the row.
    fn terms(&self, point1: Point) -> DVector<f64> {
        let offset = point1 - self.middle;
        let at = offset / self.half;
        let powers = (0..=DEGREE).flat_map(|degree| (0..=degree).map(move |i| (i, degree - i)));
        let smooth = powers.map(|(i, j)| at.x.powi(i) * at.y.powi(j));
        let row = (offset.y / self.half_height + 1.0) * 0.5 * f64::from(self.knots - 1);
        let of_knot = move |knot: i32| cubic_spline(row - f64::from(knot));
        // A spline of a knot just outside reaches into the picture.
        let by_row = (-1..=self.knots).flat_map(|k| (0..=ACROSS_ROW).map(move |i| of_knot(k) * at.x.powi(i)));
        DVector::from_vec(smooth.chain(by_row).collect())
    }
}

/// Returns the cubic B-spline of unit knots at a distance from its centre.
fn cubic_spline(distance: f64) -> f64 {
    match distance.abs() {
        near if near < 1.0 => 2.0 / 3.0 - near * near + 0.5 * near.powi(3),
        far if far < 2.0 => (2.0 - far).powi(3) / 6.0,
        _ => 0.0,
    }
}

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
    let fit = |knots| Warp::fit(matches, h, frame, tolerance, knots);
    let side = frame.longer_side();
    let beside = |warp: &Warp, least| besides(found, warp, f, side, tolerance, least);
    let (warp, finer) = (fit(KNOTS)?, fit(FINER_KNOTS)?);
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
        } else if distance < FARTHEST * side
            && let Some(line) = f.line2_from_point1(pair.point1)
        {
            beside.push(Beside::new(pair, off, &line));
        }
    }
    (on_warp, beside)
}

/// Returns the matches with a probability above `least`, the first at each place of image 1.
pub(super) fn one_a_place(found: &[UnguidedMatch], least: f32) -> impl Iterator<Item = PointPair> {
    let mut taken = HashSet::new();
    let pairs = found.iter().filter(move |m| m.prior > least).map(|m| m.pair);
    pairs.filter(move |PointPair { point1, .. }| {
        taken.insert([point1.x, point1.y].map(|v| (v / SAME_PLACE).round() as i64))
    })
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
