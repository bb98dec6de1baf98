//! The rectified pair: both images redrawn so that corresponding points are in the same row, with the measures of how
//! well that went.

mod figures;
mod pictures;
mod sheet;

use egui::{RichText, Ui, UiBuilder, Vec2, vec2};

use super::super::{busy, command_button};
use super::{Tab, empty};
use crate::app::command::Command;
use crate::app::rectified::RectifiedCommand;
use crate::app::scene::Scene;
use crate::app::theme;
use crate::rectify::{Method, RectifyError};

/// Registered in [`super::TABS`].
pub const TAB: Tab = Tab {
    title: "Rectified",
    tooltip: "Both images redrawn so that corresponding points are in the same row.",
    inspects: false,
    compares: false,
    rectifies: true,
    tools,
    show,
};

/// Width of the figures beside the pictures, screen points.
const FIGURES: f32 = 316.0;
/// Half of the space between the pictures and the figures.
const GAP: Vec2 = vec2(theme::GAP / 2.0, 3.0);
/// Height of the figures below the pictures.
const FIGURES_BELOW: f32 = 156.0;
/// A panel as high as this has the figures below the pictures, which are wider than high.
const HIGH: f32 = 340.0;

fn tools(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let can_export = scene.shown().is_some() && scene.writing.is_none();
    command_button(ui, Command::Rectified(RectifiedCommand::ShowExport), can_export, commands);
    if scene.rectifying {
        busy::show(ui);
    }
}

fn show(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let Some(rectified) = scene.rectified else {
        let text = if scene.rectifying {
            "The images are being rectified."
        } else if scene.shown().is_some() {
            "These images could not be rectified. Another method, or other point pairs, may help."
        } else if scene.document.pictures.is_some() {
            "Both images, redrawn so that corresponding points are in the same row, appear here once there are enough \
             point pairs. Stereo matching needs them like this, and a wrong geometry shows at once: things in the two \
             pictures are not at the same height then."
        } else {
            "The rectified pair appears here. Open two images and click point pairs."
        };
        empty(ui, text);
        return;
    };
    match &rectified.outcome {
        Err(error) => failure(ui, scene, error, commands),
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
                    pictures::show(ui, scene, drawn, commands);
                });
            }
            ui.scope_builder(UiBuilder::new().max_rect(figures).id_salt("figures"), |ui| {
                figures::show(ui, below, scene, rectified, drawn, commands);
            });
        }
    }
}

/// Why there is no rectified pair, and what to do.
fn failure(ui: &mut Ui, scene: &Scene, error: &RectifyError, commands: &mut Vec<Command>) {
    ui.add_space(8.0);
    let color = theme::palette(ui.visuals()).caution;
    ui.label(RichText::new(format!("{}.", sentence(&error.to_string()))).color(color));
    if scene.document.rectification == Method::Planar {
        let polar = ui.button("Use the polar method");
        super::finish_button(
            ui,
            polar,
            Command::Rectified(RectifiedCommand::SetMethod(Method::Polar)),
            commands,
        );
    }
    ui.add_space(6.0);
    ui.horizontal(|ui| figures::method_chooser(ui, scene, commands));
}

/// The text with a capital letter.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
