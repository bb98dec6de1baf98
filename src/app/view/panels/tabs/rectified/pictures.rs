//! The rectified pictures in all layouts. All of them show the same part.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use egui::{Color32, CursorIcon, Id, Painter, Rect, Response, Role, Sense, Ui, WidgetInfo};

use super::sheet::{SheetCanvas, SheetRow};
use crate::app::model::rectified::{
    DrawnPair, RectifiedCommand, RectifiedLayout, RectifiedSheet, RectifiedView,
};
use crate::app::model::{Command, Model, Side, Target};
use crate::app::view::panes::{PictureTexture, Transform, halves, zoom_asked};
use crate::app::view::theme;
use crate::image::Rendition;

struct SheetPlace {
    sheet: RectifiedSheet,
    rect: Rect,
    response: Response,
}

impl RectifiedSheet {
    /// Returns the side of the picture; `None` if it shows both.
    pub(super) fn side(self) -> Option<Side> {
        match self {
            // The disparity map has the geometry of the left picture.
            Self::Left | Self::Disparity => Some(Side::Left),
            Self::Right => Some(Side::Right),
            Self::Both => None,
        }
    }

    fn of(side: Side) -> Self {
        match side {
            Side::Left => Self::Left,
            Side::Right => Self::Right,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Left => "rectified left picture",
            Self::Right => "rectified right picture",
            Self::Both => "anaglyph of the rectified pair",
            Self::Disparity => "disparities of the rectified pair",
        }
    }
}

