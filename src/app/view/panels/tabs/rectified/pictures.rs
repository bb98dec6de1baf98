//! The rectified pictures: side by side, by turns, or both in one. They always show the same part.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use egui::{CursorIcon, Id, Rect, Response, Role, Sense, Ui, WidgetInfo};

use super::sheet::{SheetCanvas, SheetRow};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::document::Side;
use crate::app::model::focus::Target;
use crate::app::model::rectified::{DrawnPair, RectifiedCommand, RectifiedLayout, RectifiedView, Sheet};
use crate::app::view::panes::navigation::zoom_asked;
use crate::app::view::panes::{PictureTexture, halves};
use crate::app::view::theme;

/// A picture and its place.
struct SheetPlace {
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
pub fn show(ui: &mut Ui, model: &Model, drawn: &DrawnPair, commands: &mut Vec<Command>) {
    let places: Vec<SheetPlace> = arranged(ui, model)
        .into_iter()
        .map(|(sheet, rect)| {
            let response = ui.interact(rect, ui.scope_id().with(sheet.name()), Sense::click_and_drag());
            response.widget_info(|| WidgetInfo::labeled(Role::Image, true, sheet.name()));
            SheetPlace { sheet, rect, response }
        })
        .collect();
    ui.advance_cursor_after_rect(ui.available_rect_before_wrap());
    let frame = drawn.frame();
    for place in &places {
        if let Some(command) = look(ui, place, model, drawn) {
            commands.push(command);
        }
    }
    let hovered = places.iter().find_map(|place| {
        let position = place.response.hover_pos()?;
        let transform = model.open.viewing.view(frame, place.rect).transform(frame, place.rect);
        let at = transform.image_from_screen(position);
        frame.contains(at).then_some((place.sheet, at))
    });
    let row = match (hovered, model.open.hover) {
        (Some((sheet, at)), _) => {
            commands.push(Command::PointAt(Target::Rectified { side: sheet.side(), at }));
            Some(SheetRow::under_cursor(model, drawn, sheet.side(), at))
        }
        (None, Some(hover)) => SheetRow::of_original(drawn, hover.side, hover.point),
        (None, None) => None,
    };
    for place in &places {
        let painter = ui.painter_at(place.rect);
        painter.rect_filled(place.rect, 4.0, theme::palette(ui.visuals()).canvas);
        let transform = model.open.viewing.view(frame, place.rect).transform(frame, place.rect);
        with_texture(ui.ctx(), drawn, place.sheet, |texture| texture.draw(&painter, &transform));
        let canvas =
            SheetCanvas { painter: &painter, transform: &transform, sheet: place.sheet, drawn, model };
        canvas.draw(row.as_ref());
    }
}

/// The textures of a pair, uploaded when first drawn, with the number of the pair.
type KeptTextures = (u64, Arc<Mutex<[Option<PictureTexture>; 3]>>);

fn kept_textures() -> Id {
    Id::unique("rectified textures")
}

/// Lets go of what was uploaded for pairs that nothing shows any more.
pub fn forget_textures(ctx: &egui::Context) {
    ctx.data_mut(|data| data.remove::<KeptTextures>(kept_textures()));
}

/// Lets `draw` draw one of the pictures.
fn with_texture(
    ctx: &egui::Context,
    drawn: &DrawnPair,
    sheet: Sheet,
    draw: impl FnOnce(&mut PictureTexture),
) {
    let kept = ctx.data(|data| data.get_temp::<KeptTextures>(kept_textures()));
    let (_, textures) = kept.filter(|(number, _)| *number == drawn.number).unwrap_or_else(|| {
        let fresh = (drawn.number, Arc::default());
        ctx.data_mut(|data| data.insert_temp::<KeptTextures>(kept_textures(), fresh.clone()));
        fresh
    });
    // Only this thread draws.
    let mut textures = textures.lock().unwrap_or_else(PoisonError::into_inner);
    let opened = &drawn.pictures[sheet as usize];
    draw(textures[sheet as usize].get_or_insert_with(|| PictureTexture::new(ctx, opened)));
}

/// Which pictures are shown where.
fn arranged(ui: &Ui, model: &Model) -> Vec<(Sheet, Rect)> {
    let area = ui.available_rect_before_wrap();
    match model.look.rectified.layout {
        RectifiedLayout::SideBySide => [Sheet::Left, Sheet::Right].into_iter().zip(halves(area)).collect(),
        RectifiedLayout::Anaglyph => vec![(Sheet::Anaglyph, area)],
        RectifiedLayout::Blink => {
            let (side, left) = model.open.viewing.blink.shown(ui.input(|input| input.time));
            if let Some(seconds) = left {
                ui.ctx().request_repaint_after(Duration::from_secs_f64(seconds));
            }
            vec![(Sheet::of(side), area)]
        }
    }
}

/// Zooming and moving: the part of all pictures that is wanted now, if it is another one.
fn look(ui: &Ui, place: &SheetPlace, model: &Model, drawn: &DrawnPair) -> Option<Command> {
    let SheetPlace { rect, response, .. } = place;
    if response.double_clicked() {
        return Some(RectifiedCommand::View(None).into());
    }
    let frame = drawn.frame();
    let before = model.open.viewing.view(frame, *rect);
    let mut view = before;
    if let Some((at, factor)) = zoom_asked(ui, response) {
        view.zoom(&view.transform(frame, *rect), frame, at, factor);
    }
    if response.dragged() {
        view.pan(&view.transform(frame, *rect), frame, view.centre, response.drag_delta());
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    } else if response.hovered() {
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    }
    (view != before).then_some(RectifiedCommand::View(Some(RectifiedView { frame, view })).into())
}
