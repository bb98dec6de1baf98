//! The parameters of a step, each with its unit, default and error message.

use egui::{Button, ComboBox, DragValue, Grid, Label, RichText, Ui, Vec2, vec2};

use crate::app::model::command::Command;
use crate::app::view::theme;
use crate::estimate::{ParameterValue, Parameters, Stage};
use crate::presentation::{ShownParameter, shown_parameters};

/// Size of a number field.
const FIELD: Vec2 = vec2(88.0, 22.0);

/// Largest width of a choice.
const LARGEST_CHOICE: f32 = 160.0;
/// Width of the reset button.
const RESET: f32 = 58.0;
/// Space between the columns.
const GAP: f32 = 8.0;
/// Least width of names beside the fields. With less room, names stand above the fields.
const LEAST_NAME: f32 = 80.0;

/// Returns the default parameters of the preset. The measure by which lines are compared is no part
/// of a preset; it depends on the input.
fn defaults(parameters: &Parameters) -> Parameters {
    Parameters { seed: 0, ..parameters.with_preset(parameters.preset) }
}

/// Returns whether a parameter of a step differs from the preset.
pub fn is_any_changed(stage: Stage, parameters: &Parameters) -> bool {
    let defaults = defaults(parameters);
    of(stage).any(|setting| !setting.entry.is_same(parameters, &defaults))
}

fn of(stage: Stage) -> impl Iterator<Item = ShownParameter> {
    shown_parameters().filter(move |setting| setting.entry.stage == stage && !setting.entry.is_expert)
}

/// Shows the parameters of a step. Long names wrap, so that the field and its button stay in the
/// panel. In a narrow panel, both stand below the name.
pub fn show(ui: &mut Ui, stage: Stage, parameters: &Parameters, commands: &mut Vec<Command>) {
    let name = |ui: &mut Ui, setting: &ShownParameter, width: f32| {
        let tooltip = format!("{} {}", setting.tooltip, setting.range_text(parameters.preset));
        let label = ui.scope(|ui| {
            ui.set_width(width);
            ui.add(Label::new(setting.name).wrap())
        });
        (label.inner.on_hover_text(tooltip.as_str()).id, tooltip)
    };
    let width = ui.available_width();
    // Without a changed parameter, no button needs room.
    let beside = if is_any_changed(stage, parameters) { RESET + GAP } else { 0.0 };
    let without_field = beside + GAP;
    let field = (width - without_field - LEAST_NAME).clamp(FIELD.x, LARGEST_CHOICE);
    let room = width - without_field - field;
    if room < LEAST_NAME {
        let field = (width - beside).clamp(FIELD.x, LARGEST_CHOICE);
        for setting in of(stage) {
            let (label, tooltip) = name(ui, &setting, width);
            ui.horizontal(|ui| {
                edit(ui, &setting, parameters, label, &tooltip, field, commands);
                reset(ui, &setting, parameters, commands);
            });
        }
    } else {
        let grid = Grid::new(("parameters", stage.label())).num_columns(3).spacing([GAP, 3.0]);
        grid.min_col_width(0.0).show(ui, |ui| {
            for setting in of(stage) {
                let (label, tooltip) = name(ui, &setting, room);
                edit(ui, &setting, parameters, label, &tooltip, field, commands);
                reset(ui, &setting, parameters, commands);
                ui.end_row();
            }
        });
    }
    let color = theme::palette(ui.visuals()).bad;
    for problem in of(stage).filter_map(|setting| setting.problem(parameters)) {
        ui.add(Label::new(RichText::new(problem).color(color)).wrap());
    }
}

