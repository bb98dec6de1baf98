//! The map of the epipoles: the whole image plane in a disc, since most epipoles lie far outside
//! the image.
//!
//! The distance `r` from the image centre, in half diagonals, becomes `r / (r + 1)` radii of the
//! disc. The image lies in the middle, and the rim is infinity, where a position is a direction. A
//! point at infinity lies in two opposite directions and is drawn at both.

use egui::{Color32, Pos2, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};

use super::transform::Transform;
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::document::Side;
use crate::app::model::focus::Target;
use crate::app::model::ids::OverlayId;
use crate::app::view::theme;
use crate::geometry::{Frame, HomogeneousPoint, Vector};

/// Range of the radius, screen points: smaller in a small pane, but readable.
const RADIUS: std::ops::RangeInclusive<f32> = 26.0..=40.0;
/// Radius as a share of the pane's shorter side.
const SHARE: f32 = 0.12;
/// Distance from the corner of the pane, screen points.
const MARGIN: f32 = 6.0;
/// Number of hypotheses drawn, by rank.
const DRAWN: usize = 60;
/// Share of the radius beyond which a position is also drawn on the opposite side: epipoles of
/// similar geometries may lie far away on either side.
const FAR: f64 = 0.9;
/// Opacity of a map that would be in the way.
const FADED: f32 = 0.35;
/// Distance within which the cursor snaps to a mark, screen points.
const REACH: f32 = 8.0;

/// The whole image plane on a disc.
struct PlaneDisc {
    centre: Pos2,
    radius: f32,
    frame: Frame,
}

impl PlaneDisc {
    /// Returns the position of a point, and whether it is so far out that it also lies opposite.
    fn place(&self, point: &HomogeneousPoint) -> (Pos2, bool) {
        let middle = self.frame.centre();
        let unit = self.frame.diagonal() / 2.0;
        // In half diagonals, times the third coordinate, which may be zero.
        let away = Vector::new(point.x - middle.x * point.z, point.y - middle.y * point.z) / unit;
        let (length, weight) = (away.norm(), point.z.abs());
        let sense = if point.z < 0.0 { -1.0 } else { 1.0 };
        let share = if length > 0.0 { length / (length + weight) } else { 0.0 };
        let along = away.try_normalize(1e-300).unwrap_or_else(Vector::zeros) * (sense * share);
        (self.centre + vec2(along.x as f32, along.y as f32) * self.radius, share > FAR)
    }

    /// Returns the mark within reach of the cursor; of equally near marks the better-ranked one.
    fn nearest(&self, places: &[(Pos2, bool)], cursor: Pos2) -> Option<usize> {
        let distance = |(at, infinite): &(Pos2, bool)| {
            let distance = at.distance(cursor);
            if *infinite { distance.min(self.opposite(*at).distance(cursor)) } else { distance }
        };
        let near = places.iter().map(distance).enumerate().filter(|(_, distance)| *distance <= REACH);
        near.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(rank, _)| rank)
    }

    fn opposite(&self, at: Pos2) -> Pos2 {
        self.centre - (at - self.centre)
    }

    /// Returns the outline of the image, slightly bent by the disc.
    fn outline(&self) -> Vec<Pos2> {
        let corners = self.frame.corners();
        let mut points = Vec::new();
        for k in 0..4 {
            let (from, to) = (corners[k], corners[(k + 1) % 4]);
            let steps = (0..6).map(|step| from + (to - from) * (f64::from(step) / 6.0));
            points.extend(steps.map(|point| self.place(&point.to_homogeneous()).0));
        }
        points
    }
}

/// Returns the centre of the map and whether it covers no clicked point. The lower right corner is
/// preferred, then any free corner.
fn place(pane: Rect, radius: f32, points: &[Pos2]) -> (Pos2, bool) {
    let room = pane.shrink(radius + MARGIN);
    let reach = radius + theme::GRAB_RADIUS;
    let is_free = |centre: &Pos2| points.iter().all(|point| point.distance(*centre) > reach);
    let corners = [room.right_bottom(), room.left_bottom(), room.right_top(), room.left_top()];
    corners.into_iter().find(is_free).map_or((corners[0], false), |corner| (corner, true))
}

