//! Pencils of lines through a point, and the one-dimensional homography between two pencils.
//!
//! The epipolar lines of image 1 form a pencil through `e1`, the epipolar lines of image 2 a pencil
//! through `e2`. A one-dimensional projective map relates the pencils; it has three degrees of
//! freedom. Two corresponding line pairs `(lp, lp2)` and `(lq, lq2)` as bases reduce the map to one
//! number κ:
//!
//! ```text
//!     line2_from_line1:   α·lp + β·lq  ↦  α·lp2 + κ·β·lq2
//! ```
//!
//! A third line pair gives κ. With more pairs, `F` itself is fitted instead of the map, see
//! [`super::fit_fundamental`]. The paper prints a 3×3 homography fitted to three concurrent lines,
//! which do not determine a homography.
//!
//! # Pitfalls
//! κ depends on the orientation (sign) of the four basis lines. [`PencilMap`] orients the basis
//! lines so that each has the other click on its positive side. If κ > 0, lines that pass between
//! the clicks in image 1 also pass between them in image 2. Points in front of both cameras require
//! this.

use nalgebra::Vector2;

use super::{FundamentalMatrix, Line, Point, PointPair};

/// A pair of corresponding lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinePair {
    /// Line in image 1.
    pub line1: Line,
    /// Line in image 2.
    pub line2: Line,
}

/// The projective map between two pencils, given by two line pairs and κ (see the module).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PencilMap {
    p: LinePair,
    q: LinePair,
    kappa: f64,
}

impl PencilMap {
    /// Creates a map from two line pairs, oriented by the clicks `p` and `q` on them.
    pub fn new(p: LinePair, q: LinePair, clicks: [&PointPair; 2], kappa: f64) -> Self {
        let [click_p, click_q] = clicks;
        Self {
            p: LinePair {
                line1: p.line1.with_positive_side(click_q.point1),
                line2: p.line2.with_positive_side(click_q.point2),
            },
            q: LinePair {
                line1: q.line1.with_positive_side(click_p.point1),
                line2: q.line2.with_positive_side(click_p.point2),
            },
            kappa,
        }
    }

    /// Returns the map with the same bases and another κ.
    #[must_use]
    pub fn with_kappa(self, kappa: f64) -> Self {
        Self { kappa, ..self }
    }

    /// Returns κ, the weight of the second basis line in image 2.
    pub fn kappa(&self) -> f64 {
        self.kappa
    }

    /// Returns the oriented line pair through the first click.
    pub fn p(&self) -> &LinePair {
        &self.p
    }

    /// Returns the oriented line pair through the second click.
    pub fn q(&self) -> &LinePair {
        &self.q
    }

    /// Returns the line of image 1's pencil through a point, as coordinates `(α, β)` in the basis.
    pub fn coordinates1(&self, point: Point) -> Vector2<f64> {
        Vector2::new(self.q.line1.signed_distance(point), -self.p.line1.signed_distance(point))
    }

    /// Returns the line of image 2's pencil through a point, as coordinates in the basis of image
    /// 2.
    pub fn coordinates2(&self, point: Point) -> Vector2<f64> {
        Vector2::new(self.q.line2.signed_distance(point), -self.p.line2.signed_distance(point))
    }

    /// Returns the line of image 1 with the given coordinates.
    pub fn line1(&self, coordinates: Vector2<f64>) -> Option<Line> {
        Line::from_homogeneous(
            self.p.line1.coefficients() * coordinates.x + self.q.line1.coefficients() * coordinates.y,
        )
    }

    /// Returns the line of image 2 with the given coordinates.
    pub fn line2(&self, coordinates: Vector2<f64>) -> Option<Line> {
        Line::from_homogeneous(
            self.p.line2.coefficients() * coordinates.x + self.q.line2.coefficients() * coordinates.y,
        )
    }

    /// Applies the paper's H: returns the line of image 2 that corresponds to a line of image 1.
    pub fn line2_from_line1(&self, coordinates1: Vector2<f64>) -> Option<Line> {
        self.line2(Vector2::new(coordinates1.x, self.kappa * coordinates1.y))
    }

    /// Applies the paper's G, the exact inverse of [`Self::line2_from_line1`].
    pub fn line1_from_line2(&self, coordinates2: Vector2<f64>) -> Option<Line> {
        self.line1(Vector2::new(self.kappa * coordinates2.x, coordinates2.y))
    }

    /// Returns the bisector of the two basis lines of image 1, in the sector of the segment between
    /// the clicks.
    pub fn bisector1() -> Vector2<f64> {
        Vector2::new(1.0, -1.0)
    }

    /// Returns the κ that maps the line `c1` of image 1 to the line `c2` of image 2, both as
    /// coordinates. Returns `None` when either is a basis line.
    pub fn kappa_from_coordinates(c1: Vector2<f64>, c2: Vector2<f64>) -> Option<f64> {
        // (α, κβ) ∝ (α2, β2)
        let kappa = (c2.y * c1.x) / (c2.x * c1.y);
        (kappa.is_finite() && kappa != 0.0).then_some(kappa)
    }

