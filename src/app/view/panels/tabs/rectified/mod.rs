//! The tab of the rectified pair: both images redrawn with corresponding points in the same row,
//! with quality measures.

mod figures;
mod pictures;
mod sheet;

use egui::{RichText, Ui, UiBuilder, Vec2, vec2};

use super::super::{busy, command_button};
use super::{Tab, empty};
use crate::app::model::Model;
use crate::app::model::command::Command;
use crate::app::model::ids::TabId;
use crate::app::model::rectified::RectifiedCommand;
use crate::app::view::theme;
use crate::rectify::{RectifyError, RectifyMethod};

/// Registered in [`super::TABS`].
pub const TAB: Tab = Tab { id: TabId::Rectified, tools, show };

pub use pictures::forget_textures;

/// Width of the column beside the pictures, screen points.
const FIGURES: f32 = 316.0;
/// Half of the space between pictures and column.
const GAP: Vec2 = vec2(theme::GAP / 2.0, 3.0);
/// Height of the strip below the pictures, screen points.
const FIGURES_BELOW: f32 = 156.0;
/// Height from which the panel has the strip below the pictures, screen points.
const HIGH: f32 = 340.0;

fn tools(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let can_export = model.shown().is_some() && model.activity.writing.is_none();
    command_button(ui, RectifiedCommand::ShowExport.into(), can_export, commands);
    if model.activity.rectifying {
        busy::show(ui);
    }
}

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let Some(rectified) = model.open.rectified.as_ref() else {
        let text = if model.activity.rectifying {
            "The images are being rectified."
        } else if model.shown().is_some() {
            "These images could not be rectified. Try another method or other point pairs."
        } else if model.document.pictures.is_some() {
            "Both images, redrawn with corresponding points in the same row, appear here once there are \
             enough point pairs. Stereo matching needs such pictures. A wrong geometry shows at once: the \
             same things are at different heights."
        } else {
            "The rectified pair appears here. Open two images and click point pairs."
        };
        empty(ui, text);
        return;
    };
    match &rectified.outcome {
        Err(error) => failure(ui, model, error, commands),
        Ok(drawn) => {
            let area = ui.available_rect_before_wrap();
            let below = area.height() > HIGH;
            let (pictures, figures) = if below {
                area.split_top_bottom_at_y(area.max.y - FIGURES_BELOW)
            } else {
                area.split_left_right_at_x(area.max.x - FIGURES)
            };
            let (pictures, figures) = (pictures.shrink2(GAP), figures.shrink2(GAP));
            if pictures.width() > 60.0 {
                ui.scope_builder(UiBuilder::new().max_rect(pictures).id_salt("pictures"), |ui| {
                    pictures::show(ui, model, drawn, commands);
                });
            }
            ui.scope_builder(UiBuilder::new().max_rect(figures).id_salt("figures"), |ui| {
                figures::show(ui, below, model, rectified, drawn, commands);
            });
        }
    }
}

/// Shows why there is no rectified pair, and how to get one.
fn failure(ui: &mut Ui, model: &Model, error: &RectifyError, commands: &mut Vec<Command>) {
    ui.add_space(8.0);
    let color = theme::palette(ui.visuals()).caution;
    ui.label(RichText::new(format!("{}.", sentence(&error.to_string()))).color(color));
    if model.document.rectification == RectifyMethod::Planar {
        let polar = ui.button("Use the polar method");
        super::finish_button(ui, polar, RectifiedCommand::SetMethod(RectifyMethod::Polar).into(), commands);
    }
    ui.add_space(6.0);
    ui.horizontal(|ui| figures::method_chooser(ui, model, commands));
}

/// Capitalises the first letter.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
