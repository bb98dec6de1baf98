//! Test whether one smooth warp explains the matches. A camera that turns behind a lens, a curved
//! sheet and a rolling shutter all move points smoothly, which looks like the parallax of a camera
//! that moves.
//!
//! Null hypothesis: `x2 = H(x1) + p(x1)`, with a homography `H` and polynomials `p` of degree 4 in
//! both coordinates. Wrong matches lie beside the warp, but anywhere along the epipolar lines. A
//! scene with depth has matches beside the warp that move like their neighbours: relief. Without
//! relief, the epipole is not determined.

use nalgebra::{Matrix3, SMatrix, SVector};

use super::parallax::moving_like_neighbours;
use crate::geometry::{Frame, PointPair, Vector, finite_point};

/// Number of coefficients of a polynomial of degree 4 in two variables. Degree 4 follows a strong
/// lens to a tenth of a pixel.
const TERMS: usize = 15;
const DEGREE: i32 = 4;
/// First width of the robust cost, as a share of the longer side: a homography beside a strong lens
/// is off by about as much.
const WIDEST: f64 = 0.01;
/// Ratio of the widths of successive fits.
const NARROWING: f64 = 0.8;

type Terms = SVector<f64, TERMS>;

/// Returns the share of the matches that are more than `tolerance` px beside the best smooth warp
/// and move like their neighbours, 0 to 1. The fit starts at the homography `h` of pixels. `None` if
/// it fails.
pub(super) fn relief(
    matches: &[PointPair],
    h: &Matrix3<f64>,
    frames: [Frame; 2],
    tolerance: f64,
) -> Option<f64> {
    let side = frames[0].longer_side();
    let (middle, half) = (frames[0].centre(), 0.5 * side);
    let rows: Vec<(Terms, Vector)> = matches
        .iter()
        .map(|m| {
            let mapped = finite_point(&(h * m.point1.to_homogeneous()))?;
            Some((terms((m.point1 - middle) / half), m.point2 - mapped))
        })
        .collect::<Option<_>>()?;
    let mut warp = [Terms::zeros(); 2];
    let beside = |warp: &[Terms; 2], (terms, shift): &(Terms, Vector)| {
        shift - Vector::new(warp[0].dot(terms), warp[1].dot(terms))
    };
    let mut width = WIDEST * side;
    while width > 0.5 * tolerance {
        // A faint pull towards the homography determines terms that the matches leave open.
        let mut normal = SMatrix::<f64, TERMS, TERMS>::identity() * 1e-6;
        let mut right = [Terms::zeros(); 2];
        for row in &rows {
            let weight = 1.0 / (1.0 + beside(&warp, row).norm_squared() / (width * width));
            let (terms, shift) = row;
            normal.ger(weight, terms, terms, 1.0);
            right[0] += terms * (weight * shift.x);
            right[1] += terms * (weight * shift.y);
        }
        let cholesky = normal.cholesky()?;
        warp = right.map(|right| cholesky.solve(&right));
        width *= NARROWING;
    }
    let off: Vec<(PointPair, Vector)> = matches
        .iter()
        .zip(&rows)
        .map(|(m, row)| (*m, beside(&warp, row)))
        .filter(|(_, shift)| shift.norm() > tolerance)
        .collect();
    let count = (0..off.len()).filter(|k| moving_like_neighbours(&off, *k, side)).count();
    Some(count as f64 / matches.len() as f64)
}

/// Returns the products of powers of both coordinates, up to degree 4.
fn terms(x: Vector) -> Terms {
    let powers = (0..=DEGREE).flat_map(|degree| (0..=degree).map(move |i| (i, degree - i)));
    Terms::from_iterator(powers.map(|(i, j)| x.x.powi(i) * x.y.powi(j)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::exact::{ExactScene, FRAME};
    use crate::geometry::{Point, homography};

    fn of(matches: &[PointPair]) -> f64 {
        let h = homography(matches).unwrap();
        relief(matches, &h, [FRAME; 2], 1.0).unwrap()
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

    #[test]
    fn a_camera_that_turns_behind_a_lens_shows_no_relief_and_a_scene_in_depth_does() {
        let points: Vec<Point> = (0..400)
            .map(|k| Point::new(8.0 + 15.0 * f64::from(k % 20), 6.0 + 11.0 * f64::from(k / 20)))
            .collect();
        let turned: Vec<PointPair> = points.iter().map(|p| through_a_lens(*p)).collect();
        assert!(of(&turned) < 0.03, "{}", of(&turned));
        // A fifth of wrong matches, each somewhere else, is no relief.
        let mut partly = turned.clone();
        for (k, m) in partly.iter_mut().enumerate().filter(|(k, _)| k % 5 == 0) {
            m.point2.x += 10.0 + 37.0 * (k as f64 * 0.618).fract();
        }
        assert!(of(&partly) < 0.05, "{}", of(&partly));
        let scene = ExactScene::aside();
        let deep: Vec<PointPair> =
            points.iter().map(|p| PointPair { point1: *p, point2: scene.partner(*p) }).collect();
        assert!(of(&deep) > 0.15, "{}", of(&deep));
    }
}