pub fn show(ui: &mut Ui, model: &Model, drawn: &DrawnPair, commands: &mut Vec<Command>) {
    let places: Vec<SheetPlace> = arranged(ui, model, drawn)
        .into_iter()
        .map(|(sheet, rect)| {
            let name = sheet.name();
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
        let transform = transform_of(model, drawn, place.rect, place.sheet.side().unwrap_or(Side::Left));
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
        let transforms = Side::BOTH.map(|side| transform_of(model, drawn, place.rect, side));
        paint(&painter, drawn, place.sheet, &transforms);
        let canvas =
            SheetCanvas { painter: &painter, transforms: &transforms, sheet: place.sheet, drawn, model };
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

fn paint(painter: &Painter, drawn: &DrawnPair, sheet: RectifiedSheet, transforms: &[Transform; 2]) {
    let ctx = painter.ctx();
    let plain = |kept: Kept, side: Side| {
        with_texture(ctx, drawn, kept, |texture| texture.draw(painter, &transforms[side.index()]));
    };
    match sheet {
        RectifiedSheet::Left => plain(Kept::Left, Side::Left),
        RectifiedSheet::Right => plain(Kept::Right, Side::Right),
        RectifiedSheet::Both => {
            // The colours are added to the background.
            painter.rect_filled(transforms[0].rect, 0.0, Color32::BLACK);
            let (red, cyan) =
                (Color32::from_rgb(255, 0, 0), Color32::from_rgba_premultiplied(0, 255, 255, 0));
            for (kept, side, tint) in
                [(Kept::GreyLeft, Side::Left, red), (Kept::GreyRight, Side::Right, cyan)]
            {
                with_texture(ctx, drawn, kept, |texture| {
                    texture.draw_tinted(painter, &transforms[side.index()], tint);
                });
            }
        }
        RectifiedSheet::Disparity => {
            // Each pixel of the map covers several pixels of the picture.
            let Some((map, _)) = &drawn.disparity else { return };
            let transform = &transforms[Side::Left.index()];
            let times = drawn.frame().width as f64 / map.size()[0] as f64;
            let coarse = transform.of_reduced(times);
            with_texture(ctx, drawn, Kept::Disparity, |texture| texture.draw(painter, &coarse));
        }
    }
}

/// Returns the command that aligns the pictures at the clicked point pair or disparity.
fn registering(place: &SheetPlace, model: &Model, drawn: &DrawnPair) -> Option<Command> {
    let position = place.response.interact_pointer_pos()?;
    let transforms = Side::BOTH.map(|side| transform_of(model, drawn, place.rect, side));
    let sides = Side::BOTH.into_iter().filter(|side| place.sheet.side().is_none_or(|own| own == *side));
    let near = sides.flat_map(|side| model.document.pairs.iter().map(move |pair| (side, pair)));
    let near = near.filter_map(|(side, pair)| {
        let at = drawn.shown.maps[side.index()].rectified_from_original(side.point(pair))?;
        let distance = transforms[side.index()].screen_from_image(at).distance(position);
        (distance <= theme::GRAB_RADIUS).then_some((pair, distance))
    });
    let pair = near.min_by(|a, b| a.1.total_cmp(&b.1)).and_then(|(pair, _)| drawn.shift_of(pair));
    let mapped = || {
        let (map, _) = drawn.disparity.as_ref().filter(|_| place.sheet == RectifiedSheet::Disparity)?;
        let (at, frame) = (transforms[0].image_from_screen(position), drawn.frame());
        let inside = frame.contains(at);
        map.at((at.x + 0.5) / frame.width as f64, (at.y + 0.5) / frame.height as f64).filter(|_| inside)
    };
    Some(RectifiedCommand::Shift(pair.or_else(mapped)?).into())
}

#[derive(Debug, Clone, Copy)]
enum Kept {
    Left,
    Right,
    GreyLeft,
    GreyRight,
    Disparity,
}

impl Kept {
    const COUNT: usize = 5;

    fn uploaded(self, ctx: &egui::Context, drawn: &DrawnPair) -> Option<PictureTexture> {
        let grey = Rendition { grey: true, ..Rendition::default() };
        let picture = |k: usize, rendition| {
            let mut texture = PictureTexture::new(ctx, &drawn.pictures[k]);
            texture.set_rendition(rendition);
            texture
        };
        Some(match self {
            Self::Left => picture(0, Rendition::default()),
            Self::Right => picture(1, Rendition::default()),
            Self::GreyLeft => picture(0, grey),
            Self::GreyRight => picture(1, grey),
            Self::Disparity => PictureTexture::new(ctx, &drawn.disparity.as_ref()?.1),
        })
    }
}

/// Textures of the pair with this number, uploaded when first drawn.
type KeptTextures = (u64, Arc<Mutex<[Option<PictureTexture>; Kept::COUNT]>>);

fn kept_textures() -> Id {
    Id::unique("rectified textures")
}

/// Releases the textures of pairs that are no longer shown.
pub fn forget_textures(ctx: &egui::Context) {
    ctx.data_mut(|data| data.remove::<KeptTextures>(kept_textures()));
}

fn with_texture(ctx: &egui::Context, drawn: &DrawnPair, which: Kept, draw: impl FnOnce(&mut PictureTexture)) {
    let kept = ctx.data(|data| data.get_temp::<KeptTextures>(kept_textures()));
    let (_, textures) = kept.filter(|(number, _)| *number == drawn.number).unwrap_or_else(|| {
        let fresh = (drawn.number, Arc::default());
        ctx.data_mut(|data| data.insert_temp::<KeptTextures>(kept_textures(), fresh.clone()));
        fresh
    });
    // Only this thread draws, so the lock is free.
    let mut textures = textures.lock().unwrap_or_else(PoisonError::into_inner);
    let texture = &mut textures[which as usize];
    if texture.is_none() {
        *texture = which.uploaded(ctx, drawn);
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
        RectifiedLayout::Anaglyph => vec![(RectifiedSheet::Both, area)],
        RectifiedLayout::Disparity => vec![(RectifiedSheet::Disparity, area)],
        RectifiedLayout::Blink => {
            let (side, left) = model.open.viewing.blink.shown(ui.input(|input| input.time));
            if let Some(seconds) = left {
                ui.ctx().request_repaint_after(Duration::from_secs_f64(seconds));
            }
            vec![(RectifiedSheet::of(side), area)]
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
