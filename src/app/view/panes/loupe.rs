//! The loupe beside the cursor, which magnifies the point being placed or dragged.

use egui::{CornerRadius, Painter, Pos2, Rect, Stroke, StrokeKind, pos2, vec2};

use super::Transform;
use crate::app::view::theme;
use crate::geometry::Point;

/// Width and height of the loupe, screen points.
const SIDE: f32 = 132.0;
/// Distance from the cursor to its nearest corner, screen points.
const GAP: f32 = 26.0;
/// Range of the magnification relative to the pane. More would lose the context.
const TIMES: std::ops::RangeInclusive<f64> = 4.0..=12.0;
/// Preferred width of an image pixel, screen points: wide enough to distinguish pixels.
const PIXEL: f64 = 8.0;
/// Scale of the pane from which a loupe shows nothing new, screen points per pixel.
const ENOUGH: f64 = 16.0;

/// Returns the transform of a loupe around a point, beside places that it must not cover; `None` if the
/// pane is magnified enough.
pub fn place(pane: &Transform, point: Point, uncovered: &[Pos2]) -> Option<Transform> {
    if pane.scale >= ENOUGH {
        return None;
    }
    let at = pane.screen_from_image(point);
    let (above, below) = (at.y - GAP - SIDE, at.y + GAP);
    let (left, right) = (at.x - GAP - SIDE, at.x + GAP);
    // Above and to the right first, clear of a pointing hand.
    let corners = [(right, above), (left, above), (right, below), (left, below)];
    let areas = corners.map(|(x, y)| Rect::from_min_size(pos2(x, y), vec2(SIDE, SIDE)));
    let inside = |area: &&Rect| pane.rect.contains_rect(**area);
    let clear = |area: &&Rect| !uncovered.iter().any(|at| area.expand(GAP / 2.0).contains(*at));
    let found = areas.iter().filter(inside).find(clear).or(areas.iter().find(inside));
    let rect = *found.unwrap_or(&areas[0]);
    let scale = PIXEL.clamp(pane.scale * TIMES.start(), pane.scale * TIMES.end());
    Some(pane.around(point, rect, scale))
}

/// Draws cross hairs and a frame over the pixels.
pub fn finish(painter: &Painter, transform: &Transform) {
    let (rect, centre) = (transform.rect, transform.rect.center());
    // The gap of the cross hairs is one image pixel.
    let pixel = (transform.scale * 0.5).max(3.0) as f32;
    for (width, color) in [(3.0, theme::HALO), (1.2, theme::SELECTED)] {
        let stroke = Stroke::new(width, color);
        for arm in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
            painter.line_segment([centre + arm * pixel, centre + arm * (pixel + 14.0)], stroke);
        }
        painter.rect_stroke(rect, CornerRadius::same(6), Stroke::new(width + 0.8, color), StrokeKind::Inside);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loupe_stays_in_the_pane_and_off_the_cursor() {
        let rect = Rect::from_min_size(pos2(100.0, 50.0), vec2(600.0, 400.0));
        let pane = Transform::new(rect, Point::new(300.0, 200.0), 1.0);
        for at in [(0.0, 0.0), (599.0, 0.0), (0.0, 399.0), (599.0, 399.0), (300.0, 200.0)] {
            let loupe = place(&pane, Point::new(at.0, at.1), &[]).unwrap();
            assert!(rect.contains_rect(loupe.rect), "{at:?}");
            assert!(!loupe.rect.contains(pane.screen_from_image(Point::new(at.0, at.1))), "{at:?}");
            let centre = loupe.image_from_screen(loupe.rect.center());
            assert!((centre - Point::new(at.0, at.1)).norm() < 1e-9);
            let covered = loupe.rect.center();
            let beside = place(&pane, Point::new(at.0, at.1), &[covered]).unwrap();
            // In a corner of the pane only one place is inside.
            assert!(!beside.rect.contains(covered) || at != (300.0, 200.0), "{at:?}");
        }
        assert!(place(&Transform::new(rect, Point::origin(), ENOUGH), Point::origin(), &[]).is_none());
    }
}
