//! The last step: the fit to patches, and what the whole computation took.

use egui::{Grid, Label, RichText, ScrollArea, Ui};

use crate::app::model::Model;
use crate::app::model::computation::Freshness;
use crate::app::model::step::{StepProgress, progress, result_text};
use crate::app::view::theme;
use crate::estimate::Stage;

/// Width of one column for the stage, its state and its result, screen points.
const ROOM_FOR_ALL: f32 = 420.0;

/// Shows what each stage of the computation found and how long it took.
pub fn show(ui: &mut Ui, model: &Model) {
    ScrollArea::vertical().id_salt("stages").auto_shrink([false, false]).show(ui, |ui| {
        if ui.available_width() < ROOM_FOR_ALL {
            for stage in Stage::ALL {
                ui.horizontal(|ui| {
                    ui.label(stage.label());
                    state(ui, stage, model);
                });
                if let Some(text) = result_text(stage, &model.document, &model.open.computation) {
                    ui.add(Label::new(RichText::new(text).weak()).wrap());
                }
            }
            return;
        }
        let rows = Grid::new("stages").num_columns(3).spacing([12.0, 2.0]).min_row_height(theme::ROW - 3.0);
        rows.show(ui, |ui| {
            for stage in Stage::ALL {
                ui.label(stage.label());
                state(ui, stage, model);
                ui.weak(result_text(stage, &model.document, &model.open.computation).unwrap_or_default());
                ui.end_row();
            }
        });
    });
}

/// Shows the state of a stage, or how long it took.
fn state(ui: &mut Ui, stage: Stage, model: &Model) {
    let color = theme::palette(ui.visuals());
    match progress(stage, &model.open.computation) {
        StepProgress::Waiting if is_finished(model) => ui.weak("not needed"),
        StepProgress::Waiting => ui.weak("waiting"),
        StepProgress::Running => ui.label("running"),
        StepProgress::Done(None) => ui.weak("not needed"),
        StepProgress::Done(Some(seconds)) => ui.label(duration(seconds)),
        StepProgress::Stopped => ui.colored_label(color.caution, "stopped"),
        StepProgress::Failed => ui.colored_label(color.bad, "failed"),
    };
}

fn is_finished(model: &Model) -> bool {
    matches!(model.open.computation.result(), Some((_, Freshness::Final)))
}

/// Writes a duration with a suitable unit.
pub fn duration(seconds: f64) -> String {
    let ms = seconds * 1000.0;
    if ms < 9.95 {
        format!("{ms:.1} ms")
    } else if ms < 999.5 {
        format!("{ms:.0} ms")
    } else {
        format!("{seconds:.2} s")
    }
}
