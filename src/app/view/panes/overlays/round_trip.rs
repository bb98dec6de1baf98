//! Overlay of lines mapped to the other image and back. Where `l` and `GH l` differ, the maps
//! contradict each other.

use egui::{Mesh, Pos2, Shape};

use super::Canvas;
use crate::app::model::document::Side;
use crate::app::view::theme;
use crate::estimate::{Construction, RoundTrip};
use crate::geometry::{Frame, Line, Point, area_between_lines, regions_between_lines};

/// Number of lines mapped. With more, the regions would cover the image.
const LINES: usize = 5;
/// Distance, px, by which a line must enter a region to count as crossing it.
const INTO: f64 = 0.5;

/// A line, its return, and the two parts of the image between them.
struct Trip {
    lines: RoundTrip,
    regions: [Vec<Point>; 2],
}

impl Trip {
    fn overlaps(&self, other: &Self) -> bool {
        let crosses = |line: &Line, region: &Vec<Point>| {
            let beyond = |sign: f64| region.iter().any(|at| sign * line.signed_distance(*at) > INTO);
            beyond(1.0) && beyond(-1.0)
        };
        let enters = |from: &Self, to: &Self| {
            [from.lines.line1, from.lines.back1]
                .iter()
                .any(|line| to.regions.iter().any(|region| crosses(line, region)))
        };
        enters(self, other) || enters(other, self)
    }
}

/// Returns round trips whose regions do not overlap: the one of median area, and the narrowest beside it.
/// Where the maps contradict each other much, all regions together would cover the image.
fn trips(construction: &Construction, frame1: Frame) -> Vec<Trip> {
    let trip =
        |lines: RoundTrip| Trip { regions: regions_between_lines(&lines.line1, &lines.back1, frame1), lines };
    let mut all: Vec<Trip> = construction.round_trips(frame1, LINES).into_iter().map(trip).collect();
    let area = |trip: &Trip| area_between_lines(&trip.lines.line1, &trip.lines.back1, frame1);
    all.sort_by(|a, b| area(a).total_cmp(&area(b)));
    if !all.is_empty() {
        let median = all.len() / 2;
        all[..=median].rotate_right(1);
    }
    let mut apart: Vec<Trip> = Vec::new();
    for trip in all {
        if !apart.iter().any(|other| other.overlaps(&trip)) {
            apart.push(trip);
        }
    }
    apart
}

pub fn draw(canvas: &Canvas) {
    let (Some(construction), Some(frame1)) =
        (canvas.model.construction(), canvas.model.document.frame(Side::Left))
    else {
        return;
    };
    for Trip { lines, regions } in trips(construction, frame1) {
        if canvas.side == Side::Right {
            canvas.thin_line(&lines.line2, 1.2, theme::FORWARD.gamma_multiply(0.8));
            continue;
        }
        for region in &regions {
            fill(canvas, region);
        }
        canvas.thin_line(&lines.line1, 1.2, theme::FORWARD.gamma_multiply(0.8));
        canvas.dashed_line(&lines.back1, 1.2, theme::BACKWARD);
    }
}

/// Fills a convex region with a fan of triangles. A filled path would blur its long thin ends.
fn fill(canvas: &Canvas, region: &[Point]) {
    let color = theme::BACKWARD.gamma_multiply(0.3);
    let edges = region.iter().zip(region.iter().cycle().skip(1));
    let outline: Vec<Pos2> =
        edges.flat_map(|(a, b)| canvas.transform.curve(*a, *b).into_iter().skip(1)).collect();
    let mut mesh = Mesh::default();
    for at in &outline {
        mesh.colored_vertex(*at, color);
    }
    for k in 2..outline.len() as u32 {
        mesh.add_triangle(0, k - 1, k);
    }
    canvas.painter.add(Shape::mesh(mesh));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trip(y: f64, back: f64) -> Trip {
        let frame = Frame::new(100, 100);
        let line = |y: f64| Line::through(Point::new(0.0, y), Point::new(100.0, y)).unwrap();
        let lines = RoundTrip { line1: line(y), line2: line(y), back1: line(back) };
        Trip { regions: regions_between_lines(&lines.line1, &lines.back1, frame), lines }
    }

    #[test]
    fn regions_overlap_where_a_line_of_one_enters_the_other() {
        assert!(trip(10.0, 30.0).overlaps(&trip(20.0, 40.0)));
        assert!(trip(10.0, 90.0).overlaps(&trip(20.0, 40.0)), "one inside the other");
        assert!(trip(20.0, 40.0).overlaps(&trip(10.0, 90.0)));
        assert!(!trip(10.0, 30.0).overlaps(&trip(30.0, 40.0)), "neighbours");
    }
}
