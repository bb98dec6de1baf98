//! The similarity matrices of the pencils through `p` and `q`.

use egui::{FontSelection, Label, Rect, RichText, TextWrapMode, Ui, UiBuilder, Vec2, WidgetText, pos2, vec2};

use super::super::empty;
use super::super::profiles::sliding;
use super::matrix::PencilMatrix;
use super::{NO_PENCILS, NO_ROOM, has_no_pencils, touch};
use crate::app::model::{Command, LineSource, Model, Target, pair_name};
use crate::app::view::{heat, theme};
use crate::estimate::ComparedPencils;

/// Height of the legend, screen points.
const LEGEND: f32 = 18.0;

/// Shows the meaning of colours and marks.
fn legend(ui: &mut Ui) {
    ui.spacing_mut().item_spacing.x = 5.0;
    let caption = |text: &str| RichText::new(text).size(theme::CAPTION).weak();
    let mark = |ui: &mut Ui, color| {
        let (area, _) = ui.allocate_exact_size(vec2(10.0, 10.0), egui::Sense::hover());
        ui.painter().circle_filled(area.center(), 5.0, egui::Color32::from_gray(60));
        ui.painter().circle_stroke(area.center(), 3.5, egui::Stroke::new(1.5, color));
    };
    ui.label(caption("unlike"));
    let (bar, _) = ui.allocate_exact_size(vec2(56.0, 9.0), egui::Sense::hover());
    heat::bar(ui.painter(), bar, heat::grey);
    ui.label(caption("alike")).on_hover_text(
        "Matching cost of the two lines, from high to low. Empty cells are not compared: a line has little \
         texture, or the other is turned farther than the parameter Rotation.",
    );
    mark(ui, theme::UNCHECKED);
    ui.label(caption("mutual best"))
        .on_hover_text("Each of the two lines is among the best matches of the other.");
    mark(ui, theme::pair_color(0));
    ui.label(caption("shown"));
    let axes = WidgetText::from(caption("x: left angle · y: turn on the right"));
    let axes = axes.into_galley(ui, Some(TextWrapMode::Extend), f32::INFINITY, FontSelection::Default);
    if axes.size().x <= ui.available_width() {
        ui.label(axes);
    }
}

/// Room for the axes and the title around a plot, screen points. Rings at its edges stay clear of the title and of
/// the edge of the panel.
const LEFT_TOP: Vec2 = vec2(44.0, 26.0);
const RIGHT_BOTTOM: Vec2 = vec2(10.0, 18.0);
/// Least size of a plot, screen points.
const LEAST: Vec2 = vec2(40.0, 24.0);

/// Height of a title, screen points.
const TITLE: f32 = 16.0;

/// Width of a matrix below which its title is only the name of the point, screen points.
const ROOM_FOR_WORDS: f32 = 130.0;

pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let Some(pencils) = model.open.computation.pencils() else {
        let text = "The costs of matching all lines through p and q appear here once there are enough point \
                    pairs. Point at a cell to see its two lines, and click it to inspect them.";
        empty(ui, if has_no_pencils(model) { NO_PENCILS } else { text });
        return;
    };
    if playing(ui, model, commands) {
        return;
    }
    let area = ui.available_rect_before_wrap();
    let (area, below) = area.split_top_bottom_at_y(area.max.y - LEGEND);
    let (left, right) = area.split_left_right_at_fraction(0.5);
    let halves = [left.with_max_x(left.max.x - theme::GAP), right.with_min_x(right.min.x + theme::GAP)];
    if halves.iter().any(|half| (half.size() - LEFT_TOP - RIGHT_BOTTOM - LEAST).min_elem() < 0.0) {
        empty(ui, NO_ROOM);
        return;
    }
    for (number, rect) in halves.into_iter().enumerate() {
        let mut child = ui.new_child(UiBuilder::new().max_rect(rect).id_salt(number));
        one(&mut child, model, number, &pencils[number], commands);
    }
    ui.scope_builder(UiBuilder::new().max_rect(below), |ui| ui.horizontal_centered(legend));
    ui.advance_cursor_after_rect(area);
}

