//! Messages over the images.

use egui::{Align, Align2, Area, Frame, Id, Label, Layout, Margin, Order, Rect, RichText, Stroke, vec2};

use crate::app::model::messages::{Message, MessageKind};
use crate::app::model::{Command, Model};
use crate::app::view::theme;

/// Distance from the top of a button to its text, screen points.
const BESIDE_BUTTONS: f32 = 4.0;

/// Shows the messages over the top of the images, so that the layout does not move.
pub fn show(ctx: &egui::Context, area: Rect, model: &Model, commands: &mut Vec<Command>) {
    let shown: Vec<&Message> = model.messages.on_top().collect();
    if shown.is_empty() {
        return;
    }
    Area::new(Id::unique("messages"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(area.center_top() + vec2(0.0, 32.0))
        .show(ctx, |ui| {
            let palette = theme::palette(ui.visuals());
            let width = (area.width() - 64.0).clamp(200.0, 720.0);
            for message in shown {
                let (fill, edge) = match message.kind {
                    MessageKind::Problem | MessageKind::OfPair | MessageKind::Unprotected => {
                        (palette.message_fill, palette.bad)
                    }
                    MessageKind::Replace => (ui.visuals().panel_fill, palette.caution),
                    MessageKind::Answer | MessageKind::Taken => (ui.visuals().panel_fill, palette.accent),
                    MessageKind::Done => (ui.visuals().panel_fill, palette.good),
                };
                Frame::new()
                    .fill(fill)
                    .stroke(Stroke::new(1.0, edge))
                    .corner_radius(8.0)
                    .shadow(ui.visuals().popup_shadow)
                    .inner_margin(Margin::symmetric(14, 10))
                    .show(ui, |ui| {
                        ui.set_width(width);
                        // A centred layout would take all the height there is.
                        let row = Layout::right_to_left(Align::Min);
                        ui.allocate_ui_with_layout(vec2(width, 0.0), row, |ui| {
                            let (close, what) = message.kind.close();
                            if ui.button(close).on_hover_text(what).clicked() {
                                commands.push(Command::Dismiss(message.number));
                            }
                            // The layout runs from the right; the first action belongs at the left.
                            for action in message.actions.iter().rev() {
                                let button = ui.button(action.label);
                                if button.on_hover_text(action.command.tooltip()).clicked() {
                                    commands.push(action.command.clone());
                                }
                            }
                            ui.with_layout(Layout::top_down(Align::Min), |ui| {
                                // Aligns the first line with the text of the buttons.
                                ui.add_space(BESIDE_BUTTONS);
                                ui.add(Label::new(RichText::new(&message.text)).wrap());
                            });
                        });
                    });
            }
            if model.messages.below() > 0 {
                let text = format!("and {} more below", model.messages.below());
                Frame::new()
                    .fill(ui.visuals().panel_fill)
                    .corner_radius(8.0)
                    .inner_margin(Margin::symmetric(14, 4))
                    .show(ui, |ui| ui.label(text));
            }
        });
}
