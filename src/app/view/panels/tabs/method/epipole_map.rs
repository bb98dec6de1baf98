//! The map of the epipoles: the whole image plane in a disc, since most epipoles lie far outside
//! the image.
//!
//! The distance `r` from the image centre, in half diagonals, becomes `r / (r + 1)` radii of the
//! disc. The image lies in the middle, and the rim is infinity, where a position is a direction. A
//! point at infinity lies in two opposite directions and is drawn at both.

use egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};

use crate::app::model::{Command, Model, Side, Target};
use crate::app::view::theme;
use crate::geometry::{Frame, HomogeneousPoint, Vector};

/// Height of the title, screen points.
const CAPTION: f32 = 16.0;
/// Outer radius of the largest ring, screen points. Rings on the rim stay inside the map's own area.
const RING: f32 = 9.0;
/// Number of hypotheses drawn, by rank.
const DRAWN: usize = 60;
/// Share of the radius beyond which a position is also drawn on the opposite side: epipoles of
/// similar geometries may lie far away on either side.
const FAR: f64 = 0.9;
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

/// Draws the map of an image. The mark under the cursor is highlighted in the whole window; a click on
/// it shows its hypothesis.
pub fn show(ui: &mut Ui, area: Rect, side: Side, model: &Model, commands: &mut Vec<Command>) {
    let (Some(shown), Some(frame)) = (model.shown(), model.document.frame(side)) else { return };
    let title = format!("{} epipoles", side.title());
    let font = FontId::proportional(theme::CAPTION);
    let weak = ui.visuals().weak_text_color();
    ui.painter().text(area.center_top(), Align2::CENTER_TOP, title, font, weak);
    let room = area.with_min_y(area.min.y + CAPTION);
    let radius = (room.width().min(room.height()) / 2.0 - RING).max(8.0);
    let centre = room.center();
    let disc = PlaneDisc { centre, radius, frame };
    let area = Rect::from_center_size(centre, vec2(radius, radius) * 2.0);
    let hypotheses = shown.estimate.hypotheses();
    let drawn = hypotheses.len().min(DRAWN);
    let places: Vec<(Pos2, bool)> =
        hypotheses[..drawn].iter().map(|h| disc.place(&side.epipole(h.fundamental()))).collect();
    let cursor = ui.input(|input| input.pointer.hover_pos());
    let nearest =
        cursor.filter(|_| ui.rect_contains_pointer(area)).and_then(|cursor| disc.nearest(&places, cursor));
    let response = ui.interact(area, ui.scope_id().with(("epipole map", side.index())), Sense::click());
    let name = format!("epipole map of the {} image", side.name());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &name));
    let painter = ui.painter_at(area.expand(RING));
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
    let color = theme::line_color(model.line_look());
    let marked = truth.into_iter().chain([(shown.fundamental, color, 4.5)]);
    for (f, color, radius) in marked {
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
        "The whole plane of this image: the image in the middle, infinity at the rim. Ring: epipole \
         of the geometry shown. Blue ring: true epipole, where known. Dots: epipoles of the hypotheses; \
         click a dot to show its hypothesis. \
         Marks near the rim are also drawn on the opposite side, for a far epipole may lie on either.",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

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