/// Shows the matrix as it fills, beside the profiles of the lines that are compared. Returns whether the replay is
/// under way.
fn playing(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> bool {
    let replay = &model.open.replay;
    let Some((moment, filled)) = replay.moment().and_then(|moment| Some((moment, moment.filled?))) else {
        return false;
    };
    let pencils = model.record().and_then(|record| record.pencils.get(filled.pencil));
    let is_last = model.record().is_some_and(|record| filled.pencil + 1 == record.pencils.len());
    let is_over = is_last && moment.slide >= 1.0 && !replay.is_playing();
    let Some(own) = pencils.filter(|_| !is_over) else { return false };
    let area = ui.available_rect_before_wrap();
    let (area, below) = area.split_top_bottom_at_y(area.max.y - LEGEND);
    ui.scope_builder(UiBuilder::new().max_rect(below), |ui| ui.horizontal_centered(legend));
    let (matrix, profiles) = area.split_left_right_at_fraction(0.42);
    let mut child = ui.new_child(UiBuilder::new().max_rect(matrix).id_salt("filling"));
    one(&mut child, model, filled.pencil, &own.compared, commands);
    let right = profiles.with_min_x(profiles.min.x + theme::GAP);
    // Lines through a match in the place of a click have no profiles.
    if moment.lines.is_some() {
        ui.scope_builder(UiBuilder::new().max_rect(right).id_salt("profiles"), |ui| {
            sliding(ui, model, moment.slide);
        });
    }
    true
}

fn one(ui: &mut Ui, model: &Model, number: usize, pencils: &ComparedPencils, commands: &mut Vec<Command>) {
    let matrix = PencilMatrix::new(ui, number, pencils, model.open.computation.pencils_revision());
    let area = ui.available_rect_before_wrap();
    let plot = Rect::from_min_max(area.min + LEFT_TOP, area.max - RIGHT_BOTTOM);
    // Pencils may pass through matches that replace clicks; lines through those cannot be pinned.
    let pair = model.document.pair_of_pencils(number, &pencils.click);
    let name = pair.map_or_else(|| format!("match {}", number + 1), pair_name);
    let response = ui.interact(plot, ui.scope_id().with("matrix"), egui::Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Image, true, format!("pencil matrix of {name}"))
    });
    let hovered = response.hover_pos().and_then(|position| matrix.cell_at(plot, position));
    // The cell under the cursor here, or pointed at elsewhere.
    let lit = match (hovered, model.open.focus.hovered()) {
        (Some(cell), _) => Some(cell),
        (None, Some(Target::Cell { pair: other, row, column })) if other == number => Some([row, column]),
        _ => None,
    };
    let moment = model.open.replay.moment();
    let filled = moment.and_then(|moment| moment.filled).filter(|filled| filled.pencil == number);
    let shown = model.construction().filter(|_| filled.is_none()).map(|construction| {
        let lines = if number == 0 { construction.p() } else { construction.q() };
        (lines.line1, lines.line2)
    });
    // The lines that are being compared.
    let compared =
        filled.and_then(|_| model.lines(moment?.lines?)).map(|lines| lines.map(|line| line.line()).into());
    let title = if plot.width() < ROOM_FOR_WORDS { name } else { format!("Lines through {name}") };
    let heading = RichText::new(title).size(theme::CAPTION);
    let top = Rect::from_min_max(pos2(plot.min.x, area.min.y), pos2(area.max.x, area.min.y + TITLE));
    ui.put(top, Label::new(heading.weak()).truncate().halign(egui::Align::Min));
    matrix.draw(ui, plot, lit, shown.or(compared), theme::pair_color(number));
    if let Some(filled) = filled {
        matrix.cover(ui, plot, filled.rows);
    }
    let Some([row, column]) = hovered else { return };
    touch(Target::Cell { pair: number, row, column }, response.clicked(), model, commands);
    if response.clicked()
        && let (Some(angles), Some(pair)) = (pencils.angles(row, column), pair)
    {
        commands.push(Command::Pin(LineSource::Pencil { pair, angles }));
    }
    response.on_hover_text_at_pointer(matrix.describe([row, column]));
}
