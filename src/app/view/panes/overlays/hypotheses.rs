//! Overlay of the epipoles of hypotheses: diamonds in the image, arrows at its edge for those
//! outside.

use egui::{Color32, Pos2, Shape, Stroke, Vec2, vec2};

use super::{Canvas, Pointing};
use crate::app::model::focus::Target;
use crate::app::view::theme;
use crate::estimate::Estimate;
use crate::geometry::{HomogeneousPoint, Vector, finite_point};

/// Number of hypotheses drawn, by rank.
const DRAWN: usize = 20;

pub fn draw(canvas: &Canvas) {
    let Some((shown, opacity)) = canvas.shown() else { return };
    let drawn = shown.estimate.hypotheses().len().min(DRAWN);
    let epipole = |hypothesis: &Estimate| canvas.side.epipole(hypothesis.fundamental());
    let lit = match canvas.at_hand(canvas.model.open.focus.hovered()) {
        Some(Target::Hypothesis(number)) => Some(number),
        _ => None,
    };
    for (rank, hypothesis) in shown.estimate.hypotheses().iter().take(drawn).enumerate().rev() {
        let bright = 1.0 - rank as f32 / drawn as f32;
        mark(
            canvas,
            &epipole(hypothesis),
            theme::UNCHECKED.gamma_multiply(opacity * (0.15 + 0.7 * bright * bright)),
            1.0,
        );
    }
    for number in shown.hypothesis.map(|(number, _)| number).into_iter().chain(lit) {
        if let Some(hypothesis) = shown.estimate.hypotheses().get(number) {
            mark(canvas, &epipole(hypothesis), theme::SELECTED, 1.5);
        }
    }
}

/// Returns the hypothesis whose mark is at a screen position.
pub fn at(canvas: &Canvas, position: Pos2) -> Option<Pointing> {
    let (shown, _) = canvas.shown()?;
    let hypotheses = shown.estimate.hypotheses().iter().take(DRAWN).enumerate();
    let places = hypotheses.map(|(number, hypothesis)| {
        (number, place(canvas, &canvas.side.epipole(hypothesis.fundamental())).0)
    });
    Pointing::nearest(places, position, theme::GRAB_RADIUS, Target::Hypothesis)
}

/// Draws the mark of an epipole: a diamond, or an arrow at the edge.
pub(super) fn mark(canvas: &Canvas, epipole: &HomogeneousPoint, color: Color32, size: f32) {
    let (at, outwards) = place(canvas, epipole);
    // Arrows belong to the window; in a figure they would be marks in the picture.
    if canvas.is_figure && outwards.is_some() {
        return;
    }
    let corners = match outwards {
        None => {
            [vec2(0.0, -1.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(-1.0, 0.0)].map(|d| at + d * 5.0 * size)
        }
        Some(along) => {
            let (tip, side) = (along * 6.0 * size, along.rot90() * 4.5 * size);
            [at + tip, at - tip + side, at - tip * 0.5, at - tip - side]
        }
    };
    let halo = Stroke::new(1.5, theme::HALO.gamma_multiply(f32::from(color.a()) / 255.0));
    canvas.painter.add(Shape::closed_line(corners.to_vec(), halo));
    let (one, two) = ([corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]);
    for triangle in [one, two] {
        canvas.painter.add(Shape::convex_polygon(triangle.to_vec(), color, Stroke::NONE));
    }
}

/// Returns the position of the mark, with a direction if it is an arrow at the edge.
pub(super) fn place(canvas: &Canvas, epipole: &HomogeneousPoint) -> (Pos2, Option<Vec2>) {
    let visible = canvas.sight();
    if let Some(at) = finite_point(epipole).map(|point| canvas.transform.screen_from_image(point))
        && visible.contains(at)
    {
        return (at, None);
    }
    let centre = visible.center();
    let towards = direction(epipole, canvas.transform.image_from_screen(centre));
    let along = vec2(towards.x as f32, towards.y as f32);
    let room = visible.shrink(9.0).size() * 0.5;
    let reach = (room.x / along.x.abs().max(1e-6)).min(room.y / along.y.abs().max(1e-6));
    (centre + along * reach, Some(along))
}

/// Returns the unit direction from a point to a homogeneous point. For a point at infinity, it is
/// one of the two opposite directions.
pub fn direction(point: &HomogeneousPoint, from: crate::geometry::Point) -> Vector {
    let sense = if point.z < 0.0 { -1.0 } else { 1.0 };
    let way = (point.xy() - from.coords * point.z) * sense;
    way.try_normalize(1e-300).unwrap_or_else(Vector::x)
}
