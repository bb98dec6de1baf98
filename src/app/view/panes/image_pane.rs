//! An image pane: zooming, panning, clicks and drags.

use egui::{Align2, CursorIcon, PointerButton, Pos2, Rect, Response, Sense, StrokeKind, Ui, WidgetInfo};

use super::chip::Chip;
use super::loupe;
use super::overlays::{
    Canvas, Labels, OVERLAYS, draw_crosshair, pinned_at, pointed_at, replay, suggested_places,
};
use super::texture::PictureTexture;
use super::transform::{Transform, zoom_asked};
use crate::app::model::look::Tool;
use crate::app::model::open_pair::Hover;
use crate::app::model::pane_view::{LARGEST_SCALE, PaneView, QuarterTurns};
use crate::app::model::picture::Opened;
use crate::app::model::replay::ReplayCommand;
use crate::app::model::replay::moment::Moment;
use crate::app::model::shared::Shared;
use crate::app::model::{Command, LineSource, Model, OverlayId, PointRef, Side, pair_name};
use crate::app::view::panels::{pair_menu, pin_menu, place_menu};
use crate::app::view::theme;
use crate::camera::UndistortedView;
use crate::geometry::{Frame, Point};
use crate::image::Picture;

/// Magnification of an image that is fitted, to show a point.
const CLOSER: f64 = 4.0;

#[derive(Debug, Clone, Copy)]
struct Drag {
    /// Position where the button went down. Summing steps would lose the first pixels, before egui
    /// detects a drag.
    origin: Pos2,
    what: Dragged,
}

#[derive(Debug, Clone, Copy)]
enum Dragged {
    /// A point, and its image position at the start.
    Point(PointRef, Point),
    /// The view, and the image position in the middle of the pane at the start.
    View(Point),
}

/// Subject of a context menu.
#[derive(Debug, Clone, Copy)]
enum Menu {
    /// A point pair, by its index.
    Pair(usize),
    /// A pinned line pair, by its number.
    Pin(usize),
    /// A place without a point or a pinned line.
    Place(Point),
}

pub struct ImagePane {
    side: Side,
    image: Option<PaneImage>,
    drag: Option<Drag>,
    /// Subject of the latest context menu.
    menu: Option<Menu>,
    /// Area of the latest frame.
    rect: Rect,
    /// Area of the name in the latest frame.
    chip: Rect,
}

/// View and position of a pane.
#[derive(Debug, Clone, Copy)]
pub struct PanePlace {
    pub view: PaneView,
    /// Area of the latest frame.
    pub rect: Rect,
}

struct PaneImage {
    /// The picture of the computation, whose coordinates the window uses.
    picture: Shared<Picture>,
    /// Size of the picture on the screen.
    shown: Frame,
    lens: Option<UndistortedView>,
    texture: PictureTexture,
    view: PaneView,
}

impl PaneImage {
    fn transform(&self, rect: Rect) -> Transform {
        self.view.transform(self.shown, rect).through(self.lens.as_ref())
    }

    /// Returns the transform at a moment of the replay. Epipoles far outside come into view.
    fn zoomed_out(&self, rect: Rect, moment: Option<&Moment>) -> Transform {
        let Some(zoom) = moment.map(|moment| moment.zoom).filter(|zoom| *zoom > 1.0) else {
            return self.transform(rect);
        };
        let whole = self.view.fitted(self.shown).transform(self.shown, rect);
        whole.at(rect, whole.scale / zoom).through(self.lens.as_ref())
    }
}

impl ImagePane {
    pub fn new(side: Side) -> Self {
        Self { side, image: None, drag: None, menu: None, rect: Rect::ZERO, chip: Rect::NOTHING }
    }

    pub fn side(&self) -> Side {
        self.side
    }

