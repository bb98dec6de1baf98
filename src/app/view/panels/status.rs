//! The status bar: position and intensity under the cursor, and the progress of an export.

use egui::{Align, Layout, RichText, Ui};

use super::{busy, command_button};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::rectified::RectifiedCommand;
use crate::evaluate::Protocol;

/// Approximate width of the mouse hints, screen points.
const ROOM_FOR_HINTS: f32 = 360.0;

/// Shows the bar.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let under =
            model.open.hover.and_then(|hover| Some((hover, model.intensity_at(hover.side, hover.point)?)));
        let text = match under {
            Some((hover, intensity)) => format!(
                "{:<5}  x {:8.2}   y {:8.2}   intensity {intensity:5.1}",
                hover.side.name(),
                hover.point.x,
                hover.point.y,
            ),
            None => String::new(),
        };
        let text = RichText::new(text);
        ui.label(if model.open.hover.is_some() { text.monospace() } else { text.weak() });
        if let Some(done) = model.open.done.text() {
            ui.separator();
            ui.add(egui::Label::new(done).truncate());
        }
        if let Some(trial) = model.document.trial {
            let protocol = match trial.protocol {
                Protocol::Paper => "as in the paper",
                _ => "well-posed",
            };
            ui.separator();
            ui.label(format!("Random trial, {protocol}, seed {}", trial.seed)).on_hover_text(
                "The estimate uses true matches as point pairs. The first trial of epiline evaluate with \
                 this seed uses the same ones.",
            );
        }
        if let Some(progress) = model.activity.writing {
            ui.separator();
            busy::show(ui);
            ui.label(format!("Export: {}, {} of {}", progress.what, progress.done, progress.all));
            command_button(ui, RectifiedCommand::StopExport.into(), true, commands);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.available_width() > ROOM_FOR_HINTS {
                ui.weak("Scroll: zoom     Drag: move     Double click: fit     ?: all keys");
            }
        });
    });
}
