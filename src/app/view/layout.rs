//! Layout of the window.

use egui::{Context, Frame, Margin, Panel, Rect, Ui, UiBuilder, Vec2, vec2};

use super::capture::WantedView;
use super::dialogs::Dialogs;
use super::panes::{ImagePane, halves, scene};
use super::{panels, theme};
use crate::app::model::dock::{DockEdge, Placement, placed};
use crate::app::model::open_pair::Hover;
use crate::app::model::pane_view::PaneView;
use crate::app::model::{Command, Model, Side, StageId};
use crate::geometry::Frame as FrameSize;

/// State of the screen outside the model: panes, dialogs and the screenshot in progress.
pub struct View {
    pub panes: [ImagePane; 2],
    pub dialogs: Dialogs,
    pub capture: Option<WantedView>,
    /// Area of both images in the window, screen points.
    pub images: Option<Rect>,
    /// Arrangement of dock and pictures in the last frame.
    pub placement: Option<Placement>,
    /// Sizes of the pictures that were arranged.
    arranged: Option<[FrameSize; 2]>,
    title: String,
    /// Whether a dialog was open in the last frame.
    pub had_dialog: bool,
}

impl Default for View {
    fn default() -> Self {
        Self {
            panes: Side::BOTH.map(ImagePane::new),
            dialogs: Dialogs::default(),
            capture: None,
            images: None,
            placement: None,
            arranged: None,
            title: String::new(),
            had_dialog: false,
        }
    }
}

/// Closes the tooltip of a button of the window. A tooltip stays open while the cursor rests on its button, also below
/// a dialog. One layer shows one tooltip in a frame, so an invisible one takes its place.
fn close_tooltips(ui: &Ui) {
    let (id, nowhere) = (egui::Id::unique("no tooltip"), Rect::from_min_size(egui::Pos2::ZERO, Vec2::ZERO));
    let mut tooltip = egui::Tooltip::always_open(ui.ctx().clone(), ui.layer_id(), id, nowhere);
    tooltip.popup = tooltip.popup.frame(Frame::NONE);
    tooltip.show(|_| {});
}

