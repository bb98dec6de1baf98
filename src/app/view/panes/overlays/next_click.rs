//! Overlay of the place where one more pair would help most, while the result is doubtful.

use egui::{Shape, Stroke, vec2};

use super::Canvas;
use crate::app::model::document::Side;
use crate::app::view::theme;

const RADIUS: f32 = 11.0;
/// Number of vertices of the dashed ring.
const CORNERS: usize = 36;

pub fn draw(canvas: &Canvas) {
    let Some(Some(next)) = canvas.model.open.next_click else { return };
    if canvas.side != Side::Left {
        return;
    }
    let at = canvas.transform.screen_from_image(next.point);
    let ring: Vec<_> = (0..=CORNERS)
        .map(|k| at + RADIUS * egui::Vec2::angled(std::f32::consts::TAU * k as f32 / CORNERS as f32))
        .collect();
    canvas.painter.circle_stroke(at, RADIUS, Stroke::new(4.0, theme::HALO.gamma_multiply(0.6)));
    canvas.painter.extend(Shape::dashed_line(&ring, Stroke::new(2.0, theme::SELECTED), 5.0, 4.0));
    for arm in [vec2(1.0, 0.0), vec2(0.0, 1.0)] {
        for (color, width) in [(theme::HALO, 3.5), (theme::SELECTED, 1.5)] {
            canvas.painter.line_segment([at - arm * 4.0, at + arm * 4.0], Stroke::new(width, color));
        }
    }
    canvas.label(at, "a pair here helps most", theme::SELECTED);
}