    /// Shows another picture completely.
    pub fn set_picture(&mut self, ctx: &egui::Context, opened: &Opened) {
        let texture = PictureTexture::new(ctx, opened);
        let shown = opened.shown().frame();
        let (picture, lens, view) =
            (opened.picture.clone(), opened.distortion().copied(), PaneView::fitting(shown));
        self.image = Some(PaneImage { picture, shown, lens, texture, view });
        self.drag = None;
    }

    pub fn fit(&mut self) {
        if let Some(image) = &mut self.image {
            image.view = image.view.fitted(image.shown);
        }
    }

    /// Turns the image on the screen clockwise by 90°.
    pub fn turn(&mut self) {
        if let Some(image) = &mut self.image {
            image.view = image.view.turned();
        }
    }

    /// Returns the visible part of the image.
    pub fn view(&self) -> Option<PaneView> {
        self.image.as_ref().map(|image| image.view)
    }

    /// Returns the visible part of the image, and the area of the pane.
    pub fn place(&self) -> Option<PanePlace> {
        Some(PanePlace { view: self.view()?, rect: self.rect })
    }

    pub fn set_view(&mut self, view: PaneView) {
        if let Some(image) = &mut self.image {
            image.view = view;
        }
    }

    /// Shows a pixel in the middle of the pane, magnified if the whole image is visible.
    pub fn magnify_at(&mut self, pixel: Point) {
        if let Some(image) = &mut self.image {
            let scale = image.transform(self.rect).scale * if image.view.fits() { CLOSER } else { 1.0 };
            image.view = PaneView { centre: pixel, scale: Some(scale.min(LARGEST_SCALE)), ..image.view };
            image.view.keep_in_sight(image.shown);
        }
    }

    /// Draws the whole image with a ring at a point, in a corner of an area. Returns the occupied area.
    pub fn draw_small(&mut self, painter: &egui::Painter, area: Rect, corner: Align2, point: Point) -> Rect {
        let Some(image) = &mut self.image else { return Rect::NOTHING };
        let view = image.view.fitted(image.shown);
        let Frame { width, height } = view.turn.turned_frame(image.shown);
        let scale = (area.width() / width as f32).min(area.height() / height as f32);
        let size = egui::vec2(width as f32, height as f32) * scale;
        let rect = corner.align_size_within_rect(size, area);
        let transform = view.transform(image.shown, rect).through(image.lens.as_ref());
        image.texture.draw(&painter.with_clip_rect(rect), &transform);
        painter.rect_stroke(rect, 0.0, egui::Stroke::new(1.0, theme::SELECTED), StrokeKind::Outside);
        let at = transform.screen_from_image(point);
        for (width, color) in [(4.0, theme::HALO), (2.0, theme::SELECTED)] {
            painter.circle_stroke(at, theme::HANDLE_RADIUS, egui::Stroke::new(width, color));
        }
        rect
    }

    /// Shows the same part as another pane.
    pub fn follow(&mut self, leader: &Self) {
        if let (Some(own), Some(other)) = (&mut self.image, &leader.image) {
            let place = |image: &PaneImage, rect| (image.shown, rect);
            own.view = other.view.carried_over(place(other, leader.rect), &own.view, place(own, self.rect));
        }
    }

    /// Ends a drag. Returns whether a point was dragged.
    pub fn let_go(&mut self) -> bool {
        matches!(self.drag.take(), Some(Drag { what: Dragged::Point(..), .. }))
    }

