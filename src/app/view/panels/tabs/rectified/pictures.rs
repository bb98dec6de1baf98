//! The rectified pictures in all layouts. All of them show the same part.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use egui::{CursorIcon, Id, Painter, Rect, Response, Role, Sense, Ui, WidgetInfo};

use super::sheet::{SheetCanvas, SheetRow};
use crate::app::model::rectified::{
    DrawnPair, RectifiedCommand, RectifiedLayout, RectifiedSheet, RectifiedView,
};
use crate::app::model::{Command, Model, Side, Target};
use crate::app::view::panes::{PictureTexture, Transform, halves, zoom_asked};
use crate::app::view::theme;

struct SheetPlace {
    sheet: RectifiedSheet,
    rect: Rect,
    response: Response,
}

fn name(sheet: RectifiedSheet) -> &'static str {
    match sheet {
        RectifiedSheet::Left => "rectified left picture",
        RectifiedSheet::Right => "rectified right picture",
        RectifiedSheet::Disparity => "disparities of the rectified pair",
    }
}

pub fn show(ui: &mut Ui, model: &Model, drawn: &DrawnPair, commands: &mut Vec<Command>) {
    let places: Vec<SheetPlace> = arranged(ui, model, drawn)
        .into_iter()
        .map(|(sheet, rect)| {
            let name = name(sheet);
            let response = ui.interact(rect, ui.scope_id().with(name), Sense::click_and_drag());
            response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
            SheetPlace { sheet, rect, response }
        })
        .collect();
    ui.advance_cursor_after_rect(ui.available_rect_before_wrap());
    let frame = drawn.frame();
    for place in &places {
        commands.extend(look(ui, place, model, drawn));
        if place.response.clicked() && !place.response.double_clicked() {
            commands.extend(registering(place, model, drawn));
        }
    }
    let hovered = places.iter().find_map(|place| {
        let position = place.response.hover_pos()?;
        let transform = transform_of(model, drawn, place.rect, place.sheet.side());
        let at = transform.image_from_screen(position);
        frame.contains(at).then_some((place.sheet, at))
    });
    let row = match (hovered, model.open.hover) {
        (Some((sheet, at)), _) => {
            commands.push(Command::PointAt(Target::Rectified { side: sheet.side(), at }));
            Some(SheetRow::under_cursor(model, drawn, sheet, at))
        }
        (None, Some(hover)) => SheetRow::of_original(model, drawn, hover.side, hover.point),
        (None, None) => None,
    };
    for place in &places {
        let painter = ui.painter_at(place.rect);
        painter.rect_filled(place.rect, 0.0, theme::palette(ui.visuals()).canvas);
        let transform = &transform_of(model, drawn, place.rect, place.sheet.side());
        paint(&painter, drawn, place.sheet, transform);
        let canvas = SheetCanvas { painter: &painter, transform, sheet: place.sheet, drawn, model };
        canvas.draw(row.as_ref());
    }
}

/// Returns the transform of the picture of one image. The right picture is displaced by the shift.
fn transform_of(model: &Model, drawn: &DrawnPair, rect: Rect, side: Side) -> Transform {
    let frame = drawn.frame();
    let mut view = model.open.viewing.view(frame, rect, drawn.turn(&model.look.rectified));
    view.scale = Some(view.transform(frame, rect).scale);
    if side == Side::Right {
        view.centre.x -= model.open.viewing.shift * drawn.reduction();
    }
    view.transform(frame, rect)
}

fn paint(painter: &Painter, drawn: &DrawnPair, sheet: RectifiedSheet, transform: &Transform) {
    let map = drawn.disparity.as_ref().filter(|_| sheet == RectifiedSheet::Disparity);
    // Each pixel of the map covers several pixels of the picture.
    let times = map.map_or(1.0, |(map, _)| drawn.frame().width as f64 / map.size()[0] as f64);
    with_texture(painter.ctx(), drawn, sheet, |texture| texture.draw(painter, &transform.of_reduced(times)));
}

