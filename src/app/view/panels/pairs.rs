//! The list of point pairs: one line a pair. The selected pair unfolds to its coordinates, role and
//! actions.

use egui::containers::menu::MenuButton;
use egui::{
    Align, Button, DragValue, Frame, Label, Layout, Margin, Rect, RichText, ScrollArea, Sense, Stroke,
    TextEdit, Ui, WidgetInfo, style::ScrollAnimation, vec2,
};

use super::dialog::named;
use super::{command_button, finish_button, pair_menu};
use crate::app::model::point_table::PointsCommand;
use crate::app::model::residuals::check_summary;
use crate::app::model::{Command, ExchangeCommand, Model, PointRef, Role, Side, Target, pair_name};
use crate::app::view::theme;
use crate::geometry::Point;

/// Half of the last displayed decimal of a coordinate, px.
const HALF_A_DIGIT: f64 = 0.005;
/// Width of a coordinate, screen points.
const COORDINATE: f32 = 52.0;
/// Space between two rows. All rows are equally high, so that a list of whole rows can end at a row.
const BETWEEN_ROWS: f32 = 2.0;
/// Indent of an unfolded pair, screen points.
const INDENT: f32 = 6.0;

/// Shows the list in all available space.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = BETWEEN_ROWS;
    ui.horizontal(|ui| {
        let count = model.document.pairs.len();
        let title = if count > 3 { format!("Point pairs ({count})") } else { "Point pairs".to_owned() };
        ui.label(RichText::new(title).size(theme::CAPTION).weak());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let menu = MenuButton::from_button(Button::new("⋯").small());
            let (menu, _) = menu.ui(ui, |ui| list_menu(ui, model, commands));
            named(menu, "More for the list of pairs").on_hover_text("Copy, paste or clear the pairs.");
            if model.shown().is_some() && count > 0 {
                ui.label(RichText::new("distance").size(theme::CAPTION).weak()).on_hover_text(
                    "Symmetric distance: mean distance of the two points from each other's epipolar lines. \
                         Careful clicks stay below about 2 px.",
                );
            }
        });
    });
    let document = &model.document;
    let open = document.selected_pair();
    // Scrolls to a pair when it unfolds, and lets a person scroll away again.
    let id = ui.scope_id().with("selected before");
    let now = (open, document.half.is_some());
    let scrolls = ui.data_mut(|data| std::mem::replace(data.get_temp_mut_or_default(id), now)) != now;
    let pitch = theme::ROW + BETWEEN_ROWS;
    let whole_rows = ((ui.available_height() + BETWEEN_ROWS) / pitch).floor() * pitch - BETWEEN_ROWS;
    let list = ScrollArea::vertical().id_salt("pairs").auto_shrink([false, false]);
    list.max_height(whole_rows.max(theme::ROW)).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - theme::SCROLL_BAR);
        ui.spacing_mut().interact_size.y = theme::ROW;
        ui.spacing_mut().button_padding.y = 1.0;
        let half = document.half.map(|_| document.pairs.len());
        let seen = ui.clip_rect().y_range().expand(2.0 * theme::ROW);
        // A field that is edited or dragged stays alive outside the visible part.
        let is_held = ui.memory(|memory| memory.focused().is_some()) || ui.ctx().dragged_id().is_some();
        for pair in (0..document.pairs.len()).chain(half) {
            let top = ui.cursor().min.y;
            if is_held || open == Some(pair) || seen.contains(top) {
                row(ui, model, pair, commands);
                if scrolls && open == Some(pair) {
                    let block = Rect::from_x_y_ranges(ui.max_rect().x_range(), top..=ui.min_rect().max.y);
                    ui.scroll_to_rect_animation(block, None, ScrollAnimation::none());
                }
            } else {
                ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW), Sense::hover());
            }
        }
        let hint = match (document.pictures.is_some(), document.pairs.len(), document.half) {
            (false, ..) => return,
            (_, _, Some(_)) => "Click the same scene point in the other image",
            (_, 0, _) => "Click a point in one image, then the same scene point in the other",
            _ => "Click a point in either image to add a pair",
        };
        ui.add_space(2.0);
        ui.add(Label::new(RichText::new(hint).size(theme::CAPTION).weak()).wrap());
        if model.can_keep_matches() {
            command_button(ui, Command::KeepMatches, true, commands);
        }
        if let Some(checks) = check_summary(model) {
            ui.add(Label::new(RichText::new(checks).size(theme::CAPTION).weak()).wrap())
                .on_hover_text("Pairs not used in the estimate: an independent test.");
        }
    });
}

