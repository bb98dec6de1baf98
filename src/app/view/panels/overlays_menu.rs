//! The menu of the overlays and of the view. A ticked overlay stays on; the others appear with their
//! step or tab. A swatch marks what is drawn now.

use egui::{RichText, ScrollArea, Sense, Ui, vec2};

use super::dialog::named;
use super::finish_button;
use super::icons::menu_button;
use crate::app::model::dock::DockEdge;
use crate::app::model::ids::OverlayGroup;
use crate::app::model::{Command, Model, OverlayId};
use crate::app::view::panes::overlays::OVERLAYS;

pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let menu = menu_button(ui, RichText::new("Overlays"), None, |ui| {
        let room = (ui.ctx().content_rect().height() - 80.0).max(100.0);
        ScrollArea::vertical()
            .max_height(room)
            .min_scrolled_height(room)
            .show(ui, |ui| content(ui, model, commands));
    });
    named(menu, "Overlays").on_hover_text("Choose what is drawn over the pictures, and how they are shown.");
}

fn content(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.spacing_mut().interact_size.y = 20.0;
    for group in OverlayGroup::ALL {
        ui.weak(group.title());
        let of_group = |id: OverlayId| id.group() == group && model.offers(id);
        for overlay in OVERLAYS.iter().filter(|overlay| of_group(overlay.id)) {
            ui.horizontal(|ui| {
                let mut kept = model.look.overlays[overlay.id as usize];
                // At the start, the dock has no tabs.
                let by_tab = !kept && model.look.shows(overlay.id) && !model.is_at_start();
                let (swatch, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
                if kept || by_tab {
                    ui.painter().rect_filled(swatch, 2.0, overlay.color);
                }
                let stroke = egui::Stroke::new(1.0, ui.visuals().weak_text_color());
                ui.painter().rect_stroke(swatch, 2.0, stroke, egui::StrokeKind::Inside);
                let name = overlay.id.name();
                let entry = ui.checkbox(&mut kept, name);
                let label = format!("Show {name}");
                entry.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, kept, &label));
                if entry.on_hover_text(overlay.tooltip).clicked() {
                    commands.push(Command::ToggleOverlay(overlay.id));
                }
                if by_tab {
                    ui.weak("shown by the open tab")
                        .on_hover_text("Goes with the tab or step. Tick it to keep it.");
                }
            });
        }
        ui.add_space(3.0);
    }
    ui.weak("View");
    let look = &model.look;
    for (command, mut on) in
        [(Command::ToggleLink, look.linked), (Command::ToggleStacked, look.stacked.unwrap_or(false))]
    {
        let entry = ui.checkbox(&mut on, command.name());
        finish_button(ui, entry, command, commands);
    }
    ui.horizontal(|ui| {
        ui.weak("Dock");
        for (edge, name) in
            [(None, "Auto"), (Some(DockEdge::Bottom), "Bottom"), (Some(DockEdge::Right), "Right")]
        {
            let entry = ui.selectable_label(look.dock.edge == edge, name);
            finish_button(ui, entry, Command::PlaceDock(edge), commands);
        }
    });
}
