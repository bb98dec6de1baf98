//! Colours of matrices, maps and legends.

use egui::{Color32, Painter, Rect, epaint, pos2};

/// Returns the grey of a similarity from 0 (dark) to 1 (white).
pub fn grey(share: f32) -> Color32 {
    Color32::from_gray((share * 255.0) as u8)
}

/// Returns the colour of a disparity, or of a place along a line, from 0 (dark) to 1 (bright).
pub fn color(share: f32) -> Color32 {
    let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(f64::from(share));
    Color32::from_rgb(r, g, b)
}

/// Draws colours as a bar, for a legend.
pub fn bar(painter: &Painter, rect: Rect, color: fn(f32) -> Color32) {
    let mut mesh = epaint::Mesh::default();
    for k in 0..=8 {
        let share = k as f32 / 8.0;
        let x = egui::lerp(rect.x_range(), share);
        mesh.colored_vertex(pos2(x, rect.min.y), color(share));
        mesh.colored_vertex(pos2(x, rect.max.y), color(share));
        if k > 0 {
            let v = 2 * k as u32;
            mesh.add_triangle(v - 2, v - 1, v);
            mesh.add_triangle(v - 1, v, v + 1);
        }
    }
    painter.add(mesh);
}
