//! Layout of the window.

use egui::{CentralPanel, Context, Frame, Margin, Panel, Rect, Sense, Ui, UiBuilder};

use super::actions::conditions::has_strip;
use super::capture::ViewCapture;
use super::dialogs::Dialogs;
use super::panels;
use super::panes::{ImagePane, halves};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::document::Side;
use crate::app::model::open_pair::Hover;
use crate::app::model::pane_view::PaneView;

/// Least height of a window with the legend, screen points.
const ROOM_FOR_LEGEND: f32 = 620.0;

/// Height that an enlarged panel leaves for the bars and the images, screen points.
const REST: f32 = 290.0;

/// State of the screen outside the model: panes, dialogs and the screenshot in progress.
pub struct View {
    /// The two images.
    pub panes: [ImagePane; 2],
    /// The dialogs in front of the images.
    pub dialogs: Dialogs,
    /// The screenshot in progress.
    pub capture: ViewCapture,
    /// The thumbnails of the folder.
    pub strip: panels::FilmStrip,
    /// Area of both images in the window, screen points.
    pub images: Option<Rect>,
    title: String,
}

impl Default for View {
    fn default() -> Self {
        Self {
            panes: Side::BOTH.map(ImagePane::new),
            dialogs: Dialogs::default(),
            capture: ViewCapture::default(),
            strip: panels::FilmStrip::default(),
            images: None,
            title: String::new(),
        }
    }
}

impl View {
    /// Draws the window and collects the resulting commands. Returns the image position under the
    /// cursor.
    pub fn draw(&mut self, ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> Option<Hover> {
        let views = self.panes.each_ref().map(ImagePane::view);
        let hover = self.draw_all(ui, model, commands);
        if model.open.rectified.is_none() {
            panels::tabs::forget_textures(ui.ctx());
        }
        for side in Side::BOTH {
            if self.panes[side.index()].view() != views[side.index()] {
                self.link(model, side);
            }
        }
        hover
    }

    /// Makes the other image show the same part as `leader`, if the views are linked.
    pub fn link(&mut self, model: &Model, leader: Side) {
        if model.look.linked {
            let [left, right] = &mut self.panes;
            match leader {
                Side::Left => right.follow(left),
                Side::Right => left.follow(right),
            }
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

    /// Sets the title of the window.
    pub fn name_window(&mut self, ctx: &Context, title: String) {
        if title != self.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    fn draw_all(&mut self, ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) -> Option<Hover> {
        let ctx = ui.ctx().clone();
        let bar = |ui: &Ui| Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(12, 7));
        let height = ctx.content_rect().height();
        Panel::top("toolbar").frame(bar(ui)).show(ui, |ui| panels::toolbar(ui, model, commands));
        Panel::top("guide").frame(bar(ui)).show(ui, |ui| {
            ui.set_min_height(28.0);
            panels::guide_bar(ui, model, commands);
        });
        // An enlarged panel leaves just enough room for the images.
        let enlarged = model.tab().is_some() && model.look.tabs_enlarged;
        let strip = has_strip(model) && !model.look.strip_folded && !enlarged;
        let strip = model.folder().filter(|_| strip);
        let room_for_legend = ROOM_FOR_LEGEND + strip.map_or(0.0, |_| panels::FilmStrip::height(height));
        match strip {
            Some(folder) => {
                let strip = bar(ui).inner_margin(Margin::symmetric(8, 3));
                Panel::top("images of the folder")
                    .frame(strip)
                    .resizable(false)
                    .exact_size(panels::FilmStrip::height(height))
                    .show(ui, |ui| self.strip.show(ui, model, folder, commands));
            }
            None => self.strip.hide(),
        }
        Panel::bottom("status").frame(bar(ui)).show(ui, |ui| {
            panels::status(ui, model, commands);
        });
        if model.look.side_folded {
            let strip = bar(ui).inner_margin(Margin::symmetric(6, 7));
            Panel::right("folded side")
                .frame(strip)
                .resizable(false)
                .exact_size(34.0)
                .show(ui, |ui| panels::side::folded(ui, model, commands));
        } else {
            Panel::right("side")
                .frame(bar(ui))
                .resizable(true)
                .default_size(300.0)
                .size_range(240.0..=480.0)
                .show(ui, |ui| {
                    // A wide child would widen the panel permanently.
                    let area = ui.available_rect_before_wrap();
                    ui.allocate_rect(area, Sense::hover());
                    let mut inside = ui.new_child(UiBuilder::new().max_rect(area));
                    inside.shrink_clip_rect(area);
                    panels::side::show(&mut inside, model, commands);
                });
        }
        if model.tab().is_some() {
            // The two heights are remembered separately.
            let (name, size, largest) = if model.look.tabs_enlarged {
                let largest = (height - REST).max(height * 0.5);
                ("enlarged tabs", largest.min(height * 0.64), largest)
            } else {
                ("tabs", (height * 0.29).clamp(130.0, 320.0), height * 0.6)
            };
            Panel::bottom(name)
                .frame(bar(ui))
                .resizable(true)
                .default_size(size)
                .size_range(130.0..=largest.max(131.0))
                .show(ui, |ui| {
                    // The panel keeps its height even if a tab has little to show.
                    ui.set_min_height(ui.available_height());
                    panels::tabs::headings(ui, model, commands);
                    panels::tabs::chosen(ui, model, commands);
                });
        } else {
            Panel::bottom("folded tabs").frame(bar(ui)).show(ui, |ui| {
                panels::tabs::headings(ui, model, commands);
            });
        }
        // A low window needs the space for the images; the View menu has all overlays, too.
        let wanted = model.document.pictures.is_some() && !model.look.overlays_folded;
        if wanted && height > room_for_legend && !enlarged {
            let strip = bar(ui).inner_margin(Margin::symmetric(8, 3));
            Panel::bottom("legend").frame(strip).show(ui, |ui| panels::legend(ui, model, commands));
        }
        if model.recordings().is_some() {
            Panel::bottom("player").frame(bar(ui)).show(ui, |ui| panels::player(ui, model, commands));
        }
        let (area, hover) = CentralPanel::default()
            .frame(bar(ui))
            .show(ui, |ui| {
                let area = ui.available_rect_before_wrap();
                let mut hover = None;
                for (pane, rect) in self.panes.iter_mut().zip(halves(area, model.look.stacked)) {
                    let mut child =
                        ui.new_child(UiBuilder::new().max_rect(rect).id_salt(rect.min != area.min));
                    hover = pane.show(&mut child, model, commands).or(hover);
                }
                (area, hover)
            })
            .inner;
        // Nothing may cover the images in a screenshot.
        if !self.capture.is_under_way() {
            panels::messages(&ctx, area, model, commands);
        }
        self.dialogs.show(&ctx, model, commands);
        self.images = Some(area);
        hover
    }
}