    /// Shows the pane in all available space. Returns the image position under the cursor.
    pub fn show(&mut self, ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> Option<Hover> {
        let rect = ui.available_rect_before_wrap();
        self.rect = rect;
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        let side = self.side;
        response
            .widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, format!("{} image", side.name())));
        let painter = ui.painter_at(rect);
        let palette = theme::palette(ui.visuals());
        painter.rect_filled(rect, 0.0, palette.canvas);
        let Some(image) = &mut self.image else {
            let text = if model.activity.loading { "Opening" } else { "Drop an image here" };
            let color = ui.visuals().weak_text_color();
            let font = egui::TextStyle::Body.resolve(ui.style());
            painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, font, color);
            return None;
        };
        let frame = image.picture.frame();
        zoom(ui, &response, image);
        let moment = model.drawn_moment();
        let mut transform = image.zoomed_out(rect, moment);
        if let Some(drag) = &self.drag {
            follow(ui, drag, image, &transform, commands);
            transform = image.zoomed_out(rect, moment);
        }
        let labels = Labels::default();
        labels.take(self.chip);
        let canvas = Canvas {
            painter: &painter,
            transform: &transform,
            side,
            frame,
            model,
            labels: Some(&labels),
            is_figure: false,
        };
        self.press(ui, &response, &canvas, commands);
        let image = self.image.as_mut()?;
        let rendition = model.open.rendition(side);
        let piled = moment.and_then(|moment| moment.piled);
        match model.shown_frames() {
            Some(frames) => {
                let marked = model.open.player.silhouettes || piled.is_some();
                image.texture.show_frame(frames[side.index()], marked, rendition);
            }
            None => image.texture.set_rendition(rendition),
        }
        let tint = moment.map_or(egui::Color32::WHITE, |_| theme::DIMMED);
        image.texture.draw_tinted(&painter, &transform, tint);
        if let Some(piled) = piled {
            image.texture.draw_pile(&painter, &transform, piled[side.index()]);
        }
        draw_overlays(&canvas);
        if response.secondary_clicked() && self.menu.is_none() && model.look.shows(OverlayId::Pinned) {
            let under = response.interact_pointer_pos().and_then(|at| pinned_at(&canvas, at));
            self.menu = under.map(Menu::Pin);
        }
        if response.secondary_clicked() && self.menu.is_none() {
            let under = response.interact_pointer_pos().map(|at| transform.image_from_screen(at));
            self.menu = under.filter(|point| frame.contains(*point)).map(Menu::Place);
        }
        match self.menu {
            Some(Menu::Pair(pair)) if pair <= model.document.pairs.len() => {
                response.context_menu(|ui| pair_menu(ui, model, pair, commands));
            }
            Some(Menu::Pin(number)) => {
                response.context_menu(|ui| pin_menu(ui, model, number, commands));
            }
            Some(Menu::Place(point)) => {
                response.context_menu(|ui| place_menu(ui, model, side, point, commands));
            }
            _ => {}
        }
        if let Some(target) = response.hover_pos().and_then(|position| pointed_at(&canvas, position)) {
            commands.push(Command::PointAt(target));
        }
        draw_crosshair(&canvas);
        let due = model.document.half.is_some_and(|half| half.side != side);
        if due {
            painter.rect_stroke(rect, 0.0, egui::Stroke::new(2.0, palette.accent), StrokeKind::Inside);
        }
        let hover = self.under_cursor(&response, &canvas);
        if let Some(point) = self.magnified(model, hover) {
            let uncovered: Vec<Pos2> = suggested_places(&canvas).into_iter().map(|(_, at)| at).collect();
            self.magnify(&canvas, point, &uncovered);
        }
        if let Some(image) = &self.image {
            let scale = Some(image.transform(rect).scale).filter(|_| !image.view.fits());
            let (lens, is_turned) = (image.lens, image.view.turn != QuarterTurns::default());
            let chip = Chip { side, rect, size: image.shown, lens, is_turned, scale };
            self.chip = chip.show(ui, model);
        }
        hover
    }

    /// Returns the place in this image under the cursor, or under the crosshair of the keyboard.
    fn under_cursor(&self, response: &Response, canvas: &Canvas) -> Option<Hover> {
        let Canvas { model, transform, frame, side, .. } = *canvas;
        if let Some(crosshair) = model.crosshair_as_hover() {
            return Some(crosshair).filter(|crosshair| crosshair.side == side);
        }
        if let Some(Drag { what: Dragged::Point(at, _), .. }) = self.drag {
            return model.document.point(at).map(|point| Hover { side, point, dragging: true });
        }
        let under = response.hover_pos().map(|position| transform.image_from_screen(position));
        let inside = under.filter(|point| frame.contains(*point));
        inside.map(|point| Hover { side, point, dragging: false })
    }

    /// Returns the point below the loupe: the one that is dragged, or the place of a click that is due. The
    /// other image magnifies the other point of that pair, so that both can be compared.
    fn magnified(&self, model: &Model, hover: Option<Hover>) -> Option<Point> {
        let document = &model.document;
        let hover = hover.or(model.open.hover.filter(|hover| hover.side != self.side))?;
        let here = hover.side == self.side;
        if hover.dragging {
            let dragged = document.selection?;
            let other = PointRef { side: self.side, ..dragged };
            return if here { Some(hover.point) } else { document.point(other) };
        }
        // The lesson of the sample is about lines.
        if self.drag.is_some() || model.tool != Tool::Points || model.lesson().is_some() {
            return None;
        }
        match document.half {
            Some(half) if half.side != hover.side => Some(if here { hover.point } else { half.point }),
            Some(_) => None,
            None => (here && document.used_pairs().is_none()).then_some(hover.point),
        }
    }

    /// Draws the loupe beside a point.
    fn magnify(&mut self, pane: &Canvas, point: Point, uncovered: &[Pos2]) {
        let Some(image) = &mut self.image else { return };
        let Some(transform) = loupe::place(pane.transform, point, uncovered) else { return };
        let painter = pane.painter.with_clip_rect(transform.rect.intersect(pane.transform.rect));
        painter.rect_filled(transform.rect, 6.0, egui::Color32::from_gray(30));
        image.texture.draw(&painter, &transform);
        let canvas = Canvas { painter: &painter, transform: &transform, labels: None, ..*pane };
        for overlay in &OVERLAYS {
            if pane.model.look.shows(overlay.id) && overlay.magnified {
                (overlay.draw)(&canvas);
            }
        }
        loupe::finish(&painter, &transform);
    }

    /// Handles clicks, double clicks, and the start and end of drags.
    fn press(&mut self, ui: &Ui, response: &Response, canvas: &Canvas, commands: &mut Vec<Command>) {
        let Canvas { model, transform, frame, side, .. } = *canvas;
        let Some(centre) = self.image.as_ref().map(|image| image.view.centre) else { return };
        let space = ui.input(|input| input.key_down(egui::Key::Space));
        let handle_at = |position: Pos2| handle_at(model, side, transform, position);
        // The matches of different scenes are drawn without a replay. Clicks among them place points.
        let replayed_at = |position: Pos2| {
            model.replayed()?;
            replay::at(canvas, position).map(|own| own.target)
        };
        if response.drag_started()
            && let Some(origin) = ui.input(|input| input.pointer.press_origin())
        {
            let primary = response.drag_started_by(PointerButton::Primary);
            let what = match handle_at(origin) {
                Some((at, point)) if primary && !space => {
                    commands.push(Command::Select(Some(at)));
                    Dragged::Point(at, point)
                }
                _ => Dragged::View(centre),
            };
            self.drag = Some(Drag { origin, what });
        }
        if response.drag_stopped() && self.let_go() {
            commands.push(Command::EndDrag);
        }
        let menu_open = self.menu.is_some() && response.context_menu_opened();
        if response.secondary_clicked() {
            let under = response.interact_pointer_pos().and_then(handle_at);
            self.menu = under.map(|(at, _)| Menu::Pair(at.pair));
            if let Some((at, _)) = under {
                commands.push(Command::Select(Some(at)));
            }
        }
        if menu_open && response.clicked() {
            // This click only closes the menu.
        } else if response.double_clicked_by(PointerButton::Primary) {
            commands.push(Command::FitAfterDoubleClick(self.side));
        } else if response.clicked_by(PointerButton::Primary)
            && let Some(position) = response.interact_pointer_pos()
            && !space
        {
            let point = transform.image_from_screen(position);
            let handle = handle_at(position).map(|(at, _)| at);
            if model.tool == Tool::Inspect {
                let whole = handle.filter(|at| at.pair < model.document.pairs.len());
                let source =
                    whole.map_or(LineSource::Through { side, point }, |at| LineSource::Pair(at.pair));
                if frame.contains(point) {
                    commands.push(Command::Pin(source));
                }
            } else if let Some(at) = handle {
                commands.push(Command::Select(Some(at)));
            } else if let Some(target) = replayed_at(position) {
                commands.push(ReplayCommand::Show(target).into());
            } else if frame.contains(point) {
                commands.push(Command::Place(self.side, point));
            } else {
                commands.push(Command::Select(None));
            }
        }
        let cursor = match self.drag.map(|drag| drag.what) {
            Some(Dragged::Point(..)) => CursorIcon::None,
            Some(Dragged::View(_)) => CursorIcon::Grabbing,
            None if space => CursorIcon::Grab,
            None if response.hover_pos().and_then(handle_at).is_some() => CursorIcon::Move,
            None if response.hover_pos().and_then(replayed_at).is_some() => CursorIcon::PointingHand,
            None => CursorIcon::Crosshair,
        };
        if response.hovered() || self.drag.is_some() {
            ui.ctx().set_cursor_icon(cursor);
        }
        let under = response.hover_pos().and_then(handle_at).map(|(at, _)| at);
        if let Some(at) = under.filter(|at| self.drag.is_none() && model.document.selection != Some(*at)) {
            let name = pair_name(at.pair);
            response.clone().on_hover_text_at_pointer(format!(
                "Point {name}: drag it, or use the arrow keys. Right-click for more."
            ));
        }
    }
}

