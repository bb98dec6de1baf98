//! The last step: the fit to patches, and what the whole computation took.

use egui::{Grid, Label, RichText, Ui};

use crate::app::model::Model;
use crate::app::model::computation::Freshness;
use crate::app::model::step::{StepProgress, progress, result_text};
use crate::app::view::theme;
use crate::estimate::Stage;

/// Shows what each stage of the computation found and how long it took.
pub fn show(ui: &mut Ui, model: &Model) {
    let computation = &model.open.computation;
    Grid::new("stages").num_columns(3).spacing([12.0, 2.0]).min_row_height(theme::ROW - 3.0).show(ui, |ui| {
        for stage in Stage::ALL {
            ui.label(stage.label());
            let color = theme::palette(ui.visuals());
            match progress(stage, computation) {
                StepProgress::Waiting if is_finished(model) => ui.weak("not needed"),
                StepProgress::Waiting => ui.weak("waiting"),
                StepProgress::Running => ui.label("running"),
                StepProgress::Done(None) => ui.weak("not needed"),
                StepProgress::Done(Some(seconds)) => ui.label(duration(seconds)),
                StepProgress::Stopped => ui.colored_label(color.caution, "stopped"),
                StepProgress::Failed => ui.colored_label(color.bad, "failed"),
            };
            let text = result_text(stage, &model.document, computation).unwrap_or_default();
            ui.add(Label::new(RichText::new(text).weak()).truncate());
            ui.end_row();
        }
    });
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
