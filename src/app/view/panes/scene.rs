//! The scene of a calibrated pair: both cameras and the triangulated matches, seen from outside.

use std::fmt::Write;

use egui::{
    Align, Align2, Color32, FontId, Mesh, Painter, PointerButton, Pos2, Rect, Sense, Stroke, Ui, WidgetInfo,
    vec2,
};
use nalgebra::{Vector2, Vector3};

use super::chip::label;
use super::{ImagePane, zoom_asked};
use crate::app::model::scene::Scene;
use crate::app::model::{Command, Model, Side, Target};
use crate::app::view::theme;
use crate::camera::{Orbit, PointCloud};
use crate::presentation::NO_BASELINE;

/// Distance from a point within which the cursor points at it, screen points.
const REACH: f32 = 9.0;
/// Side of a point as far away as the middle of the view, screen points.
const POINT: f32 = 3.6;
/// Difference of the intensities of a point and of the ground below which the point has an edge.
const LEAST_CONTRAST: f32 = 0.25;
/// Length of the axes in the corner, screen points.
const AXIS: f64 = 26.0;
/// Share of the width that a small picture may take, and the space around it in screen points.
const SMALL: f32 = 0.24;
const MARGIN: f32 = 10.0;

/// Shows the scene in all available space, with small pictures for the match under the cursor.
pub fn show(ui: &mut Ui, panes: &mut [ImagePane; 2], model: &Model, commands: &mut Vec<Command>) {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "3-D scene"));
    let Some(scene) = model.scene() else {
        let why = if model.awaits_scene() {
            "The 3-D points appear once the search has ended."
        } else if model.epipole_is_open() {
            NO_BASELINE
        } else {
            return;
        };
        label(ui.painter(), rect.center(), Align2::CENTER_CENTER, why, theme::SELECTED);
        return;
    };
    let size = Vector2::new(f64::from(rect.width()), f64::from(rect.height()));
    let was = model.open.orbit.unwrap_or_else(|| Orbit::fitting(&scene.cloud, size));
    let mut orbit = was;
    // Screen positions of the model are shares of the shorter side.
    let share = |v: egui::Vec2| Vector2::new(f64::from(v.x), f64::from(v.y)) / size.min().max(1.0);
    let drag = share(response.drag_delta());
    if drag != Vector2::zeros() {
        let pans = !response.dragged_by(PointerButton::Primary) || ui.input(|input| input.modifiers.shift);
        orbit = if pans { orbit.panned(drag) } else { orbit.turned(drag) };
    }
    if let Some((at, factor)) = zoom_asked(ui, &response) {
        orbit = orbit.zoomed(share(at - rect.center()), factor);
    }
    if orbit != was {
        commands.push(Command::LookAtScene(Some(orbit)));
    }
    let cursor = response.hover_pos().filter(|_| !response.dragged());
    let reach = share(vec2(REACH, 0.0)).x;
    let under = cursor.and_then(|at| orbit.nearest(&scene.cloud, share(at - rect.center()), reach));
    if let Some(number) = under {
        commands.push(Command::PointAt(Target::Match(number)));
        ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    if let Some(number) = under.filter(|_| response.clicked()) {
        commands.push(Command::ShowMatch(number));
    } else if response.double_clicked() {
        commands.push(Command::LookAtScene(None));
    }
    let (text, ground) = (ui.visuals().text_color(), theme::palette(ui.visuals()).canvas);
    let drawing = Drawing { painter: ui.painter_at(rect), rect, orbit, text, ground };
    drawing.points(scene);
    drawing.cameras(scene);
    drawing.axes();
    if let Some(Target::Match(number)) = model.open.focus.hovered()
        && let Some(at) = drawing.pointed(scene, number)
    {
        small_pictures(&drawing, panes, model, number, at);
    }
    drawing.chip(scene, model);
}

/// Height of the text at the upper left, screen points.
const CHIP: f32 = 24.0;

/// Shows a match in small copies of both pictures, each in a corner of its side. They are on the other half of the
/// height than the scene point, so that they never cover it.
fn small_pictures(drawing: &Drawing, panes: &mut [ImagePane; 2], model: &Model, number: usize, at: Pos2) {
    let Some(pair) = model.matched_pairs().nth(number) else { return };
    let mut room = drawing.rect.shrink(MARGIN);
    room.min.y += CHIP;
    let size = drawing.rect.size() * vec2(SMALL, 2.0 * SMALL);
    let below = at.y < room.center().y;
    for (side, along) in Side::BOTH.into_iter().zip([Align::Min, Align::Max]) {
        let corner = Align2([along, if below { Align::Max } else { Align::Min }]);
        let area = corner.align_size_within_rect(size, room);
        let taken = panes[side.index()].draw_small(&drawing.painter, area, corner, side.point(&pair));
        label(&drawing.painter, taken.left_bottom(), Align2::LEFT_BOTTOM, side.title(), theme::SELECTED);
    }
}

struct Drawing {
    painter: Painter,
    rect: Rect,
    orbit: Orbit,
    /// Colours of lines and texts, and of the ground.
    text: Color32,
    ground: Color32,
}

