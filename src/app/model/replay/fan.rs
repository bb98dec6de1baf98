//! Evenly spaced corresponding lines of a geometry.

use std::f64::consts::TAU;

use crate::geometry::{Frame, FundamentalMatrix, Line, Point, Vector, finite_point};

/// Number of rays if the epipole is inside the left picture, like the hours of a clock.
const RAYS: usize = 12;
/// Number of lines if it is outside.
const LINES: usize = 9;

/// Returns places in the left picture, one on each of the lines: about the epipole if that is inside, the last one
/// above it, and otherwise evenly spaced across the middle of the picture. Their numbers begin with 1.
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
    fn a_line_on_the_way_does_not_turn_the_wrong_way() {
        let line = |y: f64| Line::through(Point::new(0.0, y), Point::new(10.0, y)).unwrap();
        for to in [line(4.0), line(4.0).reversed()] {
            let middle = between(&line(2.0), &to, 0.5).unwrap();
            assert!(middle.distance(Point::new(5.0, 3.0)) < 1e-9);
        }
    }
}
