//! The legend of the overlays below the images. A click on an entry shows or hides the overlay.

use egui::{Button, RichText, Ui, vec2};

use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::view::panes::overlays::OVERLAYS;

/// Shows the legend.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(3.0, 0.0);
        ui.spacing_mut().button_padding = vec2(5.0, 1.0);
        ui.spacing_mut().interact_size.y = 20.0;
        for overlay in OVERLAYS.iter().filter(|overlay| model.offers(overlay.id)) {
            let (name, shown) = (overlay.id.name(), model.look.shows(overlay.id));
            let text = RichText::new(format!("      {name}")).size(13.0);
            let text = if shown { text } else { text.weak() };
            let entry = ui.add(Button::selectable(false, text));
            let swatch = egui::Rect::from_center_size(
                egui::pos2(entry.rect.min.x + 13.0, entry.rect.center().y),
                vec2(11.0, 11.0),
            );
            if shown {
                ui.painter().rect_filled(swatch, 3.0, overlay.color);
                // The colour alone does not show on or off: some swatches resemble the panel.
                let tick = [vec2(0.22, 0.52), vec2(0.42, 0.72), vec2(0.78, 0.28)];
                let tick = tick.map(|at| swatch.min + at * swatch.width());
                ui.painter().line(tick.to_vec(), egui::Stroke::new(1.5, egui::Color32::BLACK));
            }
            let stroke = egui::Stroke::new(1.0, ui.visuals().weak_text_color());
            ui.painter().rect_stroke(swatch, 3.0, stroke, egui::StrokeKind::Inside);
            let label = format!("Show {name}");
            entry.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, shown, &label));
            if entry.on_hover_text(overlay.tooltip).clicked() {
                commands.push(Command::ToggleOverlay(overlay.id));
            }
        }
    });
}
