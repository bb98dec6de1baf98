//! Geometries that fit two clicks exactly: the five numbers that parametrise them, and the two
//! pencils of corresponding epipolar lines.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector2};

use super::SHORTEST_LINE;
use crate::geometry::{
    AnchoredLine, Frame, FundamentalMatrix, HomogeneousPoint, Line, LinePair, PencilMap, Point, PointPair,
    Vector, median,
};

/// Directed angles of the epipolar lines through the clicks, and κ. They do not depend on the size
/// of the images, so they serve every level of a pyramid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PencilAngles {
    /// Directions of the line through the first click in image 1 and 2, radians.
    pub p: [f64; 2],
    /// Directions of the line through the second click in image 1 and 2, radians.
    pub q: [f64; 2],
    /// κ of the map between the pencils.
    pub kappa: f64,
}

impl PencilAngles {
    /// Returns the directions of the epipolar lines of `f` at the clicks, and κ. The lines of image
    /// 2 are directed such that they are rotated by about `turn` radians against image 1. Returns
    /// `None` when `f` degenerates at a click.
    pub fn of(f: &FundamentalMatrix, clicks: &[PointPair; 2], turn: f64) -> Option<Self> {
        let (e1, e2) = (f.epipole1(), f.epipole2());
        let angle = |epipole: &HomogeneousPoint, point: Point| {
            let d = direction(epipole, point);
            d.y.atan2(d.x)
        };
        let angles = clicks.map(|c| [angle(&e1, c.point1), angle(&e2, c.point2)]);
        let agreement: f64 = angles.iter().map(|[a1, a2]| (a2 - a1 - turn).cos()).sum();
        let back = if agreement < 0.0 { PI } else { 0.0 };
        let [p, q] = angles.map(|[a1, a2]| [a1, a2 + back]);
        // κ of the line half way between the clicks.
        let between = nalgebra::center(&clicks[0].point1, &clicks[1].point1);
        let beside = nalgebra::center(&clicks[0].point2, &clicks[1].point2);
        let third = PointPair { point1: between, point2: f.line2_from_point1(between)?.foot(beside) };
        Self::nearest(f, clicks, &Self { p, q, kappa: 1.0 }, std::iter::once(third))
    }

    /// Returns the geometry through the clicks nearest to `f`: the directions of its epipolar lines
    /// at the clicks, and the median κ over `matches`. Without matches, κ is taken from
    /// `reference`. `reference` also tells the sense of the lines. Returns `None` when `f`
    /// degenerates at a click.
    pub fn nearest(
        f: &FundamentalMatrix,
        clicks: &[PointPair; 2],
        reference: &Self,
        matches: impl Iterator<Item = PointPair>,
    ) -> Option<Self> {
        let directed = |line: Line, like: f64| {
            let d = line.direction();
            let angle = d.y.atan2(d.x);
            if (angle - like).cos() < 0.0 { angle + PI } else { angle }
        };
        let lines = |click: &PointPair, like: [f64; 2]| {
            let line1 = f.line1_from_point2(click.point2)?;
            let line2 = f.line2_from_point1(click.point1)?;
            Some([directed(line1, like[0]), directed(line2, like[1])])
        };
        let angles =
            Self { p: lines(&clicks[0], reference.p)?, q: lines(&clicks[1], reference.q)?, kappa: 1.0 };
        let map = PencilPair::new(&angles, *clicks)?.map;
        let kappas: Vec<f64> =
            matches.filter_map(|pair| map.kappa_from_point_pair(&pair)).filter(|k| *k > 0.0).collect();
        if kappas.is_empty() {
            return Some(Self { kappa: reference.kappa, ..angles });
        }
        Some(Self { kappa: median(kappas), ..angles })
    }
}

/// Geometry at one level: [`PencilAngles`] with the clicks in pixels of the level.
#[derive(Debug, Clone)]
pub(crate) struct PencilPair {
    clicks: [PointPair; 2],
    pub map: PencilMap,
    /// Epipoles, signed so that [`direction`] at a click agrees with its directed angle.
    epipoles: [HomogeneousPoint; 2],
}

