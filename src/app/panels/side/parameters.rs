//! The parameters of a step, each with its unit, its default, and what is wrong with it.

use egui::{Button, ComboBox, DragValue, Grid, Label, RichText, Ui, Vec2, vec2};

use crate::app::command::Command;
use crate::app::theme;
use crate::estimate::{PARAMETERS, ParameterEntry, ParameterValue, Parameters, Stage};

/// Size of the field of a number.
const FIELD: Vec2 = vec2(112.0, 22.0);

/// Whether a parameter of a step differs from the preset.
pub fn is_any_changed(stage: Stage, parameters: &Parameters) -> bool {
    let defaults = Parameters::from(parameters.preset);
    of(stage).any(|setting| !setting.is_same(parameters, &defaults))
}

fn of(stage: Stage) -> impl Iterator<Item = &'static ParameterEntry> {
    PARAMETERS.iter().filter(move |setting| setting.stage == stage)
}

/// Shows the parameters of a step.
pub fn show(ui: &mut Ui, stage: Stage, parameters: &Parameters, commands: &mut Vec<Command>) {
    Grid::new(("parameters", stage.label())).num_columns(3).spacing([8.0, 3.0]).show(ui, |ui| {
        for setting in of(stage) {
            let tooltip = format!("{} {}", setting.tooltip, setting.range_text(parameters.preset));
            let label = ui.label(setting.name).on_hover_text(tooltip.as_str());
            edit(ui, setting, parameters, label.id, &tooltip, commands);
            reset(ui, setting, parameters, commands);
            ui.end_row();
        }
    });
    let color = theme::palette(ui.visuals()).bad;
    for problem in of(stage).filter_map(|setting| setting.problem(parameters)) {
        ui.add(Label::new(RichText::new(problem).color(color)).wrap());
    }
}

/// The field of a parameter. All of a drag is one step of the history, anything else is a step of its own.
fn edit(
    ui: &mut Ui,
    setting: &ParameterEntry,
    parameters: &Parameters,
    label: egui::Id,
    tooltip: &str,
    commands: &mut Vec<Command>,
) {
    let mut changed = parameters.clone();
    let (response, is_changed) = match setting.value {
        ParameterValue::Number { unit, of_unit, range: [least, most], decimals, get, set, .. } => {
            let before = get(parameters) / of_unit;
            let mut value = before;
            let speed = (before.abs() / 100.0).max(0.1f64.powi(decimals as i32));
            let field = DragValue::new(&mut value)
                .suffix(unit)
                .speed(speed)
                .fixed_decimals(decimals)
                .min_size(FIELD)
                .update_while_editing(false);
            let response = ui.add(field);
            if response.dragged() {
                // A drag stops at the ends; what is typed is taken as it is, and told when it is wrong.
                value = value.clamp(least / of_unit, most / of_unit);
            }
            // The end of a range must not be exceeded by a rounding when its unit changes.
            let near = |end: f64| (value * of_unit - end).abs() < 1e-9;
            let end = [least, most].into_iter().find(|end| setting.is_converted() && near(*end));
            set(&mut changed, end.unwrap_or(value * of_unit));
            (response, value.to_bits() != before.to_bits())
        }
        ParameterValue::Switch { get, set } => {
            let mut on = get(parameters);
            let response = ui.checkbox(&mut on, "");
            set(&mut changed, on);
            (response, on != get(parameters))
        }
        ParameterValue::Choice { names, get, set } => {
            let before = get(parameters);
            let mut chosen = before;
            let response = ComboBox::from_id_salt(setting.name).width(FIELD.x).show_index(
                ui,
                &mut chosen,
                names.len(),
                |k| names[k],
            );
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

fn set_parameters(setting: &ParameterEntry, to: Parameters, commands: &mut Vec<Command>) {
    commands.push(Command::SetParameters { setting: setting.name, to: Box::new(to) });
}

/// Takes one parameter back to its default.
fn reset(ui: &mut Ui, setting: &ParameterEntry, parameters: &Parameters, commands: &mut Vec<Command>) {
    let defaults = Parameters::from(parameters.preset);
    if setting.is_same(parameters, &defaults) {
        ui.label("");
        return;
    }
    let response = ui.add(Button::new("Reset").small());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Reset {}", setting.name))
    });
    let tooltip = format!("Back to {}.", setting.default_text(parameters.preset));
    if response.on_hover_text(tooltip).clicked() {
        let mut changed = parameters.clone();
        setting.copy(&defaults, &mut changed);
        set_parameters(setting, changed, commands);
        commands.push(Command::EndDrag);
    }
}
