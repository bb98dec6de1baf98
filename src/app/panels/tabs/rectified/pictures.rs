//! The rectified pictures: side by side, by turns, or both in one. They always show the same part.

use std::time::Duration;

use egui::{CursorIcon, Rect, Response, Role, Sense, Ui, WidgetInfo};

use super::sheet::{Canvas, Row};
use crate::app::command::Command;
use crate::app::document::Side;
use crate::app::focus::Target;
use crate::app::panes::halves;
use crate::app::panes::navigation::zoom_asked;
use crate::app::rectified::{Drawn, Layout, RectifiedCommand, RectifiedView, Sheet};
use crate::app::scene::Scene;
use crate::app::theme;

/// A picture and its place.
struct Place {
    sheet: Sheet,
    rect: Rect,
    response: Response,
}

impl Sheet {
    /// Whose picture it is; `None` when it is of both.
    pub(super) fn side(self) -> Option<Side> {
        match self {
            Self::Left => Some(Side::Left),
            Self::Right => Some(Side::Right),
            Self::Anaglyph => None,
        }
    }

    fn of(side: Side) -> Self {
        match side {
            Side::Left => Self::Left,
            Side::Right => Self::Right,
        }
    }

    /// Its name for those who cannot see it, and for tests.
    fn name(self) -> &'static str {
        match self {
            Self::Left => "rectified left picture",
            Self::Right => "rectified right picture",
            Self::Anaglyph => "anaglyph of the rectified pair",
        }
    }
}

/// Shows them in all the space there is.
pub fn show(ui: &mut Ui, scene: &Scene, drawn: &Drawn, commands: &mut Vec<Command>) {
    let places: Vec<Place> = arranged(ui, scene)
        .into_iter()
        .map(|(sheet, rect)| {
            let response = ui.interact(rect, ui.scope_id().with(sheet.name()), Sense::click_and_drag());
            response.widget_info(|| WidgetInfo::labeled(Role::Image, true, sheet.name()));
            Place { sheet, rect, response }
        })
        .collect();
    ui.advance_cursor_after_rect(ui.available_rect_before_wrap());
    let frame = drawn.frame();
    for place in &places {
        if let Some(command) = look(ui, place, scene, drawn) {
            commands.push(command);
        }
    }
    let hovered = places.iter().find_map(|place| {
        let position = place.response.hover_pos()?;
        let transform = scene.viewing.view(frame, place.rect).transform(frame, place.rect);
        let at = transform.image_from_screen(position);
        frame.contains(at).then_some((place.sheet, at))
    });
    let row = match (hovered, scene.hover) {
        (Some((sheet, at)), _) => {
            commands.push(Command::PointAt(Target::Rectified { side: sheet.side(), at }));
            Some(Row::under_cursor(scene, drawn, sheet.side(), at))
        }
        (None, Some(hover)) => Row::of_original(drawn, hover.side, hover.point),
        (None, None) => None,
    };
    for place in &places {
        let painter = ui.painter_at(place.rect);
        painter.rect_filled(place.rect, 4.0, theme::palette(ui.visuals()).canvas);
        let transform = scene.viewing.view(frame, place.rect).transform(frame, place.rect);
        drawn.with_texture(ui.ctx(), place.sheet, |texture| texture.draw(&painter, &transform));
        let canvas = Canvas { painter: &painter, transform: &transform, sheet: place.sheet, drawn, scene };
        canvas.draw(row.as_ref());
    }
}

/// Which pictures are shown where.
fn arranged(ui: &Ui, scene: &Scene) -> Vec<(Sheet, Rect)> {
    let area = ui.available_rect_before_wrap();
    match scene.look.rectified.layout {
        Layout::SideBySide => [Sheet::Left, Sheet::Right].into_iter().zip(halves(area)).collect(),
        Layout::Anaglyph => vec![(Sheet::Anaglyph, area)],
        Layout::Blink => {
            let (side, left) = scene.viewing.blink.shown(ui.input(|input| input.time));
            if let Some(seconds) = left {
                ui.ctx().request_repaint_after(Duration::from_secs_f64(seconds));
            }
            vec![(Sheet::of(side), area)]
        }
    }
}

/// Zooming and moving: the part of all pictures that is wanted now, if it is another one.
fn look(ui: &Ui, place: &Place, scene: &Scene, drawn: &Drawn) -> Option<Command> {
    let Place { rect, response, .. } = place;
    if response.double_clicked() {
        return Some(Command::Rectified(RectifiedCommand::View(None)));
    }
    let frame = drawn.frame();
    let before = scene.viewing.view(frame, *rect);
    let mut view = before;
    if let Some((at, factor)) = zoom_asked(ui, response) {
        view.zoom(&view.transform(frame, *rect), frame, at, factor);
    }
    if response.dragged() {
        view.pan(&view.transform(frame, *rect), frame, view.centre(), response.drag_delta());
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    } else if response.hovered() {
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    }
    (view != before)
        .then_some(Command::Rectified(RectifiedCommand::View(Some(RectifiedView { frame, view }))))
}