/// Draws the map in a corner without clicked points. The mark under the cursor is highlighted in
/// the whole window; a click on it chooses the hypothesis. Hidden overlays are left out.
pub fn show(ui: &mut Ui, transform: &Transform, side: Side, model: &Model, commands: &mut Vec<Command>) {
    let Some(shown) = model.shown() else { return };
    let Some(frame) = model.document.frame(side) else { return };
    let (dots, rings) = (model.look.shows(OverlayId::Hypotheses), model.look.shows(OverlayId::Epipoles));
    let pane = transform.rect;
    let side_length = pane.width().min(pane.height());
    let radius = (side_length * SHARE).clamp(*RADIUS.start(), *RADIUS.end());
    if side_length < 4.0 * radius || !(dots || rings) {
        return;
    }
    let points = model.document.points(side).map(|(_, point)| transform.screen_from_image(point));
    let (centre, free) = place(pane, radius, &points.collect::<Vec<_>>());
    let disc = PlaneDisc { centre, radius, frame };
    let area = Rect::from_center_size(centre, vec2(radius, radius) * 2.0);
    // While this image expects a click, clicks on the map go to the image.
    let is_due = model.document.half.is_some_and(|half| half.side != side);
    let hypotheses = shown.estimate.hypotheses();
    let drawn = if dots { hypotheses.len().min(DRAWN) } else { 0 };
    let places: Vec<(Pos2, bool)> =
        hypotheses[..drawn].iter().map(|h| disc.place(&side.epipole(h.fundamental()))).collect();
    let cursor = ui.input(|input| input.pointer.hover_pos());
    let cursor = cursor.filter(|_| free && !is_due && ui.rect_contains_pointer(area));
    let nearest = cursor.and_then(|cursor| disc.nearest(&places, cursor));
    // Clicks that hit no mark go to the image below.
    let sense = if nearest.is_some() { Sense::click() } else { Sense::hover() };
    let response = ui.interact(area, ui.scope_id().with("epipole map"), sense);
    let name = format!("epipole map of the {} image", side.name());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &name));
    let mut painter = ui.painter_at(area.expand(4.0));
    let pointed = ui.rect_contains_pointer(area);
    if !free || is_due && pointed {
        painter.set_opacity(FADED);
    }
    painter.circle_filled(centre, radius, Color32::from_black_alpha(190));
    painter.circle_stroke(centre, radius, Stroke::new(1.0, Color32::from_gray(150)));
    painter.add(Shape::closed_line(disc.outline(), Stroke::new(1.2, Color32::from_gray(215))));

    for (rank, (at, infinite)) in places.into_iter().enumerate().rev() {
        let bright = 1.0 - rank as f32 / drawn as f32;
        let mut color = theme::HYPOTHESIS.gamma_multiply(0.2 + 0.7 * bright * bright);
        let mut size = 2.2;
        let lit = model.open.focus.hovered() == Some(Target::Hypothesis(rank));
        if lit || shown.hypothesis.is_some_and(|(number, _)| number == rank) {
            (color, size) = (theme::SELECTED, 3.6);
        }
        painter.circle_filled(at, size, color);
        if infinite {
            painter.circle_filled(disc.opposite(at), size, color);
        }
    }
    let truth = model.truth().map(|truth| (&truth.fundamental, theme::TRUE, 6.5));
    let marked = truth.into_iter().chain([(shown.fundamental, theme::ESTIMATED, 4.5)]);
    for (f, color, radius) in marked.filter(|_| rings) {
        let (at, infinite) = disc.place(&side.epipole(f));
        for at in std::iter::once(at).chain(infinite.then(|| disc.opposite(at))) {
            painter.circle_stroke(at, radius, Stroke::new(3.5, theme::HALO));
            painter.circle_stroke(at, radius, Stroke::new(2.0, color));
        }
    }
    if let Some(rank) = nearest {
        commands.push(Command::PointAt(Target::Hypothesis(rank)));
        if response.clicked() {
            commands.push(Command::ChooseHypothesis(Some(rank)));
        }
    }
    response.on_hover_text(
        "The whole plane of this image: the image in the middle, infinity at the rim. Green ring: epipole \
         of the geometry shown. Blue ring: true epipole, where known. Dots: epipoles of the hypotheses; \
         click a dot to show its hypothesis.",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_dodges_points_as_long_as_there_is_a_free_corner() {
        let pane = Rect::from_min_max(Pos2::ZERO, Pos2::new(400.0, 300.0));
        let corners =
            [(350.0, 260.0), (40.0, 270.0), (360.0, 30.0), (30.0, 30.0)].map(|(x, y)| Pos2::new(x, y));
        let expected =
            [(354.0, 254.0), (46.0, 254.0), (354.0, 46.0), (46.0, 46.0)].map(|(x, y)| Pos2::new(x, y));
        for taken in 0..4 {
            assert_eq!(place(pane, 40.0, &corners[..taken]), (expected[taken], true));
        }
        assert_eq!(place(pane, 40.0, &corners), (expected[0], false));
    }

    #[test]
    fn the_image_is_in_the_middle_and_infinity_at_the_rim() {
        let frame = Frame::new(101, 61);
        let disc = PlaneDisc { centre: Pos2::new(200.0, 100.0), radius: 40.0, frame };
        let radius =
            |x, y, z| (disc.place(&HomogeneousPoint::new(x, y, z)).0 - disc.centre).length() / disc.radius;
        assert!(radius(50.0, 30.0, 1.0) < 1e-6);
        assert!((radius(101.0, 61.0, 1.0) - 0.5).abs() < 0.02, "a corner is half way out");
        assert!((radius(1.0, 2.0, 0.0) - 1.0).abs() < 1e-6);
        let (right, infinite) = disc.place(&HomogeneousPoint::new(-3.0, 0.0, 0.0));
        assert!(infinite && (right.y - disc.centre.y).abs() < 1e-4);
        // The sign of a homogeneous point has no meaning.
        let (a, b) = (HomogeneousPoint::new(900.0, 40.0, 1.0), HomogeneousPoint::new(-900.0, -40.0, -1.0));
        assert!((disc.place(&a).0 - disc.place(&b).0).length() < 1e-4);
        assert!(disc.place(&a).0.x > disc.centre.x);
    }
}
