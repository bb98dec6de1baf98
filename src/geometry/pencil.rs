//! Pencils of lines through a point, and the one-dimensional homography between two pencils.
//!
//! The epipolar lines of image 1 form a pencil through `e1`, those of image 2 a pencil through `e2`.
//! They correspond by a projective map of one dimension, three degrees of freedom. With two
//! corresponding line pairs `(lp, lp2)` and `(lq, lq2)` as bases it is one number κ:
//!
//! ```text
//!     line2_from_line1:   α·lp + β·lq  ↦  α·lp2 + κ·β·lq2
//! ```
//!
//! A third line pair gives κ. To more pairs no map is fitted but `F` itself, see [`super::fit_fundamental`]. The paper
//! prints a 3×3 homography fitted to three concurrent lines, which they do not determine.
//!
//! # Pitfalls
//! κ depends on the orientation (sign) of the four basis lines. [`PencilMap`] orients them itself: each
//! line's positive side is the side of the other click. Then κ > 0 keeps the lines that pass between the
//! two clicks in image 1 between them in image 2, as it must be for points in front of both cameras.

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
    /// A map through the two line pairs, oriented by the clicks `p` and `q` they pass through.
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

    /// The map of the same bases with another κ.
    #[must_use]
    pub fn with_kappa(self, kappa: f64) -> Self {
        Self { kappa, ..self }
    }

    /// κ: how the second basis line is weighed in image 2.
    pub fn kappa(&self) -> f64 {
        self.kappa
    }

    /// The line pair through the first click, oriented.
    pub fn p(&self) -> &LinePair {
        &self.p
    }

    /// The line pair through the second click, oriented.
    pub fn q(&self) -> &LinePair {
        &self.q
    }

    /// The line of image 1's pencil through a point, as coordinates `(α, β)` in the basis.
    pub fn coordinates1(&self, point: Point) -> Vector2<f64> {
        Vector2::new(self.q.line1.signed_distance(point), -self.p.line1.signed_distance(point))
    }

    /// The line of image 2's pencil through a point, as coordinates in the basis of image 2.
    pub fn coordinates2(&self, point: Point) -> Vector2<f64> {
        Vector2::new(self.q.line2.signed_distance(point), -self.p.line2.signed_distance(point))
    }

    /// The line of image 1 with the given coordinates.
    pub fn line1(&self, coordinates: Vector2<f64>) -> Option<Line> {
        Line::from_homogeneous(
            self.p.line1.coefficients() * coordinates.x + self.q.line1.coefficients() * coordinates.y,
        )
    }

    /// The line of image 2 with the given coordinates.
    pub fn line2(&self, coordinates: Vector2<f64>) -> Option<Line> {
        Line::from_homogeneous(
            self.p.line2.coefficients() * coordinates.x + self.q.line2.coefficients() * coordinates.y,
        )
    }

    /// The paper's H: the line of image 2 that corresponds to the line of image 1 with these coordinates.
    pub fn line2_from_line1(&self, coordinates1: Vector2<f64>) -> Option<Line> {
        self.line2(Vector2::new(coordinates1.x, self.kappa * coordinates1.y))
    }

    /// The paper's G, exact inverse of [`Self::line2_from_line1`].
    pub fn line1_from_line2(&self, coordinates2: Vector2<f64>) -> Option<Line> {
        self.line1(Vector2::new(self.kappa * coordinates2.x, coordinates2.y))
    }

    /// Bisector of the two basis lines of image 1, in the sector that holds the segment between the clicks.
    pub fn bisector1() -> Vector2<f64> {
        Vector2::new(1.0, -1.0)
    }

    /// κ that maps the line with coordinates `c1` in image 1 to the line with coordinates `c2` in image 2;
    /// `None` when either is a basis line.
    pub fn kappa_from_coordinates(c1: Vector2<f64>, c2: Vector2<f64>) -> Option<f64> {
        // (α, κβ) ∝ (α2, β2)
        let kappa = (c2.y * c1.x) / (c2.x * c1.y);
        (kappa.is_finite() && kappa != 0.0).then_some(kappa)
    }

    /// κ from one more scene point seen in both images; `None` when it lies on a basis line.
    pub fn kappa_from_point_pair(&self, pair: &PointPair) -> Option<f64> {
        Self::kappa_from_coordinates(self.coordinates1(pair.point1), self.coordinates2(pair.point2))
    }

    /// The fundamental matrix `F = lp2 lqᵀ − κ lq2 lpᵀ`, rank 2 by construction, epipoles at infinity
    /// included. `None` when the bases are degenerate (`lp` and `lq` the same line).
    pub fn fundamental(&self) -> Option<FundamentalMatrix> {
        let f = self.p.line2.coefficients() * self.q.line1.coefficients().transpose()
            - self.q.line2.coefficients() * self.p.line1.coefficients().transpose() * self.kappa;
        FundamentalMatrix::from_rank_two(f)
    }
}

/// Directions of a pencil of undirected lines through `centre`: angles in `[0, π)`, neighbouring lines at
/// most `spacing` px apart at distance `reach` px.
pub fn pencil_angles(reach: f64, spacing: f64) -> Vec<f64> {
    let count = (std::f64::consts::PI * reach / spacing).ceil().max(4.0) as usize;
    (0..count).map(|k| std::f64::consts::PI * k as f64 / count as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Camera, symmetric_epipolar_distance};
    use nalgebra::Point3;

    fn project(x: Point3<f64>) -> PointPair {
        let (camera1, camera2) = Camera::example_pair();
        PointPair { point1: camera1.project(&x).unwrap(), point2: camera2.project(&x).unwrap() }
    }

    /// The true map of the example cameras through two clicks.
    fn example() -> (FundamentalMatrix, PencilMap, Vec<PointPair>) {
        let (camera1, camera2) = Camera::example_pair();
        let f = Camera::fundamental(&camera1, &camera2).unwrap();
        let points: Vec<PointPair> = (0..12)
            .map(|k| {
                let t = f64::from(k);
                project(Point3::new((t * 0.9).sin(), (t * 1.7).cos(), 5.0 + (t * 2.3).sin()))
            })
            .collect();
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
        // Coordinates of line2 from a point on it.
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
