//! Overlay of lines mapped to the other image and back. Where `l` and `GH l` differ, the maps
//! contradict each other.

use egui::{Mesh, Pos2, Shape};

use super::Canvas;
use crate::app::model::document::Side;
use crate::app::view::theme;
use crate::geometry::{Point, regions_between_lines};

/// Number of lines mapped. With more, the regions would cover the image.
const LINES: usize = 5;

pub fn draw(canvas: &Canvas) {
    let (Some(construction), Some(frame1)) =
        (canvas.model.construction(), canvas.model.document.frame(Side::Left))
    else {
        return;
    };
    for trip in construction.round_trips(frame1, LINES) {
        if canvas.side == Side::Right {
            canvas.thin_line(&trip.line2, 1.2, theme::FORWARD.gamma_multiply(0.8));
            continue;
        }
        for region in regions_between_lines(&trip.line1, &trip.back1, frame1) {
            fill(canvas, &region);
        }
        canvas.thin_line(&trip.line1, 1.2, theme::FORWARD.gamma_multiply(0.8));
        canvas.dashed_line(&trip.back1, 1.2, theme::BACKWARD);
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
