//! Where everything is in the window.

use egui::{CentralPanel, Frame, Margin, Panel, Ui, UiBuilder};

use super::Inspector;
use crate::app::command::Command;
use crate::app::panels;
use crate::app::panes::halves;
use crate::app::scene::Scene;

impl Inspector {
    /// Draws the window and collects what it was asked for.
    pub(super) fn draw(&mut self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let ctx = ui.ctx().clone();
        let bar = |ui: &Ui| Frame::new().fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(12, 7));
        let scene = Scene {
            document: &self.document,
            computation: &self.computation,
            hover: self.hover,
            focus: &self.focus,
            inspection: self.matcher.latest(),
            tab: self.tabs_open.then_some(self.tab),
            overlays: &self.overlays,
            loading: self.loader.is_busy(),
            has_sample_points: self.show_me.is_some(),
            can_undo_redo: [self.history.can_undo(), self.history.can_redo()],
            messages: &self.messages,
        };
        Panel::top("toolbar").frame(bar(ui)).show(ui, |ui| panels::toolbar(ui, &scene, commands));
        Panel::top("guide").frame(bar(ui)).show(ui, |ui| {
            ui.set_min_height(28.0);
            panels::guide_bar(ui, &scene, commands);
        });
        Panel::bottom("status").frame(bar(ui)).show(ui, |ui| {
            let pictures = self.pictures.as_ref();
            panels::status(ui, &scene, pictures.map(|p| p.each_ref().map(|opened| opened.picture.as_ref())));
        });
        Panel::right("side")
            .frame(bar(ui))
            .resizable(true)
            .default_size(300.0)
            .size_range(240.0..=480.0)
            .show(ui, |ui| panels::side::show(ui, &scene, commands));
        if scene.tab.is_some() {
            Panel::bottom("tabs")
                .frame(bar(ui))
                .resizable(true)
                .default_size(256.0)
                .size_range(130.0..=560.0)
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
        let panes = &mut self.panes;
        let (area, hover) = CentralPanel::default()
            .frame(bar(ui))
            .show(ui, |ui| {
                let area = ui.available_rect_before_wrap();
                let mut hover = None;
                for (pane, rect) in panes.iter_mut().zip(halves(area)) {
                    let mut child =
                        ui.new_child(UiBuilder::new().max_rect(rect).id_salt(rect.min.x > area.min.x));
                    hover = pane.show(&mut child, &scene, commands).or(hover);
                }
                (area, hover)
            })
            .inner;
        panels::messages(&ctx, area, &scene, commands);
        self.open_dialog.show(&ctx, &scene, commands);
        if self.shortcuts_open {
            panels::shortcuts(&ctx, &mut self.shortcuts_open);
        }
        self.inspected = scene.inspected().map(|inspected| inspected.lines);
        if hover != self.hover {
            // Written in this frame, drawn in the next.
            self.hover = hover;
            ctx.request_repaint();
        }
    }
}
