//! Drawing of a moment of the replay. The figures of the search are drawn beyond the edge of the picture, too: an
//! epipole is often outside.

use egui::{Color32, Mesh, Pos2, Shape as Drawn, Stroke};

use super::hypotheses::{mark, place};
use super::{Canvas, Pointing};
use crate::app::model::Target;
use crate::app::model::replay::moment::{Ink, Mark, Moment, Shape};
use crate::app::model::replay::strokes;
use crate::app::model::verdict::LineLook;
use crate::app::view::theme;
use crate::geometry::{Frame, Line, Point};

/// Radius of a dot, screen points.
const DOT: f32 = 3.5;
/// Radius to which a ripple grows, screen points.
const RIPPLE: f32 = 26.0;
/// Largest distance from which a mark is pointed at, screen points.
const REACH: f32 = 7.0;

pub fn draw(canvas: &Canvas, moment: &Moment) {
    for Mark { shape, ink, opacity, .. } in &moment.marks {
        let color = color_of(canvas, *ink).gamma_multiply(*opacity);
        match shape {
            // Lines of an unreliable result stay hidden here, too.
            Shape::Lines { lines, width, .. } if *ink == Ink::Verdict => {
                if let Some(line) = &lines[canvas.side.index()] {
                    canvas.epipolar_line(line, *width, color);
                }
            }
            _ => draw_shape(canvas, shape, color),
        }
    }
    if let Some(target) = canvas.model.open.focus.hovered() {
        light(canvas, moment, target);
    }
}

/// Draws the thing that is pointed at, and its partner in the other picture.
fn light(canvas: &Canvas, moment: &Moment, target: Target) {
    let mut marks =
        moment.marks.iter().filter(|mark| is_visible(canvas, mark) && mark.target == Some(target));
    // A part that a chart lists may have no mark at this moment.
    let Some(first) = marks.next() else {
        if let (Target::Replayed(part), Some(record)) = (target, canvas.model.record()) {
            for shape in strokes::parts_of(record, part) {
                draw_shape(canvas, &shape, theme::HOVER);
            }
        }
        return;
    };
    for mark in std::iter::once(first).chain(marks) {
        match &mark.shape {
            Shape::Lines { lines, width, dashed } => {
                let (lines, width) = (*lines, width.max(theme::STRONG_LINE_WIDTH));
                draw_shape(canvas, &Shape::Lines { lines, width, dashed: *dashed }, theme::HOVER);
            }
            shape => draw_shape(canvas, shape, theme::HOVER),
        }
    }
}

fn is_visible(canvas: &Canvas, mark: &Mark) -> bool {
    mark.ink != Ink::Verdict || canvas.model.line_look() != LineLook::Hidden
}

/// Returns the part of the moment at a screen position: a dot, or else a line.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let moment = canvas.model.drawn_moment()?;
    let side = canvas.side.index();
    let (mut dot, mut line): (Option<Pointing>, Option<Pointing>) = (None, None);
    for mark in moment.marks.iter().filter(|mark| is_visible(canvas, mark)) {
        let Some(target) = mark.target else { continue };
        let (best, distance) = match &mark.shape {
            Shape::Dots { at, .. } => (&mut dot, place(canvas, &at[side]).0.distance(position)),
            Shape::Stroke { pair, .. } => (&mut dot, canvas.place(pair).distance(position)),
            Shape::Lines { lines, .. } => {
                let path = lines[side].as_ref().map_or_else(Vec::new, |line| path_of(canvas, line));
                (&mut line, distance_from(&path, position))
            }
            Shape::Ripple { .. } | Shape::Area(_) | Shape::Note { .. } => continue,
        };
        // Of equally near marks, the topmost counts.
        if distance <= REACH && best.is_none_or(|best| distance <= best.distance) {
            *best = Some(Pointing { target, distance });
        }
    }
    dot.or(line)
}

/// Returns the distance of a place from a path.
fn distance_from(path: &[Pos2], at: Pos2) -> f32 {
    let from = |ends: &[Pos2]| {
        let (way, own) = (ends[1] - ends[0], at - ends[0]);
        let share = (own.dot(way) / way.length_sq().max(f32::EPSILON)).clamp(0.0, 1.0);
        (own - way * share).length()
    };
    path.windows(2).map(from).fold(f32::INFINITY, f32::min)
}

fn draw_shape(canvas: &Canvas, shape: &Shape, color: Color32) {
    match shape {
        Shape::Lines { lines, width, dashed } => {
            if let Some(line) = &lines[canvas.side.index()] {
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

fn color_of(canvas: &Canvas, ink: Ink) -> Color32 {
    match ink {
        Ink::Pair(pair) => theme::pair_color(pair),
        Ink::Unchecked => theme::UNCHECKED,
        Ink::Lit => theme::HOVER,
        Ink::RoundTrip => theme::FORWARD,
        Ink::Verdict => theme::line_color(canvas.model.line_look()),
    }
}

/// Returns the path of a line through the whole pane. Beyond the picture there is no lens to bend it by.
fn path_of(canvas: &Canvas, line: &Line) -> Vec<Pos2> {
    if canvas.transform.bends() {
        return canvas.in_sight(line);
    }
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
}

/// Draws a line through the whole pane.
fn across(canvas: &Canvas, line: &Line, width: f32, color: Color32, dashed: bool) {
    let path = path_of(canvas, line);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_as_far_as_its_nearest_point() {
        let path = [Pos2::new(0.0, 0.0), Pos2::new(10.0, 0.0), Pos2::new(10.0, 10.0)];
        let from = |x: f32, y: f32| distance_from(&path, Pos2::new(x, y));
        assert!((from(4.0, 3.0) - 3.0).abs() < 1e-5 && (from(13.0, 14.0) - 5.0).abs() < 1e-5);
        assert!(from(10.0, 5.0) < 1e-5);
        assert!(distance_from(&path[..1], path[0]).is_infinite());
    }
}