/// Returns the direction of the epipolar line at `point`, oriented by the sign of `epipole`. It is
/// continuous over the plane and for epipoles that pass through infinity.
fn direction(epipole: &HomogeneousPoint, point: Point) -> Vector {
    epipole.xy() - point.coords * epipole.z
}

impl PencilPair {
    /// Returns the pencils at the clicks. Returns `None` when the lines do not define epipoles, or
    /// when the four directions contradict each other: no scene in front of both cameras has such
    /// lines.
    pub fn new(angles: &PencilAngles, clicks: [PointPair; 2]) -> Option<Self> {
        let [p, q] = clicks;
        let line = |point, angle| Line::through_at_angle(point, angle);
        let pair_p = LinePair { line1: line(p.point1, angles.p[0]), line2: line(p.point2, angles.p[1]) };
        let pair_q = LinePair { line1: line(q.point1, angles.q[0]), line2: line(q.point2, angles.q[1]) };
        let map = PencilMap::new(pair_p, pair_q, [&p, &q], angles.kappa);
        let oriented = |a: &Line, b: &Line, at_p: Point, angle_p: f64, at_q: Point, angle_q: f64| {
            let e = a.intersection(b).try_normalize(0.0)?;
            let agrees =
                |point, angle: f64| direction(&e, point).dot(&Vector::new(angle.cos(), angle.sin())) > 0.0;
            let (at_p, at_q) = (agrees(at_p, angle_p), agrees(at_q, angle_q));
            Some((if at_p { e } else { -e }, at_p == at_q))
        };
        let (e1, alike1) =
            oriented(&pair_p.line1, &pair_q.line1, p.point1, angles.p[0], q.point1, angles.q[0])?;
        let (e2, alike2) =
            oriented(&pair_p.line2, &pair_q.line2, p.point2, angles.p[1], q.point2, angles.q[1])?;
        // If an epipole lies between the clicks, one line points to it and the other away, in both
        // images. The second pair of lines then has the opposite sense.
        (alike1 == alike2).then_some(Self { clicks, map, epipoles: [e1, e2] })
    }

    pub fn fundamental(&self) -> Option<FundamentalMatrix> {
        self.map.fundamental()
    }

    #[must_use]
    pub fn with_kappa(&self, kappa: f64) -> Self {
        Self { map: self.map.with_kappa(kappa), ..self.clone() }
    }

    /// Returns two corresponding lines, directed and anchored at (nearly) the same scene point.
    ///
    /// Between the clicks, the anchor is the intersection with the line that joins the clicks: both
    /// are images of one point of the 3-D line through the two scene points. Beyond a click that
    /// point may lie anywhere, so there the anchor is the foot of the nearer click.
    pub fn anchored(&self, line1: &Line, line2: &Line) -> Option<(AnchoredLine, AnchoredLine)> {
        let [p, q] = &self.clicks;
        let at_join = |line: &Line, p: Point, q: Point| {
            let (a, b) = (line.signed_distance(p), line.signed_distance(q));
            (a * b < 0.0).then(|| p + (q - p) * (a / (a - b)))
        };
        let joined = at_join(line1, p.point1, q.point1).zip(at_join(line2, p.point2, q.point2));
        let (anchor1, anchor2) = joined.unwrap_or_else(|| {
            let nearer = if line1.distance(p.point1) < line1.distance(q.point1) { p } else { q };
            (line1.foot(nearer.point1), line2.foot(nearer.point2))
        });
        let directed = |anchor: Point, line: &Line, epipole: &HomogeneousPoint| {
            let along = line.direction();
            let sign = if along.dot(&direction(epipole, anchor)) < 0.0 { -1.0 } else { 1.0 };
            AnchoredLine { anchor, direction: along * sign }
        };
        let pair = (directed(anchor1, line1, &self.epipoles[0]), directed(anchor2, line2, &self.epipoles[1]));
        pair.0.anchor.coords.iter().chain(pair.1.anchor.coords.iter()).all(|v| v.is_finite()).then_some(pair)
    }

