//! The tab of the point pairs with their residuals.

use egui::containers::menu::MenuButton;
use egui::{
    Button, DragValue, Frame, Grid, Label, Response, RichText, ScrollArea, Sense, Stroke, TextEdit, Ui,
    WidgetInfo,
};

use super::super::dialog::named;
use super::super::gauge;
use super::super::table::sort_mark;
use super::super::{command_button, finish_button, pair_menu};
use super::{Tab, empty};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::document::{PointRef, Role, Side, pair_name};
use crate::app::model::focus::{LineSource, Target};
use crate::app::model::ids::TabId;
use crate::app::model::point_table::{Choosing, ChosenEdit, PointColumn, PointOrder, PointsCommand};
use crate::app::model::residuals::summary;
use crate::app::model::suggesting::Repair;
use crate::app::model::verdict::capitalised;
use crate::app::view::theme;
use crate::geometry::Point;

/// Registered in [`super::TABS`].
pub const TAB: Tab = Tab { id: TabId::Points, tools, show };

/// Room below which the less common actions of a row are in a menu, screen points.
const ROW_WIDTH: f32 = 940.0;
/// Width of a row with a menu, without its name, screen points.
const NARROW_ROW: f32 = 580.0;
const OUTVOTED_WIDTH: f32 = 70.0;
const COORDINATE_WIDTH: f32 = 60.0;
const NARROW_COORDINATE_WIDTH: f32 = 46.0;
/// Least and largest width of a name, screen points.
const NAME_WIDTHS: [f32; 2] = [60.0, 180.0];
/// Half of the last displayed decimal of a coordinate, px.
const HALF_A_DIGIT: f64 = 0.005;

fn tools(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let any = !model.document.pairs.is_empty() || model.document.half.is_some();
    command_button(ui, Command::ClearPairs, any, commands);
}

/// Makes a button low enough for a row.
fn low(button: Button<'_>) -> Button<'_> {
    button.small().min_size(egui::vec2(0.0, 20.0))
}

/// Shows the buttons for copying and pasting, and for the chosen rows.
fn editing(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let (open, any) = (model.document.pictures.is_some(), !model.document.pairs.is_empty());
    let mut offer = |ui: &mut Ui, command: PointsCommand, enabled: bool| {
        let command = Command::from(command);
        let button = ui.add_enabled(enabled, low(Button::new(command.name())));
        finish_button(ui, button, command, commands);
    };
    if any {
        offer(ui, PointsCommand::Copy, true);
    }
    offer(ui, PointsCommand::RequestPaste, open);
    let count = model.document.chosen.len();
    if count > 0 {
        ui.separator();
        ui.label(format!("{count} chosen"));
        for edit in [ChosenEdit::Use, ChosenEdit::CheckOnly, ChosenEdit::Exclude, ChosenEdit::Delete] {
            offer(ui, PointsCommand::Edit(edit), true);
        }
    }
}

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let document = &model.document;
    if document.pairs.is_empty() && document.half.is_none() {
        empty(
            ui,
            "The pairs you click appear here with their distances from the epipolar lines. Click a point in \
             the left image, then the same scene point in the right one.",
        );
        ui.horizontal(|ui| editing(ui, model, commands));
        return;
    }
    ui.horizontal_wrapped(|ui| {
        editing(ui, model, commands);
        for (place, line) in summary(model).into_iter().enumerate() {
            if place == 0 {
                ui.separator();
            }
            ui.weak(line.name).on_hover_text(line.tooltip);
            ui.label(line.value).on_hover_text(line.tooltip);
            ui.add_space(theme::GAP);
        }
    });
    let listed = model.listed_pairs();
    let outvoted = (0..document.pairs.len()).any(|pair| model.outvoted(pair).is_some());
    let room = ui.available_width() - if outvoted { OUTVOTED_WIDTH } else { 0.0 };
    let wide = room >= ROW_WIDTH;
    let [least, most] = NAME_WIDTHS;
    let name = if wide { least + room - ROW_WIDTH } else { room - NARROW_ROW }.clamp(least, most);
    let widths = RowWidths { wide, name };
    ScrollArea::both().id_salt("points").auto_shrink([false, false]).show(ui, |ui| {
        Grid::new("points")
            .num_columns(7)
            .striped(true)
            .min_row_height(ROW_HEIGHT)
            .spacing([if wide { 7.0 } else { 4.0 }, 3.0])
            .show(ui, |ui| {
                for column in PointColumn::ALL {
                    heading(ui, model, column, commands);
                }
                ui.label("");
                ui.end_row();
                let half = document.half.map(|_| document.pairs.len());
                let seen = seen_rows(ui);
                for pair in listed.into_iter().chain(half) {
                    if seen.contains(ui.cursor().min.y) {
                        row(ui, model, pair, widths, commands);
                    } else {
                        ui.label("");
                        ui.end_row();
                    }
                }
            });
    });
}

/// Height of a row, screen points.
const ROW_HEIGHT: f32 = 22.0;

