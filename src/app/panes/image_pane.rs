//! One image: zooming, panning, and clicks and drags turned into commands.

use std::sync::Arc;

use egui::{CursorIcon, PointerButton, Pos2, Rect, Response, Sense, StrokeKind, Ui, WidgetInfo};

use super::navigation::zoom_asked;
use super::overlays::{Canvas, OVERLAYS, pointed_at};
use super::texture::PictureTexture;
use super::view::{Transform, View};
use super::{epipole_map, loupe};
use crate::app::command::Command;
use crate::app::document::{PointRef, Side, pair_name};
use crate::app::focus::LineSource;
use crate::app::loader::Opened;
use crate::app::look::Tool;
use crate::app::scene::{Hover, Scene};
use crate::app::theme;
use crate::geometry::{Frame, Point, Vector};
use crate::image::Picture;

/// What the mouse is doing.
#[derive(Debug, Clone, Copy)]
struct Drag {
    /// Where the button went down. The whole way from here counts: summing the steps would lose the first
    /// few pixels, before egui calls it a drag.
    origin: Pos2,
    what: Dragged,
}

#[derive(Debug, Clone, Copy)]
enum Dragged {
    /// A point that was at this image position.
    Point(PointRef, Point),
    /// The image; this position was in the middle of the pane.
    View(Point),
}

/// One of the two image panes.
pub struct ImagePane {
    side: Side,
    shown: Option<Shown>,
    drag: Option<Drag>,
    /// Where it was drawn last.
    rect: Rect,
}

/// The picture in a pane.
struct Shown {
    picture: Arc<Picture>,
    texture: PictureTexture,
    view: View,
}

impl ImagePane {
    /// An empty pane.
    pub fn new(side: Side) -> Self {
        Self { side, shown: None, drag: None, rect: Rect::ZERO }
    }

    /// Shows another picture, whole.
    pub fn set_picture(&mut self, ctx: &egui::Context, opened: &Opened) {
        let texture = PictureTexture::new(ctx, Arc::clone(&opened.picture), &opened.overview);
        let view = View::fitting(opened.picture.frame());
        self.shown = Some(Shown { picture: Arc::clone(&opened.picture), texture, view });
        self.drag = None;
    }

    /// Shows the whole image.
    pub fn fit(&mut self) {
        if let Some(shown) = &mut self.shown {
            shown.view = View::fitting(shown.picture.frame());
        }
    }

    /// What part of the image is shown.
    pub fn view(&self) -> Option<View> {
        self.shown.as_ref().map(|shown| shown.view)
    }

    /// Shows a part of the image.
    pub fn set_view(&mut self, view: View) {
        if let Some(shown) = &mut self.shown {
            shown.view = view;
        }
    }

    /// Shows the part of the image that another pane shows of its own.
    pub fn follow(&mut self, leader: &Self) {
        if let (Some(own), Some(other)) = (&mut self.shown, &leader.shown) {
            let place = |shown: &Shown, rect| (shown.picture.frame(), rect);
            own.view = other.view.carried_over(place(other, leader.rect), place(own, self.rect));
        }
    }

    /// Lets go of what is being dragged; says whether it was a point.
    pub fn let_go(&mut self) -> bool {
        matches!(self.drag.take(), Some(Drag { what: Dragged::Point(..), .. }))
    }