    /// Returns about `count` epipolar lines of image 1, spread evenly over the image, each with its
    /// partner in image 2.
    pub fn spread_over_image1(&self, frame1: Frame, count: usize) -> Vec<(AnchoredLine, AnchoredLine)> {
        self.coordinates_over_image1(frame1, count)
            .into_iter()
            .filter_map(|c| self.anchored(&self.map.line1(c)?, &self.map.line2_from_line1(c)?))
            .collect()
    }

    /// Returns about `count` epipolar lines of image 2, spread evenly over the image, each with its
    /// partner. The first line of each pair is still the line of image 1.
    pub fn spread_over_image2(&self, frame2: Frame, count: usize) -> Vec<(AnchoredLine, AnchoredLine)> {
        self.swapped()
            .spread_over_image1(frame2, count)
            .into_iter()
            .map(|(line2, line1)| (line1, line2))
            .collect()
    }

    fn swapped(&self) -> Self {
        let swap = |pair: &LinePair| LinePair { line1: pair.line2, line2: pair.line1 };
        let clicks = self.clicks.map(PointPair::swapped);
        let map = PencilMap::new(
            swap(self.map.p()),
            swap(self.map.q()),
            [&clicks[0], &clicks[1]],
            1.0 / self.map.kappa(),
        );
        Self { clicks, map, epipoles: [self.epipoles[1], self.epipoles[0]] }
    }

    /// Returns pencil coordinates of lines that cross the image, spread evenly by angle as seen
    /// from the epipole in coordinates centred on the image. For an epipole inside the image, this
    /// spreads directions; for an epipole at infinity, offsets.
    pub fn coordinates_over_image1(&self, frame: Frame, count: usize) -> Vec<Vector2<f64>> {
        let half = 0.5 * frame.diagonal();
        let centre = frame.centre();
        let centred = Matrix3::new(1.0, 0.0, -centre.x, 0.0, 1.0, -centre.y, 0.0, 0.0, half);
        let Some(e) = (centred * self.epipoles[0]).try_normalize(0.0) else { return Vec::new() };
        let axis = e.map(f64::abs).imin();
        let helper = nalgebra::Vector3::from_fn(|k, _| f64::from(u8::from(k == axis)));
        let Some(u) = e.cross(&helper).try_normalize(0.0) else { return Vec::new() };
        let v = e.cross(&u);
        let shortest = SHORTEST_LINE * frame.shorter_side();
        let crossing: Vec<Line> = (0..STEPS)
            .filter_map(|k| {
                let (sin, cos) = (PI * (k as f64 + 0.5) / STEPS as f64).sin_cos();
                let line = Line::from_homogeneous(centred.transpose() * (u * cos + v * sin))?;
                (frame.clip(&line)?.length() >= shortest).then_some(line)
            })
            .collect();
        let chosen = count.min(crossing.len());
        (0..chosen)
            .map(|k| {
                let line = &crossing[(2 * k + 1) * crossing.len() / (2 * chosen)];
                self.coordinates_of_line1(line, frame)
            })
            .collect()
    }

    /// Returns the pencil coordinates of a line of image 1. Of two points on the line, they are
    /// computed from the one farther from the epipole.
    fn coordinates_of_line1(&self, line: &Line, frame: Frame) -> Vector2<f64> {
        let foot = line.foot(frame.centre());
        let offset = line.direction() * frame.diagonal();
        let [a, b] = [foot + offset, foot - offset].map(|point| self.map.coordinates1(point));
        if a.norm() > b.norm() { a } else { b }
    }
}