/// Draws the moment of the replay, with the points alone, or else all visible overlays.
fn draw_overlays(canvas: &Canvas) {
    let (look, moment) = (&canvas.model.look, canvas.model.drawn_moment());
    if let Some(moment) = moment {
        replay::draw(canvas, moment);
    }
    let is_paused = !canvas.model.open.replay.is_playing();
    let is_part = |id: OverlayId| match id {
        OverlayId::Points | OverlayId::PointedAt => true,
        OverlayId::Pinned => moment.is_none() || is_paused,
        _ => moment.is_none(),
    };
    for overlay in OVERLAYS.iter().filter(|overlay| is_part(overlay.id) && look.shows(overlay.id)) {
        (overlay.draw)(canvas);
    }
}

/// Returns the nearest point within reach of the cursor.
fn handle_at(model: &Model, side: Side, transform: &Transform, position: Pos2) -> Option<(PointRef, Point)> {
    let distance = |point: Point| transform.screen_from_image(point).distance(position);
    let within_reach =
        model.document.points(side).filter(|(_, point)| distance(*point) <= theme::GRAB_RADIUS);
    within_reach.min_by(|(_, a), (_, b)| distance(*a).total_cmp(&distance(*b)))
}

fn zoom(ui: &Ui, response: &Response, image: &mut PaneImage) {
    if let Some((at, factor)) = zoom_asked(ui, response) {
        let transform = image.transform(response.rect);
        image.view.zoom(&transform, image.shown, at, factor);
    }
}

fn follow(ui: &Ui, drag: &Drag, image: &mut PaneImage, transform: &Transform, commands: &mut Vec<Command>) {
    let Some(position) = ui.input(|input| input.pointer.latest_pos()) else { return };
    let delta = position - drag.origin;
    match drag.what {
        Dragged::Point(at, start) => {
            let moved = if transform.bends() {
                transform.image_from_screen(transform.screen_from_image(start) + delta)
            } else {
                start + transform.image_vector(delta)
            };
            // Beyond the range of the lens the point stays where it is.
            if moved.iter().all(|v| v.is_finite()) {
                commands.push(Command::Drag(at, moved));
            }
        }
        Dragged::View(start) => image.view.pan(transform, image.shown, start, delta),
    }
}