/// Returns the command that aligns the pictures at the clicked point pair or disparity.
fn registering(place: &SheetPlace, model: &Model, drawn: &DrawnPair) -> Option<Command> {
    let position = place.response.interact_pointer_pos()?;
    let side = place.sheet.side();
    let transform = transform_of(model, drawn, place.rect, side);
    let near = model.document.pairs.iter().filter_map(|pair| {
        let at = drawn.shown.maps[side.index()].rectified_from_original(side.point(pair))?;
        let distance = transform.screen_from_image(at).distance(position);
        (distance <= theme::GRAB_RADIUS).then_some((pair, distance))
    });
    let pair = near.min_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(pair, _)| drawn.shift_of(pair));
    let mapped = || {
        let (map, _) = drawn.disparity.as_ref().filter(|_| place.sheet == RectifiedSheet::Disparity)?;
        let (at, frame) = (transform.image_from_screen(position), drawn.frame());
        let inside = frame.contains(at);
        map.at((at.x + 0.5) / frame.width as f64, (at.y + 0.5) / frame.height as f64).filter(|_| inside)
    };
    Some(RectifiedCommand::Shift(pair.or_else(mapped)?).into())
}

/// Textures of the pair with this number, uploaded when first drawn.
type KeptTextures = (u64, Arc<Mutex<[Option<PictureTexture>; RectifiedSheet::COUNT]>>);

fn kept_textures() -> Id {
    Id::unique("rectified textures")
}

/// Releases the textures of pairs that are no longer shown.
pub fn forget_textures(ctx: &egui::Context) {
    ctx.data_mut(|data| data.remove::<KeptTextures>(kept_textures()));
}

fn with_texture(
    ctx: &egui::Context,
    drawn: &DrawnPair,
    sheet: RectifiedSheet,
    draw: impl FnOnce(&mut PictureTexture),
) {
    let kept = ctx.data(|data| data.get_temp::<KeptTextures>(kept_textures()));
    let (_, textures) = kept.filter(|(number, _)| *number == drawn.number).unwrap_or_else(|| {
        let fresh = (drawn.number, Arc::default());
        ctx.data_mut(|data| data.insert_temp::<KeptTextures>(kept_textures(), fresh.clone()));
        fresh
    });
    // Only this thread draws, so the lock is free.
    let mut textures = textures.lock().unwrap_or_else(PoisonError::into_inner);
    let texture = &mut textures[sheet as usize];
    if texture.is_none() {
        let picture = match sheet {
            RectifiedSheet::Disparity => drawn.disparity.as_ref().map(|(_, picture)| picture),
            RectifiedSheet::Left | RectifiedSheet::Right => Some(&drawn.pictures[sheet.side().index()]),
        };
        *texture = picture.map(|picture| PictureTexture::new(ctx, picture));
    }
    if let Some(texture) = texture {
        draw(texture);
    }
}

/// Returns the pictures of the layout and their positions.
fn arranged(ui: &Ui, model: &Model, drawn: &DrawnPair) -> Vec<(RectifiedSheet, Rect)> {
    let area = ui.available_rect_before_wrap();
    match model.look.rectified.layout {
        RectifiedLayout::SideBySide => {
            // Rows are compared side by side, columns one above the other.
            let stacked = drawn.is_turned(&model.look.rectified);
            [RectifiedSheet::Left, RectifiedSheet::Right].into_iter().zip(halves(area, stacked)).collect()
        }
        RectifiedLayout::Disparity => vec![(RectifiedSheet::Disparity, area)],
        RectifiedLayout::Blink => {
            let (side, left) = model.open.viewing.blink.shown(ui.input(|input| input.time));
            if let Some(seconds) = left {
                ui.ctx().request_repaint_after(Duration::from_secs_f64(seconds));
            }
            vec![([RectifiedSheet::Left, RectifiedSheet::Right][side.index()], area)]
        }
    }
}

/// Handles zooming and panning. Returns the new view if it changed.
fn look(ui: &Ui, place: &SheetPlace, model: &Model, drawn: &DrawnPair) -> Option<Command> {
    let SheetPlace { rect, response, .. } = place;
    if response.double_clicked() {
        return Some(RectifiedCommand::View(None).into());
    }
    let frame = drawn.frame();
    let before = model.open.viewing.view(frame, *rect, drawn.turn(&model.look.rectified));
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
