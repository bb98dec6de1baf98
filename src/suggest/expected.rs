//! Place of a match, expected from the matches around it.

use nalgebra::{Matrix3, Matrix3x2, Vector3};

use super::ClickedImage;
use crate::geometry::{Point, PointPair};

/// Number of nearest matches: two more than determine an affine map. More of them seldom lie on one
/// surface.
const NEIGHBOURS: usize = 5;
/// Largest deviation of an expected place, as a share of the longer side. Beyond it, the neighbours do not
/// lie on one surface, or the point is far from them.
const LARGEST_DEVIATION: f64 = 0.01;
/// Maximum distance of a match from its expected place, standard deviations.
const DEVIATIONS: f64 = 3.0;
/// Largest ratio of the eigenvalues of the normal matrix. Neighbours in one row determine no affine
/// map.
const ROW: f64 = 1e8;

/// Place of a match, predicted by its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Expected {
    pub at: Point,
    /// Largest distance of the match from `at`, px.
    pub reach: f64,
}

impl Expected {
    /// Fits an affine map to the nearest matches of a point clicked in one image. `side` is the longer side
    /// of the other image, and `resolution` the distance below which two places are one, px. `None` if the
    /// neighbours do not agree.
    pub fn of(
        matches: &[PointPair],
        point: Point,
        clicked: ClickedImage,
        side: f64,
        resolution: f64,
    ) -> Option<Self> {
        let ends = |m: &PointPair| match clicked {
            ClickedImage::First => (m.point1 - point, m.point2),
            ClickedImage::Second => (m.point2 - point, m.point1),
        };
        let mut near: Vec<_> = matches.iter().map(ends).collect();
        if near.len() < NEIGHBOURS {
            return None;
        }
        near.select_nth_unstable_by(NEIGHBOURS - 1, |a, b| a.0.norm_squared().total_cmp(&b.0.norm_squared()));
        let nearest = &near[..NEIGHBOURS];
        let row = |from: &crate::geometry::Vector| Vector3::new(from.x, from.y, 1.0);
        let normal: Matrix3<f64> = nearest.iter().map(|(from, _)| row(from) * row(from).transpose()).sum();
        let spread = normal.symmetric_eigenvalues();
        if spread.max() > ROW * spread.min() {
            return None;
        }
        let inverse = normal.try_inverse()?;
        let right: Matrix3x2<f64> = nearest.iter().map(|(from, to)| row(from) * to.coords.transpose()).sum();
        let affine = inverse * right;
        let squares: f64 =
            nearest.iter().map(|(from, to)| (to.coords - affine.tr_mul(&row(from))).norm_squared()).sum();
        let variance = squares / (2 * (NEIGHBOURS - 3)) as f64;
        // Error of the fit at the point, which is the origin, and of a match there.
        let deviation = (variance * (1.0 + inverse[(2, 2)])).sqrt();
        let at = Point::new(affine[(2, 0)], affine[(2, 1)]);
        let agree = deviation <= LARGEST_DEVIATION * side;
        agree.then_some(Self { at, reach: DEVIATIONS * deviation + resolution })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    /// Returns matches under an affine map, of which the first is `off` px away.
    fn matches(off: f64) -> Vec<PointPair> {
        let at = |k: u32| (f64::from(k % 3) * 20.0, f64::from(k / 3) * 17.0);
        let there = |x: f64, y: f64| Point::new(0.9 * x - 0.2 * y + 30.0, 0.1 * x + 1.1 * y + 8.0);
        let pair = |k: u32| {
            let (x, y) = at(k);
            let off = if k == 0 { off } else { 0.0 };
            PointPair { point1: Point::new(x, y), point2: there(x, y) + Vector::new(off, 0.0) }
        };
        (0..9).map(pair).collect()
    }

    #[test]
    fn a_surface_expects_a_match_and_a_step_in_depth_widens_the_reach() {
        let place =
            |off: f64| Expected::of(&matches(off), Point::new(12.0, 9.0), ClickedImage::First, 640.0, 2.0);
        let exact = place(0.0).unwrap();
        assert!(
            (exact.at - Point::new(0.9 * 12.0 - 0.2 * 9.0 + 30.0, 0.1 * 12.0 + 1.1 * 9.0 + 8.0)).norm()
                < 1e-9
        );
        assert!((exact.reach - 2.0).abs() < 1e-6);
        let wide = place(4.0).unwrap();
        assert!(wide.reach > 4.0 && (wide.at - exact.at).norm() < wide.reach);
        assert_eq!(place(80.0), None);
    }

    #[test]
    fn the_other_image_is_alike_and_few_matches_or_a_row_expect_nothing() {
        let all = matches(0.0);
        let there = all[4].point2;
        let back = Expected::of(&all, there, ClickedImage::Second, 640.0, 2.0).unwrap();
        assert!((back.at - all[4].point1).norm() < 1e-9);
        let at = Point::new(12.0, 9.0);
        let none = |matches: &[PointPair]| Expected::of(matches, at, ClickedImage::First, 640.0, 2.0);
        assert_eq!(none(&all[..4]), None);
        let row: Vec<PointPair> =
            (0..8).map(|k| PointPair::new(f64::from(k), 3.0, f64::from(k), 3.0)).collect();
        assert_eq!(none(&row), None);
    }
}
