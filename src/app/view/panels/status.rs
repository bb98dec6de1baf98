//! The bar at the bottom: position and intensity under the cursor, and how far an export is.

use egui::{Align, Layout, RichText, Ui};

use super::{busy, command_button};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::rectified::RectifiedCommand;
use crate::evaluate::Protocol;

/// The mouse actions take about as much, screen points.
const ROOM_FOR_HINTS: f32 = 360.0;

/// Shows the bar.
pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let text = match (model.open.hover, &model.open.pictures) {
            (Some(hover), Some(pictures)) => {
                let plane = &pictures[hover.side.index()].picture.gray;
                let frame = plane.frame();
                let pixel = |v: f64, size: usize| (v.round().max(0.0) as usize).min(size.saturating_sub(1));
                let (x, y) = (pixel(hover.point.x, frame.width), pixel(hover.point.y, frame.height));
                format!(
                    "{:<5}  x {:8.2}   y {:8.2}   intensity {:5.1}",
                    hover.side.name(),
                    hover.point.x,
                    hover.point.y,
                    plane.at(x, y)
                )
            }
            _ => "Position and intensity under the cursor".into(),
        };
        let text = RichText::new(text);
        ui.label(if model.open.hover.is_some() { text.monospace() } else { text.weak() });
        if let Some(done) = &model.open.done {
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
                "The pairs of the estimate are true matches: those of the first trial of epiline evaluate with this seed.",
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
