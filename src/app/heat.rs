//! Colours of figures, dark for low and bright for high.

use egui::{Color32, Rect, Ui, epaint};

/// Stops of viridis (van der Walt and Smith, public domain): equal steps look equal, also in grey and with any
/// common colour vision.
const STOPS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// The colour of a share from 0 (dark) to 1 (bright).
pub fn color(share: f32) -> Color32 {
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    let place = share * (STOPS.len() - 1) as f32;
    let first = (place as usize).min(STOPS.len() - 2);
    let (a, b) = (STOPS[first], STOPS[first + 1]);
    let part = place - first as f32;
    let mixed = |k: usize| (f32::from(a[k]) + (f32::from(b[k]) - f32::from(a[k])) * part).round() as u8;
    Color32::from_rgb(mixed(0), mixed(1), mixed(2))
}

/// A bar from dark to bright, as a legend.
pub fn bar(ui: &Ui, rect: Rect) {
    let mut mesh = epaint::Mesh::default();
    let stops = STOPS.len() - 1;
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
    ui.painter().add(mesh);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brightness_grows_all_the_way() {
        let luminance = |share: f32| {
            let c = color(share);
            0.2126 * f32::from(c.r()) + 0.7152 * f32::from(c.g()) + 0.0722 * f32::from(c.b())
        };
        for k in 0..40 {
            assert!(luminance((k + 1) as f32 / 40.0) > luminance(k as f32 / 40.0), "{k}");
        }
        assert_eq!(color(f32::NAN), color(0.0));
    }
}
