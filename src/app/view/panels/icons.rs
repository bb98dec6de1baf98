//! The buttons of the top bar. Their icons are drawn as strokes: the text fonts have none.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{
    Button, Color32, Painter, PopupCloseBehavior, Pos2, Response, RichText, Shape, Stroke, Ui, Vec2, pos2,
    vec2,
};

use crate::app::view::theme;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Icon {
    Open,
    Save,
    Undo,
    Redo,
    Pin,
    Fit,
    Brightness,
    Search,
}

pub const ICON: egui::Vec2 = vec2(28.0, 26.0);
/// Half of the side of an icon, screen points.
const HALF: f32 = 7.0;

impl Icon {
    pub fn draw(self, painter: &Painter, centre: Pos2, color: Color32) {
        let stroke = Stroke::new(1.4, color);
        let at = |x: f32, y: f32| pos2(centre.x + x * HALF, centre.y + y * HALF);
        let path = |points: &[(f32, f32)]| points.iter().map(|(x, y)| at(*x, *y)).collect::<Vec<_>>();
        let line = |points: &[(f32, f32)]| {
            painter.line(path(points), stroke);
        };
        let outline = |points: &[(f32, f32)]| {
            painter.add(Shape::closed_line(path(points), stroke));
        };
        match self {
            Self::Open => {
                outline(&[(-1.0, -0.75), (-0.3, -0.75), (0.0, -0.4), (1.0, -0.4), (1.0, 0.8), (-1.0, 0.8)]);
            }
            Self::Save => {
                outline(&[(-0.9, -0.9), (0.55, -0.9), (0.9, -0.55), (0.9, 0.9), (-0.9, 0.9)]);
                line(&[(-0.45, 0.9), (-0.45, 0.2), (0.45, 0.2), (0.45, 0.9)]);
                line(&[(-0.4, -0.9), (-0.4, -0.4), (0.3, -0.4)]);
            }
            Self::Undo | Self::Redo => {
                let mirror = if self == Self::Undo { 1.0 } else { -1.0 };
                let mirrored = |points: &[(f32, f32)]| {
                    line(&points.iter().map(|(x, y)| (mirror * x, *y)).collect::<Vec<_>>());
                };
                mirrored(&[(-0.35, -0.95), (-0.95, -0.4), (-0.35, 0.15)]);
                mirrored(&[
                    (-0.95, -0.4),
                    (0.3, -0.4),
                    (0.8, -0.15),
                    (0.95, 0.25),
                    (0.75, 0.7),
                    (0.3, 0.85),
                    (-0.3, 0.85),
                ]);
            }
            Self::Pin => {
                outline(&[
                    (-0.45, -1.0),
                    (0.45, -1.0),
                    (0.35, -0.1),
                    (0.75, 0.3),
                    (-0.75, 0.3),
                    (-0.35, -0.1),
                ]);
                line(&[(0.0, 0.3), (0.0, 1.0)]);
            }
            Self::Fit => {
                for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                    line(&[(0.4 * x, 0.9 * y), (0.9 * x, 0.9 * y), (0.9 * x, 0.4 * y)]);
                }
            }
            Self::Brightness => {
                painter.circle_stroke(centre, HALF * 0.85, stroke);
                let half = (0..=16u8).map(|k| {
                    let angle = std::f32::consts::PI * (f32::from(k) / 16.0 - 0.5);
                    centre + HALF * 0.85 * Vec2::angled(angle)
                });
                painter.add(Shape::convex_polygon(half.collect(), color, Stroke::NONE));
            }
            Self::Search => {
                let eye = at(-0.2, -0.2);
                painter.circle_stroke(eye, HALF * 0.6, stroke);
                painter.line_segment([at(0.25, 0.25), at(0.9, 0.9)], stroke);
            }
        }
    }
}

/// Draws the triangle of a button that opens a menu.
fn menu_mark(painter: &Painter, centre: Pos2, color: Color32) {
    let corners = [vec2(-3.5, -2.0), vec2(3.5, -2.0), vec2(0.0, 2.5)].map(|corner| centre + corner);
    painter.add(Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
}

pub fn icon_button(ui: &mut Ui, icon: Icon, enabled: bool, on: bool) -> Response {
    let response = ui.add_enabled(enabled, Button::selectable(on, "").min_size(ICON));
    let color = ui.style().interact_selectable(&response, on).text_color();
    let color = if enabled { color } else { color.gamma_multiply(0.4) };
    icon.draw(ui.painter(), response.rect.center(), color);
    response
}

pub fn menu_button(
    ui: &mut Ui,
    title: RichText,
    fill: Option<egui::Color32>,
    content: impl FnOnce(&mut Ui),
) -> Response {
    let closes = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    // Room for the mark.
    let button = Button::new((title, "   ")).min_size(vec2(0.0, 26.0));
    let button = if let Some(fill) = fill { button.fill(fill) } else { button };
    let (response, _) = MenuButton::from_button(button).config(closes).ui(ui, content);
    let mark = response.rect.right_center() - vec2(12.0, 0.0);
    let color = fill.map_or(ui.visuals().text_color(), |_| theme::palette(ui.visuals()).on_accent);
    menu_mark(ui.painter(), mark, color);
    response
}
