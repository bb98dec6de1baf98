//! Drawing of a moment of the replay. The figures of the search are drawn beyond the edge of the picture, too: an
//! epipole is often outside.

use egui::{Color32, Mesh, Pos2, Shape as Drawn, Stroke};

use super::Canvas;
use super::hypotheses::{mark, place};
use crate::app::model::replay::moment::{Ink, Mark, Moment, Shape};
use crate::app::view::theme;
use crate::geometry::{Frame, Line, Point};

/// Radius of a dot, screen points.
const DOT: f32 = 3.5;
/// Radius to which a ripple grows, screen points.
const RIPPLE: f32 = 26.0;

pub fn draw(canvas: &Canvas, moment: &Moment) {
    for Mark { shape, ink, opacity } in &moment.marks {
        let color = color_of(canvas, *ink).gamma_multiply(*opacity);
        match shape {
            Shape::Lines { lines, width, dashed } => {
                let Some(line) = &lines[canvas.side.index()] else { continue };
                if *ink == Ink::Verdict {
                    // Lines of an unreliable result stay hidden here, too.
                    canvas.epipolar_line(line, *width, color);
                } else {
                    across(canvas, line, *width, color, *dashed);
                }
            }
            Shape::Dots { at, drop } => mark(canvas, &at[canvas.side.index()], color, *drop),
            Shape::Ripple { at, share } => {
                let (at, outwards) = place(canvas, &at[canvas.side.index()]);
                if outwards.is_none() {
                    canvas.painter.circle_stroke(at, DOT + share * RIPPLE, Stroke::new(1.5, color));
                }
            }
            Shape::Stroke { pair, has_stroke } => {
                let at = canvas.place(pair);
                canvas.painter.circle_filled(at, 2.0, color);
                if *has_stroke {
                    let other = canvas.transform.screen_from_image(canvas.side.other().point(pair));
                    canvas.painter.line_segment([at, other], Stroke::new(1.2, color));
                }
            }
            Shape::Area(region) if canvas.side.index() == 0 => fill(canvas, region, color),
            Shape::Note { side, at, text } if *side == canvas.side => {
                canvas.label(canvas.transform.screen_from_image(*at), text, color);
            }
            Shape::Area(_) | Shape::Note { .. } => {}
        }
    }
}

fn color_of(canvas: &Canvas, ink: Ink) -> Color32 {
    match ink {
        Ink::Pair(pair) => theme::pair_color(pair),
        Ink::Unchecked => theme::UNCHECKED,
        Ink::Lit => theme::HOVER,
        Ink::RoundTrip => theme::FORWARD,
        Ink::Verdict => theme::line_color(canvas.model.line_look()),
    }
}

/// Draws a line through the whole pane. Beyond the picture there is no lens to bend it by.
fn across(canvas: &Canvas, line: &Line, width: f32, color: Color32, dashed: bool) {
    let path: Vec<Pos2> = if canvas.transform.bends() {
        canvas.in_sight(line)
    } else {
        let [low, high] = canvas.transform.pixel_range(canvas.transform.rect);
        // The clipping area of a frame begins at its first pixel.
        let moved = Line::from_homogeneous(nalgebra::Vector3::new(
            line.coefficients().x,
            line.coefficients().y,
            line.coefficients().z + line.coefficients().x * low.x + line.coefficients().y * low.y,
        ));
        let size = high - low;
        let frame = Frame::new(size.x.ceil() as usize + 1, size.y.ceil() as usize + 1);
        let segment = moved.and_then(|line| frame.clip(&line));
        let at = |point: Point| canvas.transform.screen_from_image(point + low.coords);
        segment.map_or_else(Vec::new, |segment| vec![at(segment.start), at(segment.end)])
    };
    if width > 1.5 {
        let halo = theme::HALO.gamma_multiply(f32::from(color.a()) / 255.0);
        canvas.stroke(&path, width + 2.0, halo);
    }
    if dashed {
        canvas.painter.extend(Drawn::dashed_line(&path, Stroke::new(width, color), 9.0, 6.0));
    } else {
        canvas.stroke(&path, width, color);
    }
}

/// Fills a convex region with a fan of triangles. A filled path would blur its long thin ends.
fn fill(canvas: &Canvas, region: &[Point], color: Color32) {
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
    canvas.painter.add(Drawn::mesh(mesh));
}