/// Returns the range of the tops of rows to draw: the visible rows and their neighbours. While a
/// field is edited or dragged, all rows are drawn, so that the field is kept out of view.
fn seen_rows(ui: &Ui) -> egui::Rangef {
    let seen = ui.clip_rect();
    let is_held = ui.memory(|memory| memory.focused().is_some())
        || ui.ctx().dragged_id().is_some() && ui.rect_contains_pointer(seen);
    if is_held { egui::Rangef::EVERYTHING } else { seen.y_range().expand(2.0 * ROW_HEIGHT) }
}

/// Shows the heading of a column, which sorts by it.
fn heading(ui: &mut Ui, model: &Model, column: PointColumn, commands: &mut Vec<Command>) {
    let PointOrder { column: by, descending, .. } = model.open.points;
    let color = ui.visuals().weak_text_color();
    let title = Button::new(RichText::new(format!("{}   ", column.title())).color(color)).frame(false);
    let title = named(ui.add(title), &format!("Sort points by {}", column.title()));
    if by == column {
        sort_mark(ui, title.rect.right_center() - egui::vec2(6.0, 0.0), descending, color);
    }
    if title.on_hover_text(format!("{} Click to sort.", column.tooltip())).clicked() {
        commands.push(PointsCommand::SortBy(column).into());
    }
}

/// Returns how a click chooses rows, by the modifier keys.
fn choosing(ui: &Ui) -> Choosing {
    let held = ui.input(|input| input.modifiers);
    if held.shift {
        Choosing::Through
    } else if held.command {
        Choosing::Toggle
    } else {
        Choosing::Only
    }
}

/// Distribution of the width of a row.
#[derive(Debug, Clone, Copy)]
struct RowWidths {
    /// Whether all actions have room.
    wide: bool,
    /// Width of the name, screen points.
    name: f32,
}

fn row(ui: &mut Ui, model: &Model, pair: usize, widths: RowWidths, commands: &mut Vec<Command>) {
    let wide = widths.wide;
    let document = &model.document;
    let name = pair_name(pair);
    let lit = model.open.focus.hovered() == Some(Target::Pair(pair));
    let top_left = ui.cursor().min;
    let finished = document.pairs.get(pair);
    let chosen = document.chosen.contains(&pair);
    // The background comes first, so that the contents of the row take their own clicks.
    let area = egui::Rect::from_min_max(top_left, egui::pos2(ui.clip_rect().max.x, top_left.y + 24.0));
    let background = ui.interact(area, ui.scope_id().with(("row", pair)), Sense::click());
    background
        .widget_info(|| WidgetInfo::selected(egui::Role::Row, true, chosen, format!("Row of pair {name}")));
    if finished.is_some() && background.clicked() {
        commands.push(PointsCommand::Choose(pair, choosing(ui)).into());
    }
    if chosen {
        ui.painter().rect_filled(area, 2.0, ui.visuals().selection.bg_fill.gamma_multiply(0.5));
    }
    ui.horizontal(|ui| {
        let (swatch, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), Sense::hover());
        ui.painter().circle_filled(swatch.center(), 5.0, theme::pair_color(pair));
        ui.painter().circle_stroke(swatch.center(), 5.5, egui::Stroke::new(1.0, theme::HALO));
        let text = RichText::new(&name).strong();
        let text = ui.label(if lit { text.underline() } else { text });
        if finished.is_some() {
            text.on_hover_text(format!("Origin: {}.", document.origin(pair).name()));
        }
    });
    if finished.is_some() {
        name_field(ui, model, pair, widths.name, commands);
    } else {
        ui.label("");
    }
    for side in Side::BOTH {
        let at = PointRef { pair, side };
        if document.point(at).is_some() {
            position(ui, model, at, wide, commands);
        } else {
            ui.weak("click in image");
        }
    }
    role(ui, model, pair, commands);
    match model.pair_distance(pair) {
        Some(distance) => {
            let text = ui.label(RichText::new(format!("{distance:6.2} px")).monospace());
            if let Some(scale) = model.pair_gauge(pair) {
                gauge::under(ui, &text, &format!("Distance of pair {name}"), &scale);
            }
        }
        None => drop(ui.add(Label::new(""))),
    }
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let mut offer = |ui: &mut Ui, command: Command, enabled: bool| {
            let label = format!("{}: pair {name}", command.name());
            let button = named(ui.add_enabled(enabled, low(Button::new(command.name()))), &label);
            finish_button(ui, button, command, commands);
        };
        if finished.is_some() && wide {
            for how in [Repair::Refine, Repair::Rematch] {
                offer(ui, Command::Repair(pair, how), model.repair_question(pair, how).is_some());
            }
            offer(ui, Command::Pin(LineSource::Pair(pair)), model.shown().is_some());
        }
        if finished.is_none() || wide {
            offer(ui, Command::DeletePair(pair), true);
        } else {
            let more = MenuButton::from_button(low(Button::new("More")));
            let (more, _) = more.ui(ui, |ui| pair_menu(ui, model, pair, commands));
            named(more, &format!("More: pair {name}")).on_hover_text("More actions for this pair.");
        }
    });
    ui.end_row();
    background.container_context_menu(|ui| pair_menu(ui, model, pair, commands));
    if finished.is_some() && ui.rect_contains_pointer(area) {
        commands.push(Command::PointAt(Target::Pair(pair)));
    }
}