    /// Returns the κ given by one more point pair. Returns `None` when a point lies on a basis
    /// line.
    pub fn kappa_from_point_pair(&self, pair: &PointPair) -> Option<f64> {
        Self::kappa_from_coordinates(self.coordinates1(pair.point1), self.coordinates2(pair.point2))
    }

    /// Returns the fundamental matrix `F = lp2 lqᵀ − κ lq2 lpᵀ`, of rank 2 by construction, also
    /// for epipoles at infinity. Returns `None` when `lp` and `lq` coincide.
    pub fn fundamental(&self) -> Option<FundamentalMatrix> {
        let f = self.p.line2.coefficients() * self.q.line1.coefficients().transpose()
            - self.q.line2.coefficients() * self.p.line1.coefficients().transpose() * self.kappa;
        FundamentalMatrix::from_rank_two(f)
    }
}

/// Returns the directions of a pencil of undirected lines, angles in `[0, π)`. Neighbouring lines
/// are at most `spacing` px apart at a distance of `reach` px.
pub fn pencil_angles(reach: f64, spacing: f64) -> Vec<f64> {
    let count = (std::f64::consts::PI * reach / spacing).ceil().max(4.0) as usize;
    (0..count).map(|k| std::f64::consts::PI * k as f64 / count as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::{example_fundamental, example_seen};
    use crate::geometry::symmetric_epipolar_distance;

    /// Returns the true map of the example cameras through two clicks.
    fn example() -> (FundamentalMatrix, PencilMap, Vec<PointPair>) {
        let f = example_fundamental();
        let seen = |t: f64| example_seen((t * 0.9).sin(), (t * 1.7).cos(), 5.0 + (t * 2.3).sin());
        let points: Vec<PointPair> = (0..12).map(|k| seen(f64::from(k))).collect();
        let true_pair = |pair: &PointPair| LinePair {
            line1: f.line1_from_point2(pair.point2).unwrap(),
            line2: f.line2_from_point1(pair.point1).unwrap(),
        };
        let map = PencilMap::new(true_pair(&points[0]), true_pair(&points[1]), [&points[0], &points[1]], 1.0);
        (f, map, points)
    }

    #[test]
    fn three_line_pairs_give_the_fundamental_matrix() {
        let (f, map, points) = example();
        for third in &points[2..] {
            let kappa = map.kappa_from_point_pair(third).unwrap();
            assert!(kappa > 0.0, "points in front of both cameras");
            let g = map.with_kappa(kappa).fundamental().unwrap();
            assert!((f.matrix() - g.matrix()).norm() < 1e-9);
        }
    }

    #[test]
    fn forward_and_backward_undo_each_other() {
        let (_, map, points) = example();
        let map = map.with_kappa(1.7);
        let c1 = map.coordinates1(points[4].point1);
        let line1 = map.line1(c1).unwrap();
        let line2 = map.line2_from_line1(c1).unwrap();
        // A point on line2 gives its coordinates.
        let on2 = line2.foot(points[4].point2);
        let back = map.line1_from_line2(map.coordinates2(on2)).unwrap();
        assert!(back.coefficients().cross(line1.coefficients()).norm() < 1e-7);
    }

    #[test]
    fn pure_sideways_motion_has_its_epipoles_at_infinity() {
        let row = |y: f64| Line::through_at_angle(Point::new(0.0, y), 0.0);
        let pairs = [PointPair::new(10.0, 20.0, 4.0, 20.0), PointPair::new(50.0, 60.0, 40.0, 60.0)];
        let of = |y: f64| LinePair { line1: row(y), line2: row(y) };
        let map = PencilMap::new(of(20.0), of(60.0), [&pairs[0], &pairs[1]], 1.0);
        let kappa = map.kappa_from_point_pair(&PointPair::new(30.0, 37.0, 22.0, 37.0)).unwrap();
        let f = map.with_kappa(kappa).fundamental().unwrap();
        assert!(f.epipole1().z.abs() < 1e-12 && f.epipole2().z.abs() < 1e-12);
        let other = PointPair::new(80.0, 90.0, 70.0, 90.0);
        assert!(symmetric_epipolar_distance(&f, &other) < 1e-9);
    }

    #[test]
    fn the_bisector_passes_between_the_clicks() {
        let (_, map, points) = example();
        let bisector = map.line1(PencilMap::bisector1()).unwrap();
        let (p, q) = (points[0].point1, points[1].point1);
        assert!(bisector.signed_distance(p) * bisector.signed_distance(q) < 0.0);
        let foot = bisector.foot(nalgebra::center(&p, &q));
        let (dp, dq) = (map.p().line1.distance(foot), map.q().line1.distance(foot));
        assert!((dp - dq).abs() < 1e-9);
    }

    #[test]
    fn spacing_bounds_the_gap_at_the_reach() {
        let angles = pencil_angles(200.0, 2.0);
        let step = angles[1] - angles[0];
        assert!(step * 200.0 <= 2.0 && step * 200.0 > 1.9);
        assert!(*angles.last().unwrap() < std::f64::consts::PI);
    }
}
