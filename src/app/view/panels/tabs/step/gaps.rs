//! The round trips of all hypotheses, on one axis.

use egui::{Align2, FontId, Sense, Stroke, Ui, WidgetInfo, pos2};

use super::super::empty;
use super::touch;
use crate::app::model::{Command, Model, Target};
use crate::app::view::theme;

/// Least distance on the axis, px. Smaller ones are as good as none.
const LEAST: f64 = 0.1;
/// Largest distance from which a dot is pointed at, screen points.
const REACH: f32 = 7.0;

/// Shows the distances as dots. The one under the cursor shows its lines in the images.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let Some(record) = model.record().filter(|record| !record.gaps.is_empty()) else {
        empty(ui, "The distances between lines and their returns appear here. This search has none.");
        return;
    };
    ui.weak("Round trip: how far l and G H l are apart. Each dot is a hypothesis.");
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "round trips of the hypotheses"));
    let visuals = ui.visuals();
    let painter = ui.painter_at(area);
    let plot = area.shrink2(egui::vec2(16.0, 0.0)).with_max_y(area.max.y - 20.0);
    let most = record.gaps.iter().map(|(gap, _)| *gap).fold(10.0 * LEAST, f64::max).log10().ceil();
    let least = LEAST.log10();
    let x = |gap: f64| {
        let share = (gap.max(LEAST).log10() - least) / (most - least);
        egui::lerp(plot.x_range(), share as f32)
    };
    let weak = visuals.weak_text_color();
    let edge = visuals.widgets.noninteractive.bg_stroke.color;
    painter.hline(plot.x_range(), plot.max.y, Stroke::new(1.0, edge));
    for power in least as i32..=most as i32 {
        let gap = 10f64.powi(power);
        painter.vline(x(gap), plot.y_range(), Stroke::new(1.0, edge.gamma_multiply(0.6)));
        let text = if gap < 1.0 { format!("{gap:.1} px") } else { format!("{gap:.0} px") };
        // The labels of both ends stay inside.
        let (at, align) = match power {
            _ if power == least as i32 => (area.min.x + 2.0, Align2::LEFT_TOP),
            _ if power == most as i32 => (area.max.x - 2.0, Align2::RIGHT_TOP),
            _ => (x(gap), Align2::CENTER_TOP),
        };
        painter.text(pos2(at, plot.max.y + 3.0), align, text, FontId::proportional(11.0), weak);
    }
    let mut nearest: Option<(f32, Target)> = None;
    for (k, (gap, number)) in record.gaps.iter().enumerate() {
        // Dots side by side would hide each other.
        let row = (k * 7 % 11) as f32 / 11.0;
        let y = egui::lerp(plot.min.y + 24.0..=plot.max.y - 8.0, row);
        let (at, target) = (pos2(x(*gap), y), Target::Hypothesis(*number));
        let is_lit = model.open.focus.hovered() == Some(target);
        let color = if is_lit { theme::HOVER } else { theme::UNCHECKED.gamma_multiply(0.8) };
        painter.circle_filled(at, 3.0, color);
        let away = response.hover_pos().map_or(f32::INFINITY, |cursor| cursor.distance(at));
        if away <= nearest.map_or(REACH, |(least, _)| least) {
            nearest = Some((away, target));
        }
    }
    if let Some((_, target)) = nearest {
        touch(target, response.clicked(), model, commands);
    }
    if let Some(gap) = model.open.replay.moment().and_then(|moment| moment.gap) {
        painter.vline(x(gap), plot.y_range(), Stroke::new(2.0, theme::FORWARD));
        let align = if x(gap) > plot.center().x { Align2::RIGHT_TOP } else { Align2::LEFT_TOP };
        let beside = if x(gap) > plot.center().x { -6.0 } else { 6.0 };
        let at = pos2(x(gap) + beside, plot.min.y + 2.0);
        painter.text(
            at,
            align,
            format!("{gap:.1} px apart"),
            FontId::proportional(13.0),
            visuals.text_color(),
        );
    }
}
