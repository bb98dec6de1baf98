//! Evenly spaced corresponding lines of a geometry.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{Frame, FundamentalMatrix, Line, Point, PointPair, Segment, Vector, finite_point};

/// Number of rays if the epipole is inside the left picture, like the hours of a clock.
const RAYS: usize = 12;
/// Number of lines if it is outside.
const LINES: usize = 9;

/// Returns a place in the left picture on each line. If the epipole is inside, the places surround it like the hours of
/// a clock, and the last one is above it. Otherwise they are evenly spaced across the middle of the picture.
pub fn places(f: &FundamentalMatrix, left: Frame) -> Vec<Point> {
    let centre = left.centre();
    let epipole = f.epipole1();
    if let Some(inside) = finite_point(&epipole).filter(|point| left.contains(*point)) {
        let radius = 0.25 * left.width.min(left.height) as f64;
        let ray = |hour: usize| {
            let angle = hour as f64 / RAYS as f64 * TAU;
            inside + Vector::new(angle.sin(), -angle.cos()) * radius
        };
        return (1..=RAYS).map(ray).collect();
    }
    let away = epipole.xy() - centre.coords * epipole.z;
    let Some(along) = away.try_normalize(1e-300) else { return Vec::new() };
    let mut across = Vector::new(-along.y, along.x);
    // Numbers grow downwards, or to the right.
    if across.y < 0.0 || across.y == 0.0 && across.x < 0.0 {
        across = -across;
    }
    let Some((first, last)) = left.clip_ray(centre, across) else { return Vec::new() };
    let at = |k: usize| centre + across * (first + (last - first) * (k as f64 + 0.5) / LINES as f64);
    (0..LINES).map(at).collect()
}

/// Returns the epipolar lines of a place of the left picture, in both pictures.
pub fn lines(f: &FundamentalMatrix, place: Point) -> [Option<Line>; 2] {
    [Line::joining(&f.epipole1(), &place.to_homogeneous()), f.line2_from_point1(place)]
}

/// Returns a line on the way from one line to another, `share` of the way.
pub fn between(from: &Line, to: &Line, share: f64) -> Option<Line> {
    let sense = if from.direction().dot(&to.direction()) < 0.0 { -1.0 } else { 1.0 };
    Line::from_homogeneous(from.coefficients() * (1.0 - share) + to.coefficients() * (sense * share))
}

/// A numbered pair of corresponding epipolar lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NumberedLines {
    /// Number, from 1.
    pub number: usize,
    /// The part in each picture: from the epipole outwards if that is inside, otherwise the whole line. The number
    /// stands at its end.
    pub parts: [Option<Segment>; 2],
}

/// Returns evenly spaced corresponding lines: like the hours of a clock if the left epipole is inside its picture,
/// otherwise nine from top to bottom.
///
/// Points on one side of an epipole have their matches on one side of the other. `matches` tell on which (Hartley and
/// Zisserman, section 22.3). Without any, lines through an epipole inside stay whole.
pub fn numbered(f: &FundamentalMatrix, frames: [Frame; 2], matches: &[PointPair]) -> Vec<NumberedLines> {
    let [e1, e2] = [f.epipole1(), f.epipole2()];
    let [inside1, inside2] =
        [(e1, frames[0]), (e2, frames[1])].map(|(e, frame)| finite_point(&e).filter(|e| frame.contains(*e)));
    let line2 = |point1: Point| f.matrix() * point1.to_homogeneous();
    let side = |point2: Vector3<f64>, line2: Vector3<f64>| e2.cross(&point2).dot(&line2);
    let votes = matches.iter().map(|m| side(m.point2.to_homogeneous(), line2(m.point1)).signum());
    let votes: f64 = votes.filter(|vote| vote.is_finite()).sum();
    let mut places = places(f, frames[0]);
    if inside1.is_some() && votes == 0.0 {
        places.truncate(RAYS / 2);
    }
    let left = |place: Point| match inside1.filter(|_| votes != 0.0) {
        Some(epipole) => ray(epipole, place - epipole, frames[0]),
        None => frames[0].clip(&Line::joining(&e1, &place.to_homogeneous())?).map(|part| ending(part, -1.0)),
    };
    let right = |place: Point| {
        let homogeneous = line2(place);
        let line = Line::from_homogeneous(homogeneous)?;
        let agrees = |point2: Vector3<f64>| side(point2, homogeneous) * votes >= 0.0;
        if let Some(epipole) = inside2.filter(|_| votes != 0.0) {
            let way = line.direction();
            let sense = if agrees(Vector3::new(way.x, way.y, 0.0)) { 1.0 } else { -1.0 };
            return ray(epipole, way * sense, frames[1]);
        }
        let part = ending(frames[1].clip(&line)?, 1.0);
        // The matches of one side of a ray may all be out of view.
        let middle = nalgebra::center(&part.start, &part.end).to_homogeneous();
        (inside1.is_none() || agrees(middle)).then_some(part)
    };
    (1..)
        .zip(places)
        .map(|(number, place)| NumberedLines { number, parts: [left(place), right(place)] })
        .collect()
}

