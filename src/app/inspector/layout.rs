//! Where everything is in the window.

use egui::{CentralPanel, Frame, Margin, Panel, Rect, Ui, UiBuilder};

use super::Inspector;
use crate::app::command::Command;
use crate::app::document::Side;
use crate::app::panels::tabs::TABS;
use crate::app::panels::{
    self, CommandPalette, ExportDialog, FileExport, OpenDialog, ReadingDialog, RelocateDialog, SaveDialog,
};
use crate::app::panes::{ImagePane, halves};
use crate::app::scene::Hover;

/// Windows lower than this do without the legend, screen points.
const ROOM_FOR_LEGEND: f32 = 620.0;

/// What changes while it is drawn, apart from the state that everything else reads.
struct Drawing {
    panes: [ImagePane; 2],
    open_dialog: OpenDialog,
    save_dialog: Option<SaveDialog>,
    relocate_dialog: Option<RelocateDialog>,
    export_dialog: ExportDialog,
    file_export: FileExport,
    reading_dialog: Option<ReadingDialog>,
    palette: CommandPalette,
    shortcuts_open: bool,
}

impl Inspector {
    /// Draws the window and collects what it was asked for.
    pub(super) fn draw(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let mut drawing = Drawing {
            panes: std::mem::replace(&mut self.panes, Side::BOTH.map(ImagePane::new)),
            open_dialog: std::mem::take(&mut self.open_dialog),
            save_dialog: self.save_dialog.take(),
            relocate_dialog: self.relocate_dialog.take(),
            export_dialog: std::mem::take(&mut self.export_dialog),
            file_export: std::mem::take(&mut self.file_export),
            reading_dialog: self.reading_dialog.take(),
            palette: std::mem::take(&mut self.palette),
            shortcuts_open: self.shortcuts_open,
        };
        let views = drawing.panes.each_ref().map(ImagePane::view);
        let (area, hover) = self.draw_all(ui, &mut drawing, commands);
        self.exchange.images = Some(area);
        // Matching keeps a core busy while a point is dragged: it waits until something shows it.
        let scene = self.scene();
        let wanted = !self.focus.pins().is_empty()
            || scene.tab.is_some_and(|tab| TABS[tab].inspects)
            || drawing.file_export.open;
        self.inspected = scene.inspected().filter(|_| wanted).map(|inspected| inspected.lines);
        self.panes = drawing.panes;
        self.open_dialog = drawing.open_dialog;
        self.save_dialog = drawing.save_dialog;
        self.relocate_dialog = drawing.relocate_dialog;
        self.export_dialog = drawing.export_dialog;
        self.file_export = drawing.file_export;
        self.reading_dialog = drawing.reading_dialog;
        self.palette = drawing.palette;
        self.shortcuts_open = drawing.shortcuts_open;
        for side in Side::BOTH {
            if self.panes[side.index()].view() != views[side.index()] {
                self.link_views(side);
            }
        }
        if hover != self.hover {
            // Written in this frame, drawn in the next.
            self.hover = hover;
            ui.ctx().request_repaint();
        }
    }

    /// Also says where the images are, and what is under the cursor there.
    fn draw_all(
        &self,
        ui: &mut Ui,
        drawing: &mut Drawing,
        commands: &mut Vec<Command>,
    ) -> (Rect, Option<Hover>) {
        let ctx = ui.ctx().clone();
        let bar = |ui: &Ui| Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(12, 7));
        let scene = self.scene();
        let height = ctx.content_rect().height();
        Panel::top("toolbar").frame(bar(ui)).show(ui, |ui| panels::toolbar(ui, &scene, commands));
        Panel::top("guide").frame(bar(ui)).show(ui, |ui| {
            ui.set_min_height(28.0);
            panels::guide_bar(ui, &scene, commands);
        });
        Panel::bottom("status").frame(bar(ui)).show(ui, |ui| {
            let pictures = self.pictures.as_ref();
            let pictures = pictures.map(|p| p.each_ref().map(|opened| opened.picture.as_ref()));
            panels::status(ui, &scene, pictures, commands);
        });
        Panel::right("side")
            .frame(bar(ui))
            .resizable(true)
            .default_size(300.0)
            .size_range(240.0..=480.0)
            .show(ui, |ui| panels::side::show(ui, &scene, commands));
        if scene.tab.is_some() {
            // Each of the two heights is remembered by itself.
            let (name, size, largest) = if scene.look.tabs_enlarged {
                ("enlarged tabs", height * 0.64, height * 0.75)
            } else {
                ("tabs", (height * 0.29).clamp(130.0, 320.0), height * 0.6)
            };
            Panel::bottom(name)
                .frame(bar(ui))
                .resizable(true)
                .default_size(size)
                .size_range(130.0..=largest.max(131.0))
                .show(ui, |ui| {
                    // The panel keeps its height, however little a tab has to show.
                    ui.set_min_height(ui.available_height());
                    panels::tabs::headings(ui, &scene, commands);
                    panels::tabs::chosen(ui, &scene, commands);
                });
        } else {
            Panel::bottom("folded tabs").frame(bar(ui)).show(ui, |ui| {
                panels::tabs::headings(ui, &scene, commands);
            });
        }
        // A small window has better use for the space; the list of commands has every overlay too.
        let enlarged = scene.tab.is_some() && scene.look.tabs_enlarged;
        if scene.document.pictures.is_some() && height > ROOM_FOR_LEGEND && !enlarged {
            let strip = bar(ui).inner_margin(Margin::symmetric(8, 3));
            Panel::bottom("legend").frame(strip).show(ui, |ui| panels::legend(ui, &scene, commands));
        }
        let (area, hover) = CentralPanel::default()
            .frame(bar(ui))
            .show(ui, |ui| {
                let area = ui.available_rect_before_wrap();
                let mut hover = None;
                for (pane, rect) in drawing.panes.iter_mut().zip(halves(area)) {
                    let mut child =
                        ui.new_child(UiBuilder::new().max_rect(rect).id_salt(rect.min.x > area.min.x));
                    hover = pane.show(&mut child, &scene, commands).or(hover);
                }
                (area, hover)
            })
            .inner;
        // Nothing is to be in front of the images in a picture of them.
        if !self.exchange.capturing.is_under_way() {
            panels::messages(&ctx, area, &scene, commands);
        }
        drawing.open_dialog.show(&ctx, &scene, commands);
        if drawing.save_dialog.as_mut().is_some_and(|dialog| !dialog.show(&ctx, commands)) {
            drawing.save_dialog = None;
        }
        if drawing.relocate_dialog.as_mut().is_some_and(|dialog| !dialog.show(&ctx, commands)) {
            drawing.relocate_dialog = None;
        }
        drawing.export_dialog.show(&ctx, commands);
        drawing.file_export.show(&ctx, &scene, commands);
        if drawing.reading_dialog.as_mut().is_some_and(|dialog| !dialog.show(&ctx, commands)) {
            drawing.reading_dialog = None;
        }
        drawing.palette.show(&ctx, &scene, commands);
        if drawing.shortcuts_open {
            panels::shortcuts(&ctx, &mut drawing.shortcuts_open);
        }
        (area, hover)
    }
}