impl View {
    /// Draws the window and collects the resulting commands. Returns the image position under the
    /// cursor.
    pub fn draw(&mut self, ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> Option<Hover> {
        let views = self.panes.each_ref().map(ImagePane::view);
        let hover = self.draw_all(ui, model, commands);
        // Alt moves one view alone.
        let alone = ui.input(|input| input.modifiers.alt);
        if model.open.rectified.is_none() {
            panels::tabs::forget_textures(ui.ctx());
        }
        for side in Side::BOTH {
            if !alone && self.panes[side.index()].view() != views[side.index()] {
                self.link(model, side);
            }
        }
        hover
    }

    /// Makes the other image show the same part of the scene as `leader`, if the views are linked.
    pub fn link(&mut self, model: &Model, leader: Side) {
        if !model.look.linked {
            return;
        }
        let [left, right] = &mut self.panes;
        let (leading, following) = match leader {
            Side::Left => (left, right),
            Side::Right => (right, left),
        };
        following.follow(leading);
        let views = leading.view().zip(following.view()).filter(|(view, _)| !view.fits());
        if let Some((from, mut to)) = views
            && let Some(pictures) = &model.open.pictures
            && let Some(point) = pictures[leader.index()].point(from.centre)
            && let Some(matched) = model.matched(leader, point)
        {
            let other = &pictures[leader.other().index()];
            to.centre = other.pixel(matched).unwrap_or(to.centre);
            to.keep_in_sight(other.shown().frame());
            following.set_view(to);
        }
    }

    /// Returns the visible part of each image.
    pub fn views(&self) -> Option<[PaneView; 2]> {
        let [left, right] = self.panes.each_ref().map(ImagePane::view);
        Some([left?, right?])
    }

    /// Ends any drag. Returns whether a point was dragged.
    pub fn let_go(&mut self) -> bool {
        self.panes.iter_mut().any(ImagePane::let_go)
    }

    pub fn name_window(&mut self, ctx: &Context, title: String) {
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    fn draw_all(&mut self, ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> Option<Hover> {
        let ctx = ui.ctx().clone();
        if std::mem::replace(&mut self.had_dialog, self.dialogs.is_open()) != self.dialogs.is_open()
            || self.dialogs.shortcuts
        {
            close_tooltips(ui);
        }
        let bar = |ui: &Ui| Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(8, 2));
        if !model.open.alone {
            Panel::top("top bar")
                .frame(bar(ui))
                .resizable(false)
                .exact_size(theme::TOP_BAR)
                .show(ui, |ui| panels::top_bar(ui, model, commands));
            Panel::bottom("status")
                .frame(bar(ui))
                .resizable(false)
                .exact_size(theme::STATUS_BAR)
                .show(ui, |ui| panels::status(ui, model, commands));
        }
        let room = ui.available_rect_before_wrap();
        let has_timeline = model.document.pictures.is_some() && !model.open.alone;
        let timeline = if has_timeline { panels::timeline::height(ctx.content_rect().height()) } else { 0.0 };
        let (dock, mut stage) = self.split(&ctx, room, timeline, model);
        if has_timeline {
            let (rest, place) = stage.split_top_bottom_at_y(stage.max.y - timeline);
            let mut inside = ui.new_child(UiBuilder::new().max_rect(place).id_salt("timeline"));
            panels::timeline::show(&mut inside, place, model, commands);
            stage = rest;
        }
        if let Some(dock) = dock {
            let edge = self.placement.map_or(DockEdge::Bottom, |placement| placement.edge);
            let mut inside = ui.new_child(UiBuilder::new().max_rect(dock).id_salt("dock"));
            panels::dock::show(&mut inside, dock, edge, model, commands);
        }
        let hover = self.stage(ui, stage, model, commands);
        if self.dialogs.is_open() {
            // A press beside a dialog must not reach the window behind it.
            ui.interact(ui.max_rect(), egui::Id::unique("behind a dialog"), egui::Sense::click_and_drag());
        }
        // Nothing may cover the images in a screenshot.
        if self.capture.is_none() {
            panels::messages(&ctx, stage, model, commands);
        }
        self.dialogs.show(&ctx, model, commands);
        self.images = Some(stage);
        hover
    }

    /// Splits the room below the bars into dock and stage.
    fn split(&mut self, ctx: &Context, room: Rect, timeline: f32, model: &Model) -> (Option<Rect>, Rect) {
        let window = ctx.content_rect().size();
        let look = (&model.look.dock, model.look.stacked);
        let size = |v: Vec2| [v.x, v.y];
        // Other pictures are arranged afresh.
        let originals = self.originals(model);
        if originals.is_some() && std::mem::replace(&mut self.arranged, originals) != originals {
            self.placement = None;
        }
        // The arrangement is kept while pictures load.
        let frames = originals.or(self.arranged).unwrap_or([FrameSize::new(4000, 3000); 2]);
        let beside_timeline = room.size() - vec2(0.0, timeline);
        self.placement = Some(placed(size(window), size(beside_timeline), frames, look, self.placement));
        let Some(Placement { edge, size, .. }) = self.placement.filter(|_| !model.open.alone) else {
            return (None, room);
        };
        let size = match edge {
            DockEdge::Bottom if model.look.dock.folded => panels::dock::FOLDED,
            // The strip of a folded dock is always at the bottom, where its sentence has room.
            DockEdge::Right if model.look.dock.folded => {
                let (stage, dock) = room.split_top_bottom_at_y(room.max.y - panels::dock::FOLDED);
                return (Some(dock), stage);
            }
            _ => size,
        };
        let (stage, dock) = match edge {
            DockEdge::Bottom => room.split_top_bottom_at_y((room.max.y - size).max(room.min.y)),
            DockEdge::Right => room.split_left_right_at_x((room.max.x - size).max(room.min.x)),
        };
        (Some(dock), stage)
    }

    /// Returns the sizes of the pictures as they are turned on the screen.
    fn originals(&self, model: &Model) -> Option<[FrameSize; 2]> {
        let frames = model.document.pictures.as_ref()?.each_ref().map(|picture| picture.frame);
        let turned =
            |k: usize| self.panes[k].view().map_or(frames[k], |view| view.turn.turned_frame(frames[k]));
        Some([turned(0), turned(1)])
    }

    /// Shows the pictures. Returns the image position under the cursor.
    fn stage(
        &mut self,
        ui: &mut Ui,
        area: Rect,
        model: &Model,
        commands: &mut Vec<Command>,
    ) -> Option<Hover> {
        let stacked = self.placement.is_some_and(|placement| placement.stacked);
        ui.painter().rect_filled(area, 0.0, theme::palette(ui.visuals()).canvas);
        if model.stage() == StageId::Rectified {
            let mut inside = ui.new_child(UiBuilder::new().max_rect(area).id_salt("rectified"));
            panels::tabs::rectified::show_pictures(&mut inside, model, commands);
            return None;
        }
        if model.stage() == StageId::Scene {
            let mut inside = ui.new_child(UiBuilder::new().max_rect(area).id_salt("scene"));
            scene::show(&mut inside, &mut self.panes, model, commands);
            return None;
        }
        let mut hover = None;
        let places = halves(area, stacked);
        for (pane, rect) in self.panes.iter_mut().zip(places) {
            let mut child = ui.new_child(UiBuilder::new().max_rect(rect).id_salt(pane.side().index()));
            hover = pane.show(&mut child, model, commands).or(hover);
        }
        hover
    }
}
