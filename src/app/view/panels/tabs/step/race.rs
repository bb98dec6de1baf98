//! The race of the hypotheses: bars of their support, counted place by place.

use egui::{Align2, Color32, FontId, Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::super::empty;
use super::touch;
use crate::app::model::focus::Replayed;
use crate::app::model::replay::moment::Racer;
use crate::app::model::{Command, Model, Target};
use crate::app::view::theme;

/// Largest height of a row, screen points.
const ROW: f32 = 24.0;
/// Widths of the names and of the figures beside the bars.
const NAME: f32 = 165.0;
const VALUE: f32 = 52.0;

/// A bar with its name and its figure.
pub struct Bar {
    pub name: String,
    pub value: String,
    /// Length, a share of the longest possible.
    pub share: f64,
    /// Place from the top, in rows.
    pub row: f64,
    pub color: Color32,
}

/// Shows the race. A bar under the cursor shows its lines in the images.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let moment = model.open.replay.moment().filter(|moment| !moment.race.is_empty());
    let Some(moment) = moment else {
        empty(ui, "The best hypotheses race here. This search has no race to show.");
        return;
    };
    let most = moment.race.iter().map(|own| own.at_end).fold(1e-9, f64::max);
    let target = |own: &Racer| Target::Replayed(Replayed::Racer(own.place));
    let lit = model.open.focus.hovered();
    let bar = |own: &Racer| Bar {
        name: own.name.clone(),
        value: format!("{:.0}", own.support),
        share: own.support / most,
        row: own.row,
        color: match (lit == Some(target(own)), own.row < 0.5) {
            (true, _) => theme::HOVER,
            (false, true) => theme::UNCHECKED,
            (false, false) => theme::UNCHECKED.gamma_multiply(0.6),
        },
    };
    let all: Vec<Bar> = moment.race.iter().map(bar).collect();
    if let Some((k, clicked)) = bars(ui, "race of the hypotheses", &all) {
        touch(target(&moment.race[k]), clicked, model, commands);
    }
}

/// Shows bars, one below the other. Returns the number of the bar under the cursor, and whether it was clicked.
pub fn bars(ui: &mut Ui, name: &str, bars: &[Bar]) -> Option<(usize, bool)> {
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, name));
    let height = (area.height() / bars.len().max(1) as f32).min(ROW);
    let visuals = ui.visuals();
    let painter = ui.painter_at(area);
    let font = FontId::proportional((height * 0.62).clamp(9.0, 13.0));
    for bar in bars {
        let top = area.min.y + height * bar.row as f32;
        let middle = top + height / 2.0;
        let track = Rect::from_min_max(
            pos2(area.min.x + NAME, top + 0.18 * height),
            pos2((area.max.x - VALUE).max(area.min.x + NAME + 20.0), top + 0.82 * height),
        );
        let text = |at, align, text: &str, color| {
            painter.text(at, align, text, font.clone(), color);
        };
        text(pos2(area.min.x, middle), Align2::LEFT_CENTER, &bar.name, visuals.text_color());
        painter.rect_filled(track, 3.0, visuals.faint_bg_color);
        let filled = Rect::from_min_size(
            track.min,
            vec2(track.width() * bar.share.clamp(0.0, 1.0) as f32, track.height()),
        );
        painter.rect_filled(filled, 3.0, bar.color);
        text(pos2(area.max.x, middle), Align2::RIGHT_CENTER, &bar.value, visuals.weak_text_color());
    }
    let row = (response.hover_pos()?.y - area.min.y) / height;
    let k = bars.iter().position(|bar| (f64::from(row) - bar.row - 0.5).abs() <= 0.5)?;
    Some((k, response.clicked()))
}
