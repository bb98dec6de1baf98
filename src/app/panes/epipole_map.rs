//! The map of the epipoles: the whole plane of an image in a disc, since epipoles are mostly far outside the image.
//!
//! The distance `r` from the middle of the image, in half diagonals, becomes `r / (r + 1)` radii of the disc: the
//! image lies in the middle, and the rim is infinity, where a place is a direction. A point at infinity lies in two
//! opposite directions; it is drawn at both.

use egui::{Color32, Pos2, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};

use crate::app::command::Command;
use crate::app::document::Side;
use crate::app::focus::Target;
use crate::app::scene::Scene;
use crate::app::theme;
use crate::geometry::{Frame, HomogeneousPoint, Vector};

/// Radius of the disc, screen points: smaller in a small pane, never too small to read.
const RADIUS: std::ops::RangeInclusive<f32> = 26.0..=40.0;
/// Its share of the pane's shorter side.
const SHARE: f32 = 0.12;
/// From the corner of the pane, screen points.
const MARGIN: f32 = 6.0;
/// Hypotheses drawn, by rank.
const DRAWN: usize = 60;
/// How near the cursor takes hold of a mark, screen points.
const REACH: f32 = 8.0;

/// The whole plane of an image on a disc.
struct Disc {
    centre: Pos2,
    radius: f32,
    frame: Frame,
}

impl Disc {
    /// Where a point appears, and whether it is so far out that it also lies on the other side of the rim.
    fn place(&self, point: &HomogeneousPoint) -> (Pos2, bool) {
        let middle = self.frame.centre();
        let unit = self.frame.diagonal() / 2.0;
        // In half diagonals, times the third coordinate, which may be zero.
        let away = Vector::new(point.x - middle.x * point.z, point.y - middle.y * point.z) / unit;
        let (length, weight) = (away.norm(), point.z.abs());
        let sense = if point.z < 0.0 { -1.0 } else { 1.0 };
        let share = if length > 0.0 { length / (length + weight) } else { 0.0 };
        let along = away.try_normalize(1e-300).unwrap_or_else(Vector::zeros) * (sense * share);
        (self.centre + vec2(along.x as f32, along.y as f32) * self.radius, share > 0.995)
    }

    fn opposite(&self, at: Pos2) -> Pos2 {
        self.centre - (at - self.centre)
    }

    /// The edge of the image, which the disc bends a little.
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

/// Draws the map in the lower right corner of a pane; a mark under the cursor lights up everywhere, and a click
/// on it chooses the hypothesis.
pub fn show(ui: &mut Ui, pane: Rect, side: Side, frame: Frame, scene: &Scene, commands: &mut Vec<Command>) {
    let Some(shown) = scene.shown() else { return };
    let side_length = pane.width().min(pane.height());
    let radius = (side_length * SHARE).clamp(*RADIUS.start(), *RADIUS.end());
    let centre = pane.max - vec2(radius + MARGIN, radius + MARGIN);
    if side_length < 4.0 * radius {
        return;
    }
    let disc = Disc { centre, radius, frame };
    let area = Rect::from_center_size(centre, vec2(radius, radius) * 2.0);
    let response = ui.interact(area, ui.scope_id().with("epipole map"), Sense::click());
    let name = format!("epipole map of the {} image", side.name());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &name));
    let painter = ui.painter_at(area.expand(4.0));
    painter.circle_filled(centre, radius, Color32::from_black_alpha(190));
    painter.circle_stroke(centre, radius, Stroke::new(1.0, Color32::from_gray(150)));
    painter.add(Shape::closed_line(disc.outline(), Stroke::new(1.2, Color32::from_gray(215))));

    let epipole = |f: &crate::geometry::FundamentalMatrix| match side {
        Side::Left => f.epipole1(),
        Side::Right => f.epipole2(),
    };
    let hypotheses = shown.estimate.hypotheses();
    let drawn = hypotheses.len().min(DRAWN);
    let mut nearest: Option<(usize, f32)> = None;
    for (rank, hypothesis) in hypotheses.iter().take(drawn).enumerate().rev() {
        let (at, infinite) = disc.place(&epipole(hypothesis.fundamental()));
        let bright = 1.0 - rank as f32 / drawn as f32;
        let mut color = theme::HYPOTHESIS.gamma_multiply(0.2 + 0.7 * bright * bright);
        let mut size = 2.2;
        let lit = scene.focus.hovered() == Some(Target::Hypothesis(rank));
        if lit || shown.hypothesis.is_some_and(|(number, _)| number == rank) {
            (color, size) = (theme::SELECTED, 3.6);
        }
        painter.circle_filled(at, size, color);
        if infinite {
            painter.circle_filled(disc.opposite(at), size, color);
        }
        if let Some(cursor) = response.hover_pos() {
            let distance = at.distance(cursor);
            let distance = if infinite { distance.min(disc.opposite(at).distance(cursor)) } else { distance };
            // Of two at the same place the better one.
            if distance <= nearest.map_or(REACH, |(_, distance)| distance) {
                nearest = Some((rank, distance));
            }
        }
    }
    let truth = scene.truth().map(|truth| (&truth.fundamental, theme::TRUE, 6.5));
    for (f, color, radius) in truth.into_iter().chain([(shown.fundamental, theme::ESTIMATED, 4.5)]) {
        let (at, infinite) = disc.place(&epipole(f));
        for at in std::iter::once(at).chain(infinite.then(|| disc.opposite(at))) {
            painter.circle_stroke(at, radius, Stroke::new(3.5, theme::HALO));
            painter.circle_stroke(at, radius, Stroke::new(2.0, color));
        }
    }
    if let Some((rank, _)) = nearest {
        commands.push(Command::PointAt(Target::Hypothesis(rank)));
        if response.clicked() {
            commands.push(Command::ChooseHypothesis(Some(rank)));
        }
    } else if response.clicked() {
        commands.push(Command::ChooseHypothesis(None));
    }
    response.on_hover_text(
        "The whole plane of this image: the image in the middle, infinity at the rim. Green ring: the epipole of the \
         geometry shown; blue: the true one, where it is known; dots: those of the hypotheses. Click a dot to show that hypothesis.",
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_is_in_the_middle_and_infinity_at_the_rim() {
        let frame = Frame::new(101, 61);
        let disc = Disc { centre: Pos2::new(200.0, 100.0), radius: 40.0, frame };
        let radius =
            |x, y, z| (disc.place(&HomogeneousPoint::new(x, y, z)).0 - disc.centre).length() / disc.radius;
        assert!(radius(50.0, 30.0, 1.0) < 1e-6);
        assert!((radius(101.0, 61.0, 1.0) - 0.5).abs() < 0.02, "a corner is half way out");
        assert!((radius(1.0, 2.0, 0.0) - 1.0).abs() < 1e-6);
        let (right, infinite) = disc.place(&HomogeneousPoint::new(-3.0, 0.0, 0.0));
        assert!(infinite && (right.y - disc.centre.y).abs() < 1e-4);
        // The sign of a homogeneous point means nothing.
        let (a, b) = (HomogeneousPoint::new(900.0, 40.0, 1.0), HomogeneousPoint::new(-900.0, -40.0, -1.0));
        assert!((disc.place(&a).0 - disc.place(&b).0).length() < 1e-4);
        assert!(disc.place(&a).0.x > disc.centre.x);
    }
}