impl Drawing {
    /// Returns a function from a place to its screen position and its relative depth.
    fn projection(&self) -> impl Fn(&Vector3<f64>) -> Option<(Pos2, f32)> {
        let (project, middle) = (self.orbit.projection(), self.rect.center());
        let scale = f64::from(self.rect.size().min_elem());
        move |place| {
            let (at, depth) = project(place)?;
            let at = at * scale;
            Some((middle + vec2(at.x as f32, at.y as f32), depth as f32))
        }
    }

    /// Draws all points as squares in one mesh, far ones first.
    fn points(&self, scene: &Scene) {
        let project = self.projection();
        let visible = self.rect.expand(POINT);
        let points = scene.cloud.points.iter();
        let mut seen: Vec<(f32, Pos2, [u8; 3])> = points
            .filter_map(|point| project(&point.place).map(|(at, depth)| (depth, at, point.color)))
            .filter(|(_, at, _)| visible.contains(*at))
            .collect();
        seen.sort_by(|a, b| b.0.total_cmp(&a.0));
        let ground = self.ground.intensity();
        let (mut edges, mut mesh) = (Mesh::default(), Mesh::default());
        for (depth, at, [red, green, blue]) in seen {
            let side = (POINT / depth).clamp(2.0, 8.0);
            let square = |side: f32| Rect::from_center_size(at, vec2(side, side));
            let color = Color32::from_rgb(red, green, blue);
            mesh.add_colored_rect(square(side), color);
            if (color.intensity() - ground).abs() < LEAST_CONTRAST {
                edges.add_colored_rect(square(side + 1.4), self.text.gamma_multiply(0.3));
            }
        }
        self.painter.add(edges);
        self.painter.add(mesh);
    }

    /// Draws both cameras as pyramids with their names, and the baseline.
    fn cameras(&self, scene: &Scene) {
        let project = self.projection();
        let line = |from: &Vector3<f64>, to: &Vector3<f64>, stroke: Stroke| {
            if let (Some((from, _)), Some((to, _))) = (project(from), project(to)) {
                self.painter.line_segment([from, to], stroke);
            }
        };
        let cameras = self.orbit.cameras(&scene.cloud);
        let [left, right] = &cameras;
        line(&left[0], &right[0], Stroke::new(1.0, self.text.gamma_multiply(0.6)));
        for (side, corners) in Side::BOTH.into_iter().zip(&cameras) {
            let color = theme::CAMERAS[side.index()];
            for [from, to] in PointCloud::EDGES {
                line(&corners[from], &corners[to], Stroke::new(1.6, color));
            }
            if let Some((at, _)) = project(&corners[0]) {
                label(&self.painter, at + vec2(0.0, 6.0), Align2::CENTER_TOP, side.title(), color);
            }
        }
    }

    /// Draws the directions of the axes of camera 1, at the lower left.
    fn axes(&self) {
        let origin = self.rect.left_bottom() + vec2(44.0, -44.0);
        let rotation = self.orbit.rotation();
        let color = self.text.gamma_multiply(0.7);
        for (axis, name) in [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().zip(["x", "y", "z"]) {
            let way = rotation * axis * AXIS;
            let way = vec2(way.x as f32, way.y as f32);
            self.painter.line_segment([origin, origin + way], Stroke::new(1.2, color));
            let font = FontId::proportional(theme::CAPTION);
            self.painter.text(origin + way * 1.3, Align2::CENTER_CENTER, name, font, color);
        }
    }

    /// Highlights a point, with the rays of both cameras to it. Returns its screen position.
    fn pointed(&self, scene: &Scene, number: usize) -> Option<Pos2> {
        let project = self.projection();
        let place = scene.point(number)?.place;
        let (at, _) = project(&place)?;
        for (corners, color) in scene.cloud.cameras.iter().zip(theme::CAMERAS) {
            if let Some((from, _)) = project(&corners[0]) {
                self.painter.line_segment([from, at], Stroke::new(1.0, color));
            }
        }
        for (width, color) in [(4.0, theme::HALO), (2.0, theme::SELECTED)] {
            self.painter.circle_stroke(at, theme::HANDLE_RADIUS, Stroke::new(width, color));
        }
        Some(at)
    }

    /// Shows the number of points, the unit and the word of a doubtful verdict at the upper left.
    fn chip(&self, scene: &Scene, model: &Model) {
        let count = scene.cloud.points.len();
        let mut text = format!("{count} points from {} matches · unit: one baseline", scene.fit.matches);
        if let Some(uncertainty) = scene.fit.uncertainty {
            let [turn, deviation] = [scene.fit.pose.angle(), uncertainty.rotation].map(f64::to_degrees);
            text = format!("{text} · turned by {turn:.2}° ± {deviation:.2}°");
        }
        if scene.focal_deviation() > 0.0 {
            let _ = write!(text, " · focal lengths ± {:.0} %", 100.0 * scene.focal_deviation());
        }
        if let Some((word, _)) = model.doubt() {
            text = format!("{text} · {word}");
        }
        label(&self.painter, self.rect.min + vec2(6.0, 6.0), Align2::LEFT_TOP, &text, theme::SELECTED);
    }
}