fn list_menu(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let (open, any) = (model.document.pictures.is_some(), !model.document.pairs.is_empty());
    for (command, enabled) in [(PointsCommand::Copy, any), (PointsCommand::RequestPaste, open)] {
        command_button(ui, command.into(), enabled, commands);
    }
    ui.separator();
    command_button(ui, Command::ClearPairs, any || model.document.half.is_some(), commands);
    if model.document.given.is_some() {
        command_button(ui, ExchangeCommand::EditGiven.into(), model.can_edit_given(), commands);
        command_button(ui, ExchangeCommand::RemoveGiven.into(), true, commands);
    }
}

fn row(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let document = &model.document;
    let name = pair_name(pair);
    let lit = model.open.focus.hovered() == Some(Target::Pair(pair));
    let is_whole = pair < document.pairs.len();
    let selected = document.selection.is_some_and(|at| at.pair == pair);
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW), Sense::hover());
    // The background comes first, so that the contents of the row take their own clicks.
    let background = ui.interact(area, ui.scope_id().with(("row", pair)), Sense::click());
    background
        .widget_info(|| WidgetInfo::selected(egui::Role::Row, true, selected, format!("Row of pair {name}")));
    if is_whole && background.clicked() {
        // The keys act on the left point, until a field or a point is clicked.
        commands.push(Command::Select((!selected).then_some(PointRef { pair, side: Side::Left })));
    }
    let fill = if selected {
        Some(ui.visuals().selection.bg_fill.gamma_multiply(0.45))
    } else {
        (lit || background.hovered()).then(|| ui.visuals().widgets.hovered.bg_fill)
    };
    if let Some(fill) = fill {
        ui.painter().rect_filled(area, 3.0, fill);
    }
    let mut inside =
        ui.new_child(egui::UiBuilder::new().max_rect(area).layout(Layout::left_to_right(Align::Center)));
    line(&mut inside, model, pair, commands);
    background.container_context_menu(|ui| pair_menu(ui, model, pair, commands));
    if is_whole && ui.rect_contains_pointer(area) {
        commands.push(Command::PointAt(Target::Pair(pair)));
    }
    if selected && is_whole {
        unfolded(ui, model, pair, commands);
    }
}

/// Shows the line of a pair: colour, names, role and distance.
fn line(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let document = &model.document;
    let name = pair_name(pair);
    ui.spacing_mut().item_spacing.x = 6.0;
    ui.add_space(4.0);
    let (swatch, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    // The outline shows pale colours on a light background.
    let outline = Stroke::new(1.0, ui.visuals().weak_text_color());
    ui.painter().circle(swatch.center(), 4.5, theme::pair_color(pair), outline);
    let text = ui.add(Label::new(RichText::new(&name).strong()).selectable(false));
    if pair >= document.pairs.len() {
        ui.weak("incomplete");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let delete = ui.add(Button::new("Delete").small());
            finish_button(
                ui,
                named(delete, &format!("Delete: pair {name}")),
                Command::DeletePair(pair),
                commands,
            );
        });
        return;
    }
    text.on_hover_text(format!("Origin: {}.", document.origin(pair).name()));
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.add_space(4.0);
        if let Some(distance) = model.pair_distance(pair) {
            ui.add(Label::new(format!("{distance:.2} px")).selectable(false));
        }
        let note = |ui: &mut Ui, text: RichText, tooltip: String| {
            ui.add(Label::new(text).selectable(false)).on_hover_text(tooltip);
        };
        let caution = theme::palette(ui.visuals()).caution;
        if let Some(distance) = model.outvoted(pair) {
            let tooltip = format!(
                "The pair misses its epipolar line by {distance:.1} px (symmetric distance), although the \
                 images support the geometry. Check that both points are the same scene point."
            );
            note(ui, RichText::new("off its line").color(caution), tooltip);
        } else if let Some(distance) = model.slid(pair) {
            let tooltip = format!(
                "The images look alike {distance:.0} px from the right point, along the epipolar line. The \
                 geometry hardly depends on the place along the line. Move the point to its match if both \
                 points are not the same scene point."
            );
            note(ui, RichText::new("off its match").color(caution), tooltip);
        }
        if model.unconfirmed(pair).is_some_and(|found| found.place.is_none()) {
            let tooltip = "The images do not show the match of the left point clearly. The distance from the line \
                           says nothing about the place along it, so compare both points yourself.";
            note(ui, RichText::new("?").weak(), tooltip.to_owned());
        }
        let role = match document.role(pair) {
            Role::Used => "",
            Role::Check => "check",
            Role::Excluded => "left out",
        };
        ui.add(Label::new(RichText::new(role).weak()).selectable(false));
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let given = document.given_name(pair).unwrap_or_default();
            ui.add(Label::new(RichText::new(given).weak()).selectable(false).truncate());
        });
    });
}