/// Shows the field with the user's name for the pair.
fn name_field(ui: &mut Ui, model: &Model, pair: usize, width: f32, commands: &mut Vec<Command>) {
    let mut name = model.document.given_name(pair).unwrap_or_default().to_owned();
    let field = TextEdit::singleline(&mut name).desired_width(width).hint_text("name").frame(Frame::NONE);
    let field = field.align(egui::Align2::LEFT_CENTER).min_size(egui::vec2(width, 22.0));
    let field = ui.add(field.id_salt(("name of pair", pair)));
    let field = named(field, &format!("Name of pair {}", pair_name(pair)));
    if field.changed() {
        commands.push(PointsCommand::Rename(pair, name).into());
    }
    if field.lost_focus() {
        commands.push(Command::EndDrag);
    }
}

/// Shows the role of the pair, the switches that change it, and whether the result contradicts the
/// pair.
fn role(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let document = &model.document;
    if pair >= document.pairs.len() {
        ui.weak("incomplete");
        return;
    }
    let name = pair_name(pair);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let role = document.role(pair);
        let mut included = role != Role::Excluded;
        let response = ui.checkbox(&mut included, "");
        response.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::CheckBox, true, included, format!("Include pair {name}"))
        });
        let response = response.on_hover_text(Command::IncludePair(pair, included).tooltip());
        if response.changed() {
            commands.push(Command::IncludePair(pair, included));
        }
        for (only, is_chosen) in [(false, role == Role::Used), (true, role == Role::Check)] {
            let command = Command::CheckOnly(pair, only);
            let button = low(Button::selectable(is_chosen, command.name()));
            let response =
                ui.add_enabled(role != Role::Excluded && (only || document.can_be_used(pair)), button);
            let label = format!("{} pair {name}", command.name());
            response.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::Button, response.enabled(), is_chosen, &label)
            });
            let response = response.on_disabled_hover_text(if role == Role::Excluded {
                "The pair is left out. Include it first."
            } else {
                "The published method takes no more pairs. Set another pair to check only, or choose the \
                 preset Robust."
            });
            finish_button(ui, response, command, commands);
        }
        if let Some(distance) = model.outvoted(pair) {
            let text = RichText::new("outvoted").color(theme::palette(ui.visuals()).caution);
            ui.label(text).on_hover_text(format!(
                "The pair misses its epipolar line by {distance:.1} px (symmetric distance), although the \
                 images support the geometry. Check that both points are the same scene point.",
            ));
        }
    });
}

/// Shows the fields for the coordinates of a point. The selected point is underlined.
fn position(ui: &mut Ui, model: &Model, at: PointRef, wide: bool, commands: &mut Vec<Command>) {
    let document = &model.document;
    let Some((point, frame)) = document.point(at).zip(document.frame(at.side)) else { return };
    let row = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().button_padding.x = 4.0;
        ui.spacing_mut().interact_size.x = if wide { COORDINATE_WIDTH } else { NARROW_COORDINATE_WIDTH };
        for (axis, size) in [("x", frame.width), ("y", frame.height)] {
            let before = if axis == "x" { point.x } else { point.y };
            let mut typed = before;
            let field = DragValue::new(&mut typed)
                .speed(0.1)
                .range(-0.5..=size as f64 - 0.5)
                .fixed_decimals(2)
                .update_while_editing(false);
            let field = ui.add(field);
            let name = format!("{} {axis} of pair {}", capitalised(at.side.name()), pair_name(at.pair));
            field.widget_info(|| WidgetInfo {
                label: Some(name.clone()),
                ..WidgetInfo::drag_value(true, before)
            });
            if field.gained_focus() || field.drag_started() {
                commands.push(Command::Select(Some(at)));
            }
            // The displayed figure is rounded; a value that was not edited must not change.
            if (typed - before).abs() >= HALF_A_DIGIT {
                let to = if axis == "x" { Point::new(typed, point.y) } else { Point::new(point.x, typed) };
                commands.push(Command::Drag(at, to));
                if !field.dragged() {
                    commands.push(Command::EndDrag);
                }
            }
            if field.drag_stopped() {
                commands.push(Command::EndDrag);
            }
            field.on_hover_text(format!(
                "Click to type, or drag to change, in px from -0.5 to {:.1}. The arrow keys move the point \
                 by 0.1 px.",
                size as f64 - 0.5
            ));
        }
    });
    if document.selection == Some(at) {
        let Response { rect, .. } = row.response;
        ui.painter().hline(rect.x_range(), rect.max.y, Stroke::new(2.0, theme::palette(ui.visuals()).accent));
    }
}
