//! The rectified pair: both images redrawn with corresponding points in the same row. The stage has the
//! pictures, the dock their layouts and quality measures.

mod figures;
mod pictures;
mod sheet;

use egui::{Align, Label, Layout, RichText, ScrollArea, Ui};

use super::{busy, empty, finish_button, main_button};
use crate::app::model::rectified::RectifiedCommand;
use crate::app::model::{Command, Model};
use crate::app::view::theme;
use crate::presentation::sentence;
use crate::rectify::{RectifyError, RectifyMethod};

pub use pictures::forget_textures;

pub fn show_pictures(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let drawn = model.open.rectified.as_ref().and_then(|rectified| rectified.outcome.as_ref().ok());
    if let Some(drawn) = drawn {
        pictures::show(ui, model, drawn, commands);
        return;
    }
    let text = match model.open.rectified {
        None => "The images are being rectified",
        Some(_) => "These images could not be rectified. The reason is given below.",
    };
    let area = ui.max_rect();
    ui.painter().rect_filled(area, 0.0, theme::palette(ui.visuals()).canvas);
    let (font, color) = (egui::FontId::proportional(13.0), ui.visuals().weak_text_color());
    ui.painter().text(area.center(), egui::Align2::CENTER_CENTER, text, font, color);
}

/// Width below which the layouts and the button have a row each, screen points.
const ROOM_FOR_ONE_ROW: f32 = 480.0;

fn saving(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let can_export = model.shown().is_some() && model.activity.writing.is_none();
    ui.add_enabled_ui(can_export, |ui| {
        let export = Command::from(RectifiedCommand::ShowExport);
        let button = main_button(ui, export.name());
        finish_button(ui, button, export, commands);
    });
    if model.activity.rectifying {
        busy::show(ui);
    }
}

/// Shows layouts and quality measures in the dock.
pub fn show_figures(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    if ui.available_width() < ROOM_FOR_ONE_ROW {
        ui.horizontal_wrapped(|ui| figures::layout_chooser(ui, model, commands));
        ui.horizontal(|ui| saving(ui, model, commands));
    } else {
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                saving(ui, model, commands);
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    figures::layout_chooser(ui, model, commands);
                });
            });
        });
    }
    let Some(rectified) = model.open.rectified.as_ref() else {
        empty(ui, "The images are being rectified.");
        return;
    };
    ScrollArea::vertical().id_salt("rectified").auto_shrink([false, false]).show(ui, |ui| {
        match &rectified.outcome {
            Err(error) => failure(ui, model, error, commands),
            Ok(drawn) => figures::show(ui, model, rectified, drawn, commands),
        }
    });
}

/// Shows why there is no rectified pair, and how to get one.
fn failure(ui: &mut Ui, model: &Model, error: &RectifyError, commands: &mut Vec<Command>) {
    let color = theme::palette(ui.visuals()).caution;
    let text = RichText::new(format!("{}.", sentence(&error.to_string()))).color(color);
    ui.add(Label::new(text).wrap());
    if model.document.rectification == RectifyMethod::Planar {
        let polar = ui.button("Use the polar method");
        finish_button(ui, polar, RectifiedCommand::SetMethod(RectifyMethod::Polar).into(), commands);
    }
    ui.horizontal(|ui| figures::method_chooser(ui, model, commands));
}