/// Shows coordinates, name, role and actions of the selected pair.
fn unfolded(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let name = pair_name(pair);
    let row = |ui: &mut Ui, add: &mut dyn FnMut(&mut Ui)| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.spacing_mut().button_padding.x = 3.0;
            ui.add_space(INDENT);
            add(ui);
        });
    };
    for side in Side::BOTH {
        row(ui, &mut |ui| position(ui, model, PointRef { pair, side }, commands));
    }
    row(ui, &mut |ui| name_field(ui, model, pair, commands));
    row(ui, &mut |ui| role(ui, model, pair, commands));
    row(ui, &mut |ui| {
        let mut offer = |ui: &mut Ui, command: Command, enabled: bool| {
            let label = format!("{}: pair {name}", command.name());
            let button = named(ui.add_enabled(enabled, Button::new(command.name()).small()), &label);
            finish_button(ui, button, command, commands);
        };
        offer(ui, Command::Refine(pair), model.repair_question(pair).is_some());
        offer(ui, Command::MoveToMatch(pair), model.better_place(pair).is_some());
        offer(ui, Command::DeletePair(pair), true);
    });
}

fn name_field(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let mut name = model.document.given_name(pair).unwrap_or_default().to_owned();
    let width = (ui.available_width() - 12.0).max(40.0);
    let frame = Frame::new().fill(ui.visuals().extreme_bg_color).inner_margin(Margin::symmetric(4, 1));
    let field =
        TextEdit::singleline(&mut name).desired_width(width).hint_text("Name of the pair").frame(frame);
    let field = ui.add(field.id_salt(("name of pair", pair)));
    let field = named(field, &format!("Name of pair {}", pair_name(pair)));
    if field.changed() {
        commands.push(PointsCommand::Rename(pair, name).into());
    }
    if field.lost_focus() {
        commands.push(Command::EndDrag);
    }
}

fn role(ui: &mut Ui, model: &Model, pair: usize, commands: &mut Vec<Command>) {
    let document = &model.document;
    let now = document.role(pair);
    for role in Role::ALL {
        let (command, is_free) = (Command::SetRole(pair, role), document.can_have(pair, role));
        let response = ui.add_enabled(is_free, Button::selectable(now == role, command.name()).small());
        let label = format!("{} pair {}", command.name(), pair_name(pair));
        response.widget_info(|| WidgetInfo::selected(egui::Role::Button, is_free, now == role, &label));
        let response = response.on_disabled_hover_text(
            "The published method takes no more pairs. Set another pair to check only, or choose the preset \
             Robust.",
        );
        finish_button(ui, response, command, commands);
    }
}

/// Shows the fields for the coordinates of a point. The selected point is underlined.
fn position(ui: &mut Ui, model: &Model, at: PointRef, commands: &mut Vec<Command>) {
    let document = &model.document;
    let Some(point) = document.point(at) else { return };
    // Coordinates are those of the picture on the screen.
    let Some(frame) = model.open.shown_frame(at.side) else { return };
    let point = model.open.pixel(at.side, point);
    let label = ui.add_sized(vec2(34.0, theme::ROW), Label::new(RichText::new(at.side.title()).weak()));
    ui.spacing_mut().button_padding.x = 4.0;
    ui.spacing_mut().interact_size.x = COORDINATE;
    let mut last = label.rect;
    for (axis, size) in [("x", frame.width), ("y", frame.height)] {
        let before = if axis == "x" { point.x } else { point.y };
        let mut typed = before;
        let field = DragValue::new(&mut typed)
            .speed(0.1)
            .range(-0.5..=size as f64 - 0.5)
            .fixed_decimals(2)
            .update_while_editing(false);
        let field = ui.add(field);
        last = field.rect;
        let name = format!("{} {axis} of pair {}", at.side.title(), pair_name(at.pair));
        field
            .widget_info(|| WidgetInfo { label: Some(name.clone()), ..WidgetInfo::drag_value(true, before) });
        if field.gained_focus() || field.drag_started() {
            commands.push(Command::Select(Some(at)));
        }
        // The displayed figure is rounded; a value that was not edited must not change.
        if (typed - before).abs() >= HALF_A_DIGIT {
            let to = if axis == "x" { Point::new(typed, point.y) } else { Point::new(point.x, typed) };
            commands.extend(model.open.point(at.side, to).map(|to| Command::Drag(at, to)));
            if !field.dragged() {
                commands.push(Command::EndDrag);
            }
        }
        if field.drag_stopped() {
            commands.push(Command::EndDrag);
        }
        field.on_hover_text(format!(
            "Click to type, or drag to change, in px from -0.5 to {:.1}. The arrow keys move the point by \
             0.1 px.",
            size as f64 - 0.5
        ));
    }
    if document.selection == Some(at) {
        let accent = theme::palette(ui.visuals()).accent;
        let line = label.rect.union(last);
        ui.painter().hline(line.x_range(), line.max.y, Stroke::new(2.0, accent));
    }
}
