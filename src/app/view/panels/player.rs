//! The player of two sequences, in the place of the timeline: playback, frame, motion and time offset.

use egui::{Align, Button, DragValue, Layout, Slider, Ui};

use super::{busy, command_button, finish_button};
use crate::app::model::recording::PlayerCommand;
use crate::app::model::{Command, Model};

/// Width kept free beside the slider, screen points.
const BESIDE: f32 = 40.0;

pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let (Some(playable), Some([left, right]), Some(synchronised)) =
        (model.playable(), model.shown_frames(), model.synchronised())
    else {
        return;
    };
    ui.horizontal_centered(|ui| {
        let playing = model.open.player.playing;
        let play =
            ui.add(Button::new(if playing { "Pause" } else { "Play" }).min_size(egui::vec2(52.0, 0.0)));
        finish_button(ui, play, PlayerCommand::TogglePlay.into(), commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            offset(ui, model, synchronised.offset, commands);
            ui.separator();
            let marked = model.open.player.silhouettes;
            let moving = ui.add(Button::selectable(marked, "Show motion").frame_when_inactive(true));
            finish_button(ui, moving, PlayerCommand::ToggleSilhouettes.into(), commands);
            let count = synchronised.recordings[0].sequence.len();
            let text = if left == right {
                format!("Frame {left} of {count}")
            } else {
                format!("Frames {left} and {right} of {count}")
            };
            ui.label(text).on_hover_text(
                "The frame of the left sequence, counted from 0, and the frame of the right sequence taken \
                 at the same time.",
            );
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.spacing_mut().slider_width = (ui.available_width() - BESIDE).max(60.0);
                let mut frame = left;
                let slider = ui.add(Slider::new(&mut frame, playable).show_value(false));
                slider.widget_info(|| egui::WidgetInfo::slider(true, left as f64, "Frame"));
                if frame != left {
                    commands.push(PlayerCommand::Seek(frame).into());
                }
            });
        });
    });
}

/// Shows the time offset, from right to left.
fn offset(ui: &mut Ui, model: &Model, offset: i32, commands: &mut Vec<Command>) {
    if model.activity.aligning {
        busy::show(ui);
    }
    command_button(ui, PlayerCommand::FindOffset.into(), !model.activity.aligning, commands);
    let mut wanted = offset;
    let field = ui.add(DragValue::new(&mut wanted).speed(0.1).suffix(" frames"));
    let label = ui.label("Offset");
    if wanted != offset {
        commands.push(PlayerCommand::SetOffset(wanted).into());
        if !field.dragged() {
            commands.push(Command::EndDrag);
        }
    }
    if field.drag_stopped() {
        commands.push(Command::EndDrag);
    }
    field.labelled_by(label.id).on_hover_text(
        "Frame k of the left sequence was taken at the same time as frame k + offset of the right one.",
    );
}
