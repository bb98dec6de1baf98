//! A bar beside a figure, from bad (left) to good (right), with a mark at the figure.

use egui::{
    Color32, CornerRadius, Painter, Rect, Response, Sense, Stroke, Ui, Visuals, WidgetInfo, pos2, vec2,
};

use crate::app::model::verdict::{Gauge, Tone};
use crate::app::view::theme;

/// Shows the bar as a line under the figure's text, for rows without room for a separate bar.
pub fn under(ui: &Ui, text: &Response, name: &str, gauge: &Gauge) {
    let Rect { min, max } = text.rect;
    let bar = Rect::from_min_max(pos2(min.x, max.y), pos2(max.x, max.y + 3.0));
    draw(ui.painter(), ui.visuals(), bar, gauge);
    let response = ui.interact(text.rect.union(bar), text.id.with("scale"), Sense::hover());
    label(&response, name, gauge);
    response.on_hover_text(&gauge.words);
}

fn label(response: &Response, name: &str, gauge: &Gauge) {
    response.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Image, true, format!("{name} on its scale: {}", gauge.words))
    });
}

pub fn draw(painter: &Painter, visuals: &Visuals, bar: Rect, gauge: &Gauge) {
    let at = |place: f32| egui::lerp(bar.x_range(), place);
    let part = |from: f32, to: f32| Rect::from_min_max(pos2(at(from), bar.min.y), pos2(at(to), bar.max.y));
    let weak = visuals.weak_text_color().gamma_multiply(0.45);
    match gauge.limits {
        Some([bad, good]) => {
            for (from, to, tone) in
                [(0.0, bad, Tone::Bad), (bad, good, Tone::Caution), (good, 1.0, Tone::Good)]
            {
                let color = tone_color(visuals, tone);
                let color = if gauge.tone == Some(tone) { color } else { color.gamma_multiply(0.3) };
                painter.rect_filled(part(from, to), CornerRadius::ZERO, color);
            }
        }
        None => drop(painter.rect_filled(bar, CornerRadius::ZERO, weak)),
    }
    let mark = Rect::from_center_size(pos2(at(gauge.place), bar.center().y), vec2(3.0, bar.height() + 3.0));
    let mark = mark.translate(vec2(bar.min.x - mark.min.x, 0.0).max(vec2(0.0, 0.0)));
    let mark = mark.translate(vec2(bar.max.x - mark.max.x, 0.0).min(vec2(0.0, 0.0)));
    painter.rect_filled(mark, CornerRadius::same(1), visuals.strong_text_color());
    painter.rect_stroke(
        mark,
        CornerRadius::same(1),
        Stroke::new(1.0, visuals.panel_fill),
        egui::StrokeKind::Outside,
    );
}

pub fn tone_color(visuals: &Visuals, tone: Tone) -> Color32 {
    let palette = theme::palette(visuals);
    match tone {
        Tone::Idle | Tone::Busy => visuals.weak_text_color(),
        Tone::Apart => visuals.text_color(),
        Tone::Good => palette.good,
        Tone::Caution => palette.caution,
        Tone::Bad => palette.bad,
    }
}