/// Shows the field of a parameter, at most `largest` wide. A whole drag is one step of the history;
/// any other change is a step of its own.
fn edit(
    ui: &mut Ui,
    setting: &ShownParameter,
    parameters: &Parameters,
    label: egui::Id,
    tooltip: &str,
    largest: f32,
    commands: &mut Vec<Command>,
) {
    let mut changed = parameters.clone();
    let (response, is_changed) = match setting.entry.value {
        ParameterValue::Number { range: [least, most], get, set, .. } => {
            let (of_unit, decimals) = (setting.of_unit, setting.decimals);
            let before = get(parameters) / of_unit;
            let mut value = before;
            let speed = (before.abs() / 100.0).max(0.1f64.powi(decimals as i32));
            let field = DragValue::new(&mut value)
                .suffix(setting.unit)
                .speed(speed)
                .fixed_decimals(decimals)
                .min_size(FIELD)
                .update_while_editing(false);
            let response = ui.add(field);
            if response.dragged() {
                // A drag stops at the limits. A typed value outside them is kept and reported.
                value = value.clamp(least / of_unit, most / of_unit);
            }
            // Converting units must not round a limit to a value beyond it.
            let near = |end: f64| (value * of_unit - end).abs() < 1e-9;
            let end = [least, most].into_iter().find(|end| near(*end));
            set(&mut changed, end.unwrap_or(value * of_unit));
            (response, value.to_bits() != before.to_bits())
        }
        ParameterValue::Switch { get, set } => {
            let mut on = get(parameters);
            let response = ui.checkbox(&mut on, "");
            set(&mut changed, on);
            (response, on != get(parameters))
        }
        ParameterValue::Choice { get, set } => {
            let names = setting.choices;
            let before = get(parameters);
            let mut chosen = before;
            // Truncated names can be read in the list.
            let list = ComboBox::from_id_salt(setting.name).width(largest).truncate();
            let shown = ui.scope(|ui| {
                // The list is truncated only at the end of its room.
                ui.set_max_width(largest);
                list.show_index(ui, &mut chosen, names.len(), |k| names[k])
            });
            let response = shown.inner;
            set(&mut changed, chosen);
            (response, chosen != before)
        }
    };
    if is_changed && changed != *parameters {
        set_parameters(setting, changed, commands);
        if !response.dragged() {
            commands.push(Command::EndDrag);
        }
    }
    if response.drag_stopped() {
        commands.push(Command::EndDrag);
    }
    response.labelled_by(label).on_hover_text(tooltip);
}

fn set_parameters(setting: &ShownParameter, to: Parameters, commands: &mut Vec<Command>) {
    commands.push(Command::SetParameters { setting: setting.name, to: Box::new(to) });
}

/// Shows the button that resets a parameter to its default.
fn reset(ui: &mut Ui, setting: &ShownParameter, parameters: &Parameters, commands: &mut Vec<Command>) {
    let defaults = defaults(parameters);
    if setting.entry.is_same(parameters, &defaults) {
        ui.label("");
        return;
    }
    let response = ui.add(Button::new("Reset").small());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Reset {}", setting.name))
    });
    let tooltip = format!("Reset to {}.", setting.default_text(parameters.preset));
    if response.on_hover_text(tooltip).clicked() {
        let mut changed = parameters.clone();
        setting.entry.copy(&defaults, &mut changed);
        set_parameters(setting, changed, commands);
        commands.push(Command::EndDrag);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Preset;
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT, Queryable};

    #[test]
    fn no_choice_is_cut_where_there_is_room() {
        for stage in Stage::ALL {
            let mut window = Harness::builder().with_size(vec2(600.0, 900.0)).build_ui(move |ui| {
                crate::app::view::theme::install(ui.ctx());
                ui.set_max_width(290.0);
                show(ui, stage, &Parameters::default(), &mut Vec::new());
            });
            window.run();
            for clipped in &window.output().shapes {
                if let egui::Shape::Text(text) = &clipped.shape {
                    assert!(!text.galley.elided, "{}", text.galley.text());
                }
            }
        }
    }

    #[test]
    fn every_reset_button_stays_in_the_panel_however_long_the_name_and_narrow_the_panel() {
        // As many parameters as possible differ from the preset.
        let parameters = Parameters { preset: Preset::Paper, ..Parameters::from(Preset::Robust) };
        for width in [190.0, 240.0, 430.0] {
            let mut found = 0;
            for stage in Stage::ALL {
                let parameters = parameters.clone();
                let mut window = Harness::builder().with_size(vec2(600.0, 900.0)).build_ui(move |ui| {
                    crate::app::view::theme::install(ui.ctx());
                    ui.set_max_width(width);
                    show(ui, stage, &parameters, &mut Vec::new());
                });
                window.run();
                for button in window.query_all_by_label_contains("Reset ") {
                    found += 1;
                    let right = button.rect().max.x;
                    assert!(
                        right <= width + 10.0,
                        "{:?} ends at {right} of {width}",
                        button.accesskit_node().label()
                    );
                }
            }
            assert!(found >= 3, "{found} parameters differ");
        }
    }
}