    /// Shows the pane in all the space there is; returns the image position under the cursor.
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) -> Option<Hover> {
        self.header(ui, scene);
        let rect = ui.available_rect_before_wrap();
        self.rect = rect;
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        let side = self.side;
        response
            .widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, format!("{} image", side.name())));
        let painter = ui.painter_at(rect);
        let palette = theme::palette(ui.visuals());
        painter.rect_filled(rect, 4.0, palette.canvas);
        let Some(shown) = &mut self.shown else {
            let text = if scene.loading { "Opening" } else { "Drop an image here" };
            let color = ui.visuals().weak_text_color();
            let font = egui::TextStyle::Body.resolve(ui.style());
            painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, font, color);
            return None;
        };
        let frame = shown.picture.frame();
        zoom(ui, &response, shown, frame);
        let mut transform = shown.view.transform(frame, rect);
        if let Some(drag) = &self.drag {
            follow(ui, drag, shown, &transform, commands);
            transform = shown.view.transform(frame, rect);
        }
        self.press(ui, &response, scene, &transform, commands);
        let shown = self.shown.as_mut()?;
        shown.texture.draw(&painter, &transform);
        let canvas = Canvas { painter: &painter, transform: &transform, side, frame, scene };
        for (overlay, visible) in OVERLAYS.iter().zip(scene.overlays) {
            if *visible {
                (overlay.draw)(&canvas);
            }
        }
        if let Some(target) = response.hover_pos().and_then(|position| pointed_at(&canvas, position)) {
            commands.push(Command::PointAt(target));
        }
        if scene.look.map {
            epipole_map::show(ui, rect, side, frame, scene, commands);
        }
        let due = scene.document.half.is_some_and(|half| half.side != side);
        if due {
            painter.rect_stroke(rect, 4.0, egui::Stroke::new(2.0, palette.accent), StrokeKind::Inside);
        }
        let hover = if let Some(Drag { what: Dragged::Point(at, _), .. }) = self.drag {
            scene.document.point(at).map(|point| Hover { side, point, dragging: true })
        } else {
            let under = response.hover_pos().map(|position| transform.image_from_screen(position));
            let inside = under.filter(|point| frame.contains(*point));
            inside.map(|point| Hover { side, point, dragging: false })
        };
        if let Some(hover) = hover.filter(|hover| scene.look.loupe && self.wants_loupe(scene, *hover)) {
            self.magnify(&painter, &transform, hover.point, scene);
        }
        hover
    }

    /// Whether a point is being dragged, or the next click will place one that is needed.
    fn wants_loupe(&self, scene: &Scene, hover: Hover) -> bool {
        let document = scene.document;
        let due = match document.half {
            Some(half) => half.side != self.side,
            None => document.used_pairs().is_none(),
        };
        hover.dragging || due && self.drag.is_none() && scene.tool == Tool::Points
    }

    /// Draws the loupe beside a point.
    fn magnify(&mut self, painter: &egui::Painter, pane: &Transform, point: Point, scene: &Scene) {
        let (Some(shown), Some(transform)) = (&mut self.shown, loupe::place(pane, point)) else { return };
        let painter = painter.with_clip_rect(transform.rect.intersect(pane.rect));
        painter.rect_filled(transform.rect, 6.0, egui::Color32::from_gray(30));
        shown.texture.draw(&painter, &transform);
        let frame = shown.picture.frame();
        let canvas = Canvas { painter: &painter, transform: &transform, side: self.side, frame, scene };
        for (overlay, visible) in OVERLAYS.iter().zip(scene.overlays) {
            if *visible && overlay.magnified {
                (overlay.draw)(&canvas);
            }
        }
        loupe::finish(&painter, &transform);
    }

    /// The line above the image: which one it is, its name, size and zoom.
    fn header(&self, ui: &mut Ui, scene: &Scene) {
        ui.horizontal(|ui| {
            let title = match self.side {
                Side::Left => "Left",
                Side::Right => "Right",
            };
            ui.strong(title);
            let Some(picture) = scene.document.pictures.as_ref().map(|p| &p[self.side.index()]) else {
                return;
            };
            let Frame { width, height } = picture.frame;
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.weak(format!("{width} × {height} px"));
                if let Some(shown) = self.shown.as_ref().filter(|shown| !shown.view.fits()) {
                    let rect = ui.available_rect_before_wrap();
                    let scale = shown.view.transform(picture.frame, rect).scale;
                    ui.weak(format!("{:.0} %", scale * 100.0));
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    ui.add(egui::Label::new(egui::RichText::new(&picture.name).weak()).truncate());
                });
            });
        });
    }

    /// Clicks, double clicks and the beginning and end of drags.
    fn press(
        &mut self,
        ui: &Ui,
        response: &Response,
        scene: &Scene,
        transform: &Transform,
        commands: &mut Vec<Command>,
    ) {
        let Some(shown) = &self.shown else { return };
        let (frame, centre) = (shown.picture.frame(), shown.view.centre());
        let space = ui.input(|input| input.key_down(egui::Key::Space));
        let side = self.side;
        let handle_at = |position: Pos2| handle_at(scene, side, transform, position);
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
        if response.double_clicked_by(PointerButton::Primary) {
            commands.push(Command::FitAfterDoubleClick(self.side));
        } else if response.clicked_by(PointerButton::Primary)
            && let Some(position) = response.interact_pointer_pos()
            && !space
        {
            let point = transform.image_from_screen(position);
            let handle = handle_at(position).map(|(at, _)| at);
            if scene.tool == Tool::Inspect {
                let whole = handle.filter(|at| at.pair < scene.document.pairs.len());
                let source =
                    whole.map_or(LineSource::Through { side, point }, |at| LineSource::Pair(at.pair));
                if frame.contains(point) {
                    commands.push(Command::Pin(source));
                }
            } else if let Some(at) = handle {
                commands.push(Command::Select(Some(at)));
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
            None => CursorIcon::Crosshair,
        };
        if response.hovered() || self.drag.is_some() {
            ui.ctx().set_cursor_icon(cursor);
        }
        let under = response.hover_pos().and_then(handle_at).map(|(at, _)| at);
        if let Some(at) = under.filter(|at| self.drag.is_none() && scene.document.selection != Some(*at)) {
            let name = pair_name(at.pair);
            response
                .clone()
                .on_hover_text_at_pointer(format!("Point {name}: drag it, or use the arrow keys."));
        }
    }
}

/// The handle that a press at this place takes hold of: the nearest one within reach.
fn handle_at(scene: &Scene, side: Side, transform: &Transform, position: Pos2) -> Option<(PointRef, Point)> {
    let distance = |point: Point| transform.screen_from_image(point).distance(position);
    let within_reach =
        scene.document.points(side).filter(|(_, point)| distance(*point) <= theme::GRAB_RADIUS);
    within_reach.min_by(|(_, a), (_, b)| distance(*a).total_cmp(&distance(*b)))
}

fn zoom(ui: &Ui, response: &Response, shown: &mut Shown, frame: Frame) {
    if let Some((at, factor)) = zoom_asked(ui, response) {
        let transform = shown.view.transform(frame, response.rect);
        shown.view.zoom(&transform, frame, at, factor);
    }
}

/// Carries a drag on.
fn follow(ui: &Ui, drag: &Drag, shown: &mut Shown, transform: &Transform, commands: &mut Vec<Command>) {
    let Some(position) = ui.input(|input| input.pointer.latest_pos()) else { return };
    let delta = position - drag.origin;
    match drag.what {
        Dragged::Point(at, start) => {
            let moved = Vector::new(f64::from(delta.x), f64::from(delta.y)) / transform.scale;
            commands.push(Command::Drag(at, start + moved));
        }
        Dragged::View(start) => shown.view.pan(transform, shown.picture.frame(), start, delta),
    }
}

/// The area of a pane, for layout.
pub fn halves(rect: Rect) -> [Rect; 2] {
    let (left, right) = rect.split_left_right_at_fraction(0.5);
    let half = theme::GAP;
    [left.with_max_x(left.max.x - half), right.with_min_x(right.min.x + half)]
}