/// Number of directions tried for lines that cross the image: about one degree apart if the epipole
/// is in the middle. Twice as many place the chosen lines to half a degree.
const STEPS: usize = 192;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random_scene::{example_fundamental, example_seen};
    use crate::geometry::symmetric_epipolar_distance;

    const FRAME: Frame = Frame { width: 768, height: 576 };

    fn example() -> (FundamentalMatrix, PencilPair) {
        let f = example_fundamental();
        let clicks = [example_seen(-0.5, -0.6, 5.0), example_seen(0.6, 0.7, 6.0)];
        (f, true_pencils(&f, clicks, &example_seen(0.1, 0.05, 5.5)))
    }

    fn true_pencils(f: &FundamentalMatrix, clicks: [PointPair; 2], third: &PointPair) -> PencilPair {
        let angle = |line: Option<Line>| {
            let d = line.unwrap().direction();
            d.y.atan2(d.x)
        };
        let towards = |a: f64, reference: f64| {
            if (a - reference).cos() < 0.0 { a + PI } else { a }
        };
        let pair = |c: &PointPair| {
            let a = angle(f.line1_from_point2(c.point2));
            [towards(a, 0.0), towards(angle(f.line2_from_point1(c.point1)), 0.0)]
        };
        let angles = PencilAngles { p: pair(&clicks[0]), q: pair(&clicks[1]), kappa: 1.0 };
        let pencils = PencilPair::new(&angles, clicks).unwrap();
        let kappa = pencils.map.kappa_from_point_pair(third).unwrap();
        pencils.with_kappa(kappa)
    }

    #[test]
    fn spread_lines_are_epipolar_in_both_images() {
        let (f, pencils) = example();
        assert!((pencils.fundamental().unwrap().matrix() - f.matrix()).norm() < 1e-9);
        let there = pencils.spread_over_image1(FRAME, 24);
        let back = pencils.spread_over_image2(FRAME, 24);
        assert_eq!((there.len(), back.len()), (24, 24));
        for (l1, l2) in there.iter().chain(&back) {
            for t in [-100.0, 0.0, 250.0] {
                let pair = PointPair { point1: l1.point_at(t), point2: l2.point_at(t) };
                assert!(symmetric_epipolar_distance(&f, &pair) < 1e-6);
            }
            assert!(l1.direction.dot(&l2.direction) > 0.5, "both run the same way");
        }
    }

    #[test]
    fn contradictory_directions_are_refused() {
        let clicks = [PointPair::new(100.0, 100.0, 90.0, 100.0), PointPair::new(120.0, 300.0, 100.0, 300.0)];
        let angles = PencilAngles { p: [0.1, 0.1], q: [-0.1, -0.1], kappa: 1.0 };
        assert!(PencilPair::new(&angles, clicks).is_some());
        let reversed = PencilAngles { p: [0.1, 0.1], q: [-0.1, -0.1 + PI], kappa: 1.0 };
        assert!(PencilPair::new(&reversed, clicks).is_none());
        // A line pair has no sense of its own: reversing both lines of a click changes nothing.
        let turned = PencilAngles { p: [0.1, 0.1], q: [-0.1 + PI, -0.1 + PI], kappa: 1.0 };
        let [same, other] =
            [angles, turned].map(|a| PencilPair::new(&a, clicks).unwrap().fundamental().unwrap());
        assert!((same.matrix() - other.matrix()).norm() < 1e-12);
    }

    #[test]
    fn lines_through_an_epipole_inside_the_image_are_spread() {
        let clicks = [PointPair::new(300.0, 200.0, 280.0, 190.0), PointPair::new(500.0, 400.0, 520.0, 420.0)];
        let towards = |c: Point, e: Point| (e.y - c.y).atan2(e.x - c.x);
        let e = Point::new(390.0, 330.0);
        let angle = |k: usize| [towards(clicks[k].point1, e), towards(clicks[k].point2, e)];
        let pencils =
            PencilPair::new(&PencilAngles { p: angle(0), q: angle(1), kappa: 1.0 }, clicks).unwrap();
        let lines = pencils.spread_over_image1(FRAME, 16);
        assert_eq!(lines.len(), 16);
        for (l1, _) in &lines {
            assert!(l1.line().distance(e) < 1e-6);
        }
    }
}