/// Returns the part of a ray inside a picture that has its origin inside.
fn ray(origin: Point, way: Vector, frame: Frame) -> Option<Segment> {
    let (_, last) = frame.clip_ray(origin, way)?;
    Some(Segment { start: origin, end: origin + way * last })
}

/// Returns a segment that ends at the left (`sense` −1) or at the right (1), or else at the top.
fn ending(part: Segment, sense: f64) -> Segment {
    let way = (part.end - part.start) * sense;
    let is_steep = way.y.abs() > 2.0 * way.x.abs();
    let keeps = if is_steep { way.y * sense < 0.0 } else { way.x > 0.0 };
    if keeps { part } else { Segment { start: part.end, end: part.start } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    /// Returns the geometry of a camera that moves towards a point of both pictures.
    fn towards(x: f64, y: f64) -> FundamentalMatrix {
        let e = Vector3::new(x, y, 1.0);
        FundamentalMatrix::from_rank_two(e.cross_matrix() * Matrix3::identity()).unwrap()
    }

    #[test]
    fn an_epipole_inside_has_rays_like_a_clock() {
        let frame = Frame::new(400, 300);
        let places = places(&towards(200.0, 150.0), frame);
        assert_eq!(places.len(), 12);
        assert!(places[11].y < 150.0 && (places[11].x - 200.0).abs() < 1e-9, "twelve is above");
        assert!(places[2].x > 200.0 && (places[2].y - 150.0).abs() < 1e-9, "three is at the right");
    }

    #[test]
    fn an_epipole_outside_has_lines_from_top_to_bottom() {
        let frame = Frame::new(400, 300);
        let f = towards(4000.0, 150.0);
        let places = places(&f, frame);
        assert_eq!(places.len(), 9);
        assert!(places.is_sorted_by(|a, b| a.y < b.y) && places.iter().all(|place| frame.contains(*place)));
        for place in places {
            let [line1, line2] = lines(&f, place).map(Option::unwrap);
            assert!(line1.distance(place) < 1e-6 && line2.distance(place) < 1e-6);
        }
    }

    #[test]
    fn numbers_tell_the_side_on_which_matches_lie() {
        let frames = [Frame::new(400, 300); 2];
        let f = towards(200.0, 150.0);
        // The camera moves forwards: points move away from the epipole.
        let forwards =
            [PointPair::new(250.0, 150.0, 300.0, 150.0), PointPair::new(200.0, 100.0, 200.0, 50.0)];
        let found = numbered(&f, frames, &forwards);
        assert_eq!(found.len(), 12);
        for NumberedLines { parts, .. } in &found {
            let [left, right] = parts.map(Option::unwrap);
            assert!((left.end - right.end).norm() < 1e-6, "each ray is its own partner");
        }
        // Seen from behind the first camera, points change sides.
        let across = forwards
            .map(|m| PointPair { point2: Point::from(Vector::new(400.0, 300.0) - m.point2.coords), ..m });
        for NumberedLines { parts, .. } in numbered(&f, frames, &across) {
            let [left, right] = parts.map(Option::unwrap);
            assert!((left.end - left.start).dot(&(right.end - right.start)) < 0.0);
        }
        let whole = numbered(&f, frames, &[]);
        assert_eq!(whole.len(), 6, "nothing tells the sides");
        assert!(
            whole.iter().all(|own| own.parts.map(Option::unwrap).iter().all(|part| part.length() > 298.9))
        );
    }

    #[test]
    fn whole_lines_end_at_the_outer_edges() {
        let frames = [Frame::new(400, 300); 2];
        for NumberedLines { parts, .. } in numbered(&towards(4000.0, 150.0), frames, &[]) {
            let [left, right] = parts.map(Option::unwrap);
            assert!(left.end.x < left.start.x && right.end.x > right.start.x);
        }
    }

    #[test]
    fn a_line_on_the_way_does_not_turn_the_wrong_way() {
        let line = |y: f64| Line::through(Point::new(0.0, y), Point::new(10.0, y)).unwrap();
        for to in [line(4.0), line(4.0).reversed()] {
            let middle = between(&line(2.0), &to, 0.5).unwrap();
            assert!(middle.distance(Point::new(5.0, 3.0)) < 1e-9);
        }
    }
}
