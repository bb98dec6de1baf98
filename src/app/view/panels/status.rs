//! The bar at the bottom: the position under the cursor, a hint, the last action, time and seed.

use egui::{Align, Label, Layout, RichText, Ui};

use super::{busy, command_button};
use crate::app::model::guide::guide;
use crate::app::model::rectified::{RectifiedCommand, RectifiedLayout};
use crate::app::model::{Command, Model, StageId};
use crate::app::view::theme;
use crate::estimate::Preset;

/// What the mouse does, before there is a next step to tell.
const MOUSE: &str = "Scroll zooms · drag pans · double click fits · press ? for all keys";

/// What the mouse does on the scene.
const ORBIT: &str = "Drag turns · scroll zooms · right drag moves · double click fits · click a point to see it in the pictures";

/// What the mouse does on a rectified pair.
const ROWS: &str =
    "Point at a picture to see its line in both · scroll zooms · drag pans · double click fits";

/// What the mouse does on a rectified pair in one picture.
const ROW: &str = "Point at the picture to see its line · scroll zooms · drag pans · double click fits";

pub fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.spacing_mut().interact_size.y = theme::STATUS_BAR - 6.0;
    let small = |text: String| RichText::new(text).size(theme::CAPTION);
    ui.horizontal_centered(|ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(text) = time_and_seed(model) {
                ui.label(small(text).weak());
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let under = model
                    .open
                    .hover
                    .and_then(|hover| Some((hover, model.intensity_at(hover.side, hover.point)?)));
                if let Some((hover, intensity)) = under {
                    let pixel = model.open.pixel(hover.side, hover.point);
                    let side = hover.side.name();
                    let text = format!("{side:<5} {:8.2} {:8.2}  grey {intensity:.1}", pixel.x, pixel.y);
                    ui.label(small(text).monospace()).on_hover_text("Image, x and y in px, grey value.");
                    ui.separator();
                }
                if let Some(text) = model.pointed_in_scene() {
                    ui.label(small(text).monospace()).on_hover_text(
                        "Depth from the left camera; the distance of the cameras is one baseline. Parallax is the \
                         angle between the two rays to the point; with a small angle, depth is uncertain.",
                    );
                    ui.separator();
                }
                if model.activity.loading {
                    busy::show(ui);
                }
                if let Some(progress) = model.activity.writing {
                    busy::show(ui);
                    let text = format!("Export: {}, {} of {}", progress.what, progress.done, progress.all);
                    ui.label(small(text));
                    command_button(ui, RectifiedCommand::StopExport.into(), true, commands);
                    ui.separator();
                }
                let hint = || match model.stage() {
                    StageId::Scene if model.scene().is_some() => ORBIT.to_owned(),
                    StageId::Rectified if model.look.rectified.layout == RectifiedLayout::SideBySide => {
                        ROWS.to_owned()
                    }
                    StageId::Rectified => ROW.to_owned(),
                    StageId::Pictures if model.is_at_start() => MOUSE.to_owned(),
                    StageId::Scene => "Press 5 for the pictures, 6 for the rectified pair".to_owned(),
                    StageId::Pictures => guide(model),
                };
                let text = model.open.done.text().map_or_else(hint, str::to_owned);
                ui.add(Label::new(small(text)).truncate());
            });
        });
    });
}

/// Describes duration and seed of the result.
fn time_and_seed(model: &Model) -> Option<String> {
    if let Some(elapsed) = model.open.computation.elapsed() {
        return Some(format!("{:.0} s so far", elapsed.as_secs_f64()));
    }
    let trace = model.result()?.trace.as_ref()?;
    let preset = match trace.preset {
        Preset::Robust => "robust",
        Preset::Paper => "as published",
    };
    Some(format!(
        "Result {:.2} s, first lines {:.2} s · {preset}, seed {}",
        trace.seconds, trace.first_seconds, trace.seed
    ))
}
