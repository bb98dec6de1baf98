//! What went wrong, or is done, a sentence each, until it is dismissed.

use egui::{Align2, Area, Frame, Id, Label, Margin, Order, Rect, RichText, Stroke, vec2};

use crate::app::command::Command;
use crate::app::scene::Scene;
use crate::app::theme;

/// Something the user should read.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Number for [`Command::Dismiss`].
    pub number: u64,
    /// What happened and what to do.
    pub text: String,
    /// Whether something was done that took its time, and nothing went wrong.
    pub good: bool,
    /// What can be done about it at once.
    pub actions: Vec<MessageAction>,
}

/// A button of a message.
#[derive(Debug, Clone, PartialEq)]
pub struct MessageAction {
    /// What the button says.
    pub label: &'static str,
    /// What it does.
    pub command: Command,
}

/// Shows the messages over the top of the images, so that nothing moves under the cursor.
pub fn show(ctx: &egui::Context, area: Rect, scene: &Scene, commands: &mut Vec<Command>) {
    if scene.messages.is_empty() {
        return;
    }
    Area::new(Id::unique("messages"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(area.center_top() + vec2(0.0, 32.0))
        .show(ctx, |ui| {
            let palette = theme::palette(ui.visuals());
            let width = (area.width() - 64.0).clamp(200.0, 720.0);
            for message in scene.messages {
                let (fill, edge) = if message.good {
                    (ui.visuals().panel_fill, palette.good)
                } else {
                    (palette.message_fill, palette.bad)
                };
                Frame::new()
                    .fill(fill)
                    .stroke(Stroke::new(1.0, edge))
                    .corner_radius(8.0)
                    .shadow(ui.visuals().popup_shadow)
                    .inner_margin(Margin::symmetric(14, 10))
                    .show(ui, |ui| {
                        ui.set_width(width);
                        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                            let close = ui.button("Dismiss").on_hover_text("Remove this message.");
                            if close.clicked() {
                                commands.push(Command::Dismiss(message.number));
                            }
                            // From the right: the first one is to stand at the left.
                            for action in message.actions.iter().rev() {
                                let button = ui.button(action.label);
                                if button.on_hover_text(action.command.tooltip()).clicked() {
                                    commands.push(action.command.clone());
                                }
                            }
                            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                                ui.add(Label::new(RichText::new(&message.text)).wrap());
                            });
                        });
                    });
            }
        });
}
