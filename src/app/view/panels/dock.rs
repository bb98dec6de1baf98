//! The dock: the card of the verdict, one tab, and the list of point pairs. Side by side at the bottom
//! of the window, one above the other at its right.

use egui::{CursorIcon, Rect, Sense, Stroke, Ui, UiBuilder, Vec2, vec2};

use super::{card, pairs, step_words, tabs};
use crate::app::model::dock::DockEdge;
use crate::app::model::{Command, Model, StageId};
use crate::app::view::theme;

/// Height of the folded dock at the bottom, screen points.
pub const FOLDED: f32 = 34.0;
/// Distance from the edge of the dock within which a drag changes its size, screen points.
const GRIP: f32 = 4.0;
/// Space around each part of the dock.
const INSET: Vec2 = vec2(12.0, 8.0);
/// Width from which card and pairs are side by side in a dock at the right.
const ROOM_FOR_BOTH: f32 = 500.0;
/// Height of the card in a dock at the right: beside the pairs, and above them.
const CARD_BESIDE: f32 = 300.0;
const CARD: f32 = 208.0;
/// Height of the details of an unfolded pair, and of the hint that is there otherwise.
const UNFOLDED: f32 = 190.0;
const HINT: f32 = 80.0;

pub fn show(ui: &mut Ui, area: Rect, edge: DockEdge, model: &Model, commands: &mut Vec<Command>) {
    ui.painter().rect_filled(area, 0.0, ui.visuals().panel_fill);
    let line = Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color);
    match edge {
        DockEdge::Bottom => drop(ui.painter().hline(area.x_range(), area.min.y, line)),
        DockEdge::Right => drop(ui.painter().vline(area.min.x, area.y_range(), line)),
    }
    if model.look.dock.folded {
        part(ui, area.shrink2(vec2(INSET.x, 2.0)), "folded dock", |ui| {
            ui.horizontal_centered(|ui| card::folded(ui, model, commands));
        });
        return;
    }
    grip(ui, area, edge, commands);
    let [card, tab, pairs] = match edge {
        DockEdge::Bottom => columns(area),
        DockEdge::Right => rows(area, model),
    };
    if model.is_at_start() && model.replayed().is_none() {
        // Nothing but the next step.
        part(ui, area.shrink2(INSET), "card", |ui| card::show(ui, model, commands));
    } else {
        let step = model.replayed().filter(|_| !model.pauses_at_hypothesis());
        part(ui, card.shrink2(INSET), "card", |ui| match step {
            Some(place) => step_words::show(ui, place.step, model, commands),
            None => card::show(ui, model, commands),
        });
        for rect in [tab, pairs] {
            if rect.min.x > area.min.x {
                ui.painter().vline(rect.min.x, rect.y_range(), line);
            }
            if rect.min.y > area.min.y {
                ui.painter().hline(rect.x_range(), rect.min.y, line);
            }
        }
        part(ui, tab.shrink2(INSET), "tab", |ui| match model.stage() {
            StageId::Pictures | StageId::Scene => tabs::show(ui, model, commands),
            StageId::Rectified => tabs::rectified::show_figures(ui, model, commands),
        });
        part(ui, pairs.shrink2(INSET), "pairs", |ui| pairs::show(ui, model, commands));
    }
}

/// Shows a part of the dock, clipped to its area.
fn part(ui: &mut Ui, area: Rect, name: &str, content: impl FnOnce(&mut Ui)) {
    if area.width() < 8.0 || area.height() < 8.0 {
        return;
    }
    let mut inside = ui.new_child(UiBuilder::new().max_rect(area).id_salt(name));
    inside.shrink_clip_rect(area.expand2(vec2(4.0, 2.0)));
    content(&mut inside);
}

/// Returns the columns of a dock at the bottom: card, tab and pairs.
fn columns(area: Rect) -> [Rect; 3] {
    let card = (area.width() * 0.26).clamp(190.0, 262.0).max(area.width() * 0.23).min(330.0);
    let pairs = (area.width() * 0.22).clamp(170.0, 300.0);
    let (card, rest) = area.split_left_right_at_x(area.min.x + card);
    let (tab, pairs) = rest.split_left_right_at_x(rest.max.x - pairs);
    [card, tab, pairs]
}

/// Returns the parts of a dock at the right: card, tab and, between or beside them, pairs.
fn rows(area: Rect, model: &Model) -> [Rect; 3] {
    if area.width() >= ROOM_FOR_BOTH {
        let card = CARD_BESIDE.min(area.height() * 0.4);
        let (top, tab) = area.split_top_bottom_at_y(area.min.y + card);
        let (card, pairs) = top.split_left_right_at_fraction(0.5);
        return [card, tab, pairs];
    }
    // Room for the lines, and for one unfolded pair or the hint. The card has the rest.
    let lines = model.document.pairs.len() as f32 * (theme::ROW + 2.0);
    let below = if model.document.selected_pair().is_some() { UNFOLDED } else { HINT };
    let pairs = (lines + below).clamp(100.0, (area.height() * 0.36).max(100.0));
    let card = (CARD + UNFOLDED - below).max(area.height() * 0.3).min(area.height() * 0.4);
    let (card, rest) = area.split_top_bottom_at_y(area.min.y + card);
    let (pairs, tab) = rest.split_top_bottom_at_y(rest.min.y + pairs);
    [card, tab, pairs]
}

/// Lets a drag of the edge change the size of the dock. A double click gives the room back that the
/// pictures cannot use.
fn grip(ui: &Ui, area: Rect, edge: DockEdge, commands: &mut Vec<Command>) {
    let (strip, cursor) = match edge {
        DockEdge::Bottom => (
            Rect::from_x_y_ranges(area.x_range(), area.min.y - GRIP..=area.min.y + GRIP),
            CursorIcon::ResizeVertical,
        ),
        DockEdge::Right => (
            Rect::from_x_y_ranges(area.min.x - GRIP..=area.min.x + GRIP, area.y_range()),
            CursorIcon::ResizeHorizontal,
        ),
    };
    let response = ui.interact(strip, ui.scope_id().with("edge of the dock"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, "Size of the dock"));
    if response.hovered() || response.dragged() {
        ui.ctx().set_cursor_icon(cursor);
    }
    if response.double_clicked() {
        commands.push(Command::SizeDock(edge, None));
    } else if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        let window = ui.ctx().content_rect();
        let share = match edge {
            DockEdge::Bottom => (area.max.y - at.y) / window.height(),
            DockEdge::Right => (area.max.x - at.x) / window.width(),
        };
        commands.push(Command::SizeDock(edge, Some(share)));
    }
}
