//! The crossings of the candidates: a cell for each pair of them, and the hypotheses that were kept.

use egui::{
    Align2, Color32, FontId, Grid, Label, Rect, RichText, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo, pos2, vec2,
};

use super::super::empty;
use super::touch;
use crate::app::model::focus::Replayed;
use crate::app::model::replay::record::Record;
use crate::app::model::verdict::short_epipole_text;
use crate::app::model::{Command, Model, Side, Target};
use crate::app::view::theme;
use crate::estimate::{HypothesisNote, ProposedBy};
use crate::presentation::proposer_in_words;

/// Least side of a cell, screen points.
const CELL: f32 = 4.0;
/// Number of hypotheses listed.
const LISTED: usize = 6;
/// Width from which the cells are beside the list.
const ROOM_FOR_BOTH: f32 = 360.0;

/// Shows the crossings and the best hypotheses. One under the cursor shows its epipoles in the images.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let Some(record) = model.record().filter(|record| !record.hypotheses.is_empty()) else {
        empty(
            ui,
            "Hypotheses appear here during a search. Each is a guess at the geometry, with an epipole in either picture.",
        );
        return;
    };
    let area = ui.available_rect_before_wrap();
    let crosses =
        record.hypotheses.iter().any(|own| matches!(own.origin.source, ProposedBy::LinePairs { .. }));
    let lit = match model.open.focus.hovered() {
        Some(Target::Replayed(Replayed::Hypothesis(k))) => Some(k),
        _ => None,
    };
    let mut hovered = None;
    let list = if crosses && area.width() >= ROOM_FOR_BOTH {
        let side = area.height().min(area.width() * 0.45);
        let (left, right) = area.split_left_right_at_x(area.min.x + side + 24.0);
        let crossed = model.open.replay.moment().and_then(|moment| moment.crossed);
        hovered = cells(ui, left, record, crossed, lit);
        right.with_min_x(right.min.x + theme::GAP)
    } else {
        area
    };
    let listed =
        ui.scope_builder(UiBuilder::new().max_rect(list).id_salt("best"), |ui| best(ui, record, lit));
    if let Some((k, clicked)) = hovered.or(listed.inner) {
        touch(Target::Replayed(Replayed::Hypothesis(k)), clicked, model, commands);
    }
}

/// Shows a cell for each crossing; bright ones gave a hypothesis that was kept. Returns the hypothesis under the cursor,
/// and whether it was clicked.
fn cells(
    ui: &Ui,
    area: Rect,
    record: &Record,
    crossed: Option<[usize; 2]>,
    lit: Option<usize>,
) -> Option<(usize, bool)> {
    let response = ui.interact(area, ui.scope_id().with("crossings"), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "crossings of the candidates"));
    let painter = ui.painter_at(area);
    let side = (area.height() - 18.0).min(area.width() - 18.0).max(20.0);
    let plot = Rect::from_min_size(area.min + vec2(18.0, 0.0), vec2(side, side));
    painter.rect_filled(plot, 0.0, theme::palette(ui.visuals()).canvas);
    let ranks_of = |own: &HypothesisNote| match own.origin.source {
        ProposedBy::LinePairs { ranks } => Some(ranks.map(|rank| rank - 1)),
        _ => None,
    };
    let most = record.hypotheses.iter().filter_map(ranks_of).flatten().max().unwrap_or(0);
    let step = side / (most + 1) as f32;
    let place = |[p, q]: [usize; 2]| {
        let centre = plot.min + vec2((q as f32 + 0.5) * step, (p as f32 + 0.5) * step);
        Rect::from_center_size(centre, vec2(step - 1.0, step - 1.0).max(vec2(CELL, CELL)))
    };
    let count = record.hypotheses.len();
    for (k, own) in record.hypotheses.iter().enumerate().rev() {
        if let Some(ranks) = ranks_of(own) {
            let best = 1.0 - k as f32 / count as f32;
            painter.rect_filled(place(ranks), 0.0, Color32::from_gray((70.0 + 185.0 * best) as u8));
        }
    }
    let weak = ui.visuals().weak_text_color();
    painter.rect_stroke(plot, 0.0, Stroke::new(1.0, weak.gamma_multiply(0.5)), StrokeKind::Outside);
    let font = FontId::proportional(11.0);
    painter.text(
        pos2(plot.center().x, plot.max.y + 3.0),
        Align2::CENTER_TOP,
        "candidate of q",
        font.clone(),
        weak,
    );
    let galley = painter.layout_no_wrap("candidate of p".to_owned(), font, weak);
    let at = pos2(area.min.x, plot.center().y + galley.size().x / 2.0);
    painter.add(egui::epaint::TextShape::new(at, galley, weak).with_angle(-std::f32::consts::FRAC_PI_2));
    if let Some(ranks) = crossed {
        let own = place(ranks);
        painter.hline(plot.x_range(), own.center().y, Stroke::new(1.5, theme::pair_color(0)));
        painter.vline(own.center().x, plot.y_range(), Stroke::new(1.5, theme::pair_color(1)));
        painter.rect(
            own.expand(2.0),
            1.0,
            theme::UNCHECKED,
            Stroke::new(1.5, Color32::WHITE),
            StrokeKind::Outside,
        );
    }
    let ranks = |k: usize| record.hypotheses.get(k).and_then(ranks_of);
    if let Some(ranks) = lit.and_then(ranks) {
        painter.rect_filled(place(ranks).expand(1.0), 0.0, theme::HOVER);
    }
    let (hovered, clicked) = (response.hover_pos()?, response.clicked());
    response.on_hover_text(
        "Each cell is one crossing. Bright cells gave hypotheses that were kept, the best brightest.",
    );
    let k = (0..count).find(|k| ranks(*k).is_some_and(|ranks| place(ranks).contains(hovered)))?;
    Some((k, clicked))
}

/// Lists the best hypotheses with their origins and epipoles. Returns the hypothesis under the cursor, and whether it was
/// clicked.
fn best(ui: &mut Ui, record: &Record, lit: Option<usize>) -> Option<(usize, bool)> {
    let mut hovered = None;
    let head = |text: &str| RichText::new(text).size(theme::CAPTION).weak();
    Grid::new("best hypotheses").num_columns(3).spacing(vec2(18.0, 4.0)).show(ui, |ui| {
        for text in ["Best, from", "Left epipole", "Right epipole"] {
            ui.label(head(text));
        }
        ui.end_row();
        for (k, own) in record.hypotheses.iter().take(LISTED).enumerate() {
            let mut show = |text: String| {
                let text = RichText::new(text);
                let text = if lit == Some(k) { text.strong() } else { text };
                ui.add(Label::new(text).selectable(false).sense(Sense::click()))
            };
            let mut row = show(proposer_in_words(own.origin.source));
            for side in Side::BOTH {
                let epipole = short_epipole_text(&side.epipole(&own.fundamental));
                row |= show(epipole);
            }
            if row.hovered() {
                hovered = Some((k, row.clicked()));
            }
            ui.end_row();
        }
    });
    hovered
}
