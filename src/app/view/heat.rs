//! Colour map of matrices and legends.

use egui::{Color32, Painter, Rect, epaint};

use crate::app::model::heat::rgb;

/// Returns the colour of a value from 0 (dark) to 1 (bright).
pub fn color(share: f32) -> Color32 {
    let [red, green, blue] = rgb(share);
    Color32::from_rgb(red, green, blue)
}

/// Draws the colour map as a bar, for a legend.
pub fn bar(painter: &Painter, rect: Rect) {
    let mut mesh = epaint::Mesh::default();
    let stops = 8;
    for k in 0..=stops {
        let share = k as f32 / stops as f32;
        let x = egui::lerp(rect.x_range(), share);
        mesh.colored_vertex(egui::pos2(x, rect.min.y), color(share));
        mesh.colored_vertex(egui::pos2(x, rect.max.y), color(share));
        if k > 0 {
            let v = 2 * k as u32;
            mesh.add_triangle(v - 2, v - 1, v);
            mesh.add_triangle(v - 1, v, v + 1);
        }
    }
    painter.add(mesh);
}
