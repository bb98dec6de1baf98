//! The motion barcodes of lines that sweep across the left picture, beside those of their best partners.

use egui::{Align2, Color32, FontId, Mesh, Painter, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, pos2};

use super::super::barcodes::runs;
use super::super::empty;
use super::touch;
use crate::app::model::focus::Replayed;
use crate::app::model::replay::moment::Grown;
use crate::app::model::replay::sweep::{Sweep, SweptLine};
use crate::app::model::{Command, Model, Target};
use crate::app::view::theme;
use crate::motion::Barcode;

/// Names of both barcodes, and width kept free for them, screen points.
const NAMES: [&str; 2] = ["Left line", "Its partner"];
const NAME: f32 = 78.0;
/// Share of the height that the barcodes of one line pair take.
const SHOWN: f32 = 0.36;
/// Height of a caption, screen points.
const CAPTION: f32 = 16.0;

/// Shows the barcodes. A row under the cursor shows its lines in the images.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let sweep = model.record().and_then(|record| record.sweep.as_ref());
    let grown = model.open.replay.moment().and_then(|moment| moment.grown);
    let (Some(sweep), Some(grown)) = (sweep, grown) else {
        let runs_frames = model.open.replay.moment().is_some_and(|moment| moment.piled.is_some());
        empty(
            ui,
            if runs_frames {
                "The barcodes of lines follow in the next step."
            } else {
                "The barcodes of lines appear here during a search of two sequences."
            },
        );
        return;
    };
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "barcodes of the swept lines"));
    let painter = ui.painter_at(area);
    let paper = theme::palette(ui.visuals()).canvas;
    let (top, below) = area.split_top_bottom_at_fraction(SHOWN);
    let lit = match model.open.focus.hovered() {
        Some(Target::Replayed(Replayed::Swept(k))) if k < sweep.swept.len() => Some(k),
        _ => None,
    };
    let shown = lit.or(grown.line).map_or(&sweep.held, |line| &sweep.swept[line]);
    let frames = if lit.is_some() { shown.compared.barcodes[0].len() } else { grown.frames };
    line_pair(&painter, top.with_max_y(top.max.y - theme::GAP), ui, shown, frames);
    let (left, right) = below.split_left_right_at_fraction(0.5);
    let mut hovered = None;
    for (k, half) in [left.with_max_x(left.max.x - theme::GAP), right].into_iter().enumerate() {
        let caption = ["Lines on the left, one a row", "Their best partners on the right"][k];
        let weak = ui.visuals().weak_text_color();
        painter.text(half.min, Align2::LEFT_TOP, caption, FontId::proportional(theme::CAPTION), weak);
        let plot = half.with_min_y(half.min.y + CAPTION);
        painter.rect_filled(plot, 0.0, paper);
        rows(&painter, plot, sweep, k, grown, lit);
        let row = response
            .hover_pos()
            .filter(|at| plot.contains(*at))
            .map(|at| ((at.y - plot.min.y) / plot.height() * sweep.swept.len() as f32) as usize);
        hovered = hovered.or(row.filter(|row| *row < grown.swept));
    }
    if let Some(row) = hovered {
        touch(Target::Replayed(Replayed::Swept(row)), response.clicked(), model, commands);
    }
}

/// Shows the barcodes of one line pair, one above the other, up to a frame.
fn line_pair(painter: &Painter, area: Rect, ui: &Ui, shown: &SweptLine, frames: usize) {
    let (upper, lower) = area.split_top_bottom_at_fraction(0.5);
    for ((stripe, barcode), name) in [upper, lower].into_iter().zip(&shown.compared.barcodes).zip(NAMES) {
        let stripe = stripe.with_max_y(stripe.max.y - 2.0);
        let at = pos2(stripe.min.x, stripe.center().y);
        let weak = ui.visuals().weak_text_color();
        painter.text(at, Align2::LEFT_CENTER, name, FontId::proportional(theme::CAPTION), weak);
        let stripe = stripe.with_min_x((stripe.min.x + NAME).min(stripe.max.x));
        painter.rect_filled(stripe, 0.0, theme::palette(ui.visuals()).canvas);
        let mut mesh = Mesh::default();
        bits(&mut mesh, stripe, barcode, frames, theme::MOVING);
        painter.add(Shape::mesh(mesh));
        if frames < barcode.len() {
            let x = stripe.min.x + stripe.width() * frames as f32 / barcode.len().max(1) as f32;
            painter.vline(x, stripe.y_range(), Stroke::new(1.5, theme::HOVER));
        }
    }
}

/// Shows the barcodes of the lines swept so far, one a row.
fn rows(painter: &Painter, plot: Rect, sweep: &Sweep, side: usize, grown: Grown, lit: Option<usize>) {
    let height = plot.height() / sweep.swept.len().max(1) as f32;
    let mut mesh = Mesh::default();
    for (k, own) in sweep.swept.iter().take(grown.swept).enumerate() {
        let top = plot.min.y + k as f32 * height;
        let row = Rect::from_x_y_ranges(plot.x_range(), top..=top + height);
        let barcode = &own.compared.barcodes[side];
        let color = if lit == Some(k) { theme::HOVER } else { theme::MOVING };
        bits(&mut mesh, row, barcode, barcode.len(), color);
    }
    painter.add(Shape::mesh(mesh));
}

/// Draws the first bits of a barcode along an area.
fn bits(mesh: &mut Mesh, area: Rect, barcode: &Barcode, frames: usize, color: Color32) {
    let x = |frame: usize| area.min.x + area.width() * frame as f32 / barcode.len().max(1) as f32;
    for run in runs(frames.min(barcode.len()), &|frame| barcode.is_set(frame)) {
        mesh.add_colored_rect(Rect::from_x_y_ranges(x(run.start)..=x(run.end), area.y_range()), color);
    }
}
