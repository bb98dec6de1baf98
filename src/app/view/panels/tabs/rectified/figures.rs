//! The column beside the rectified pictures: choices, method, warnings and quality measures.

use std::fmt::Write;

use egui::{Button, Checkbox, Grid, RichText, Slider, Ui, UiBuilder};

use super::finish_button;
use crate::app::model::rectified::{Blink, DrawnPair, Rectified, RectifiedCommand, RectifiedLayout};
use crate::app::model::{Command, Model};
use crate::app::view::theme;
use crate::presentation::{WRONG_PREVIEW, disparities_in_words, preview_in_words, sentence};
use crate::rectify::{Distortion, Measures, Rectification, RectifyMethod, RectifyWarning};

/// Width below which choices and figures are one above the other, screen points.
const ROOM_FOR_BOTH: f32 = 460.0;

/// Shows choices and quality measures.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    rectified: &Rectified,
    drawn: &DrawnPair,
    commands: &mut Vec<Command>,
) {
    ui.spacing_mut().item_spacing.y = 3.0;
    ui.spacing_mut().button_padding.x = 7.0;
    let area = ui.available_rect_before_wrap();
    if area.width() < ROOM_FOR_BOTH {
        choosers(ui, model, drawn, commands);
        warnings(ui, model, rectified, drawn);
        method(ui, model, drawn);
        measures(ui, model, rectified, drawn);
        return;
    }
    // Columns of egui would justify the words of a text.
    let (left, right) = area.split_left_right_at_fraction(0.46);
    ui.scope_builder(UiBuilder::new().max_rect(left.with_max_x(left.max.x - theme::GAP)), |ui| {
        choosers(ui, model, drawn, commands);
        method(ui, model, drawn);
    });
    ui.scope_builder(UiBuilder::new().max_rect(right), |ui| {
        warnings(ui, model, rectified, drawn);
        measures(ui, model, rectified, drawn);
    });
}

fn choosers(ui: &mut Ui, model: &Model, drawn: &DrawnPair, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| method_chooser(ui, model, commands));
    ui.horizontal(|ui| shift_chooser(ui, model, drawn, commands));
    ui.horizontal(|ui| guide_chooser(ui, model, commands));
    if drawn.is_high() {
        ui.horizontal(|ui| {
            name(ui, "Shown");
            let look = &model.look.rectified;
            for (chosen, title) in
                [(!look.as_in_the_file, "Turned to fit"), (look.as_in_the_file, "As in the file")]
            {
                let choice = ui.add(Button::selectable(chosen, title));
                if !chosen {
                    finish_button(ui, choice, RectifiedCommand::ToggleTurned.into(), commands);
                }
            }
        });
    }
}

fn warnings(ui: &mut Ui, model: &Model, rectified: &Rectified, drawn: &DrawnPair) {
    // The pair may still belong to the previous geometry.
    let is_of_shown = model.shown().is_some_and(|shown| *shown.fundamental == rectified.fundamental);
    for warning in &drawn.full.warnings {
        let of_shown = match warning {
            RectifyWarning::Misfit { rows } if is_of_shown => model.misfit_in_words(*rows),
            _ => None,
        };
        let text = of_shown.unwrap_or_else(|| sentence(&warning.to_string()));
        ui.label(RichText::new(text).color(theme::palette(ui.visuals()).caution));
    }
}

/// Shows the method and the reason for it. The places of epipoles that are not determined give no reason.
fn method(ui: &mut Ui, model: &Model, drawn: &DrawnPair) {
    let full = &drawn.full;
    let is_open = model.epipole_is_open() && !model.shows_another();
    let text = if is_open {
        format!(
            "{}. The epipole is not determined: rows match, but disparities are not depth.",
            full.method.name()
        )
    } else {
        format!("{}, because {}.", full.method.name(), full.reason)
    };
    ui.weak(sentence(&text));
    if drawn.is_turned(&model.look.rectified) {
        ui.weak(
            "Both pictures are unrolled about the epipole and turned: matching points stand in one column.",
        );
    }
}

fn measures(ui: &mut Ui, model: &Model, rectified: &Rectified, drawn: &DrawnPair) {
    let full = &drawn.full;
    let row = drawn.row_name(&model.look.rectified);
    rows(ui, model, &full.measures, (row, rectified.measured), fits(full));
    shapes(ui, &full.measures.distortion);
    if let Some((map, _)) = &drawn.disparity {
        ui.label(preview_in_words(map.range, map.matched(), map.agreeing)).on_hover_text(
            "A coarse matching of the rows: range of nearly all disparities, share of the left picture with a match, and \
             of the known matches that agree. Surfaces without texture have none. Below 40 %, rows hardly correspond.",
        );
        if map.is_mostly_wrong() {
            ui.colored_label(theme::palette(ui.visuals()).caution, WRONG_PREVIEW);
        }
    }
    let size = full.size;
    ui.weak(format!("{} × {} px", size.width, size.height))
        .on_hover_text("Size of each exported picture. On the screen, it may be smaller.");
}

pub fn method_chooser(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    name(ui, "Method");
    for (method, title) in
        [(RectifyMethod::Auto, "Auto"), (RectifyMethod::Planar, "Planar"), (RectifyMethod::Polar, "Polar")]
    {
        let choice = ui.add(Button::selectable(model.document.rectification == method, title));
        finish_button(ui, choice, RectifiedCommand::SetMethod(method).into(), commands);
    }
}

pub fn layout_chooser(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 2.0;
    ui.spacing_mut().button_padding.x = 7.0;
    for (layout, title, tooltip) in RectifiedLayout::ALL {
        let chosen = model.look.rectified.layout == layout;
        if ui.add(Button::selectable(chosen, title)).on_hover_text(tooltip).clicked() {
            commands.push(RectifiedCommand::LayOut(layout).into());
        }
    }
}

fn shift_chooser(ui: &mut Ui, model: &Model, drawn: &DrawnPair, commands: &mut Vec<Command>) {
    name(ui, "Shift");
    let mut shift = model.open.viewing.shift;
    let reach = (drawn.full.size.width as f64 / 2.0).round();
    ui.spacing_mut().slider_width = 84.0;
    let slider = ui.add(Slider::new(&mut shift, -reach..=reach).suffix(" px").fixed_decimals(0));
    let slider = slider.on_hover_text(
        "Shift of the right picture to the right, in exported pixels. A click on the ring of a pair, or on \
         the disparities, aligns both pictures at that depth in blink.",
    );
    if slider.changed() {
        commands.push(RectifiedCommand::Shift(shift).into());
    }
    let none = ui.add_enabled(model.open.viewing.shift != 0.0, Button::new("0"));
    finish_button(ui, none, RectifiedCommand::Shift(0.0).into(), commands);
}

/// Shows the switch of the guide lines and, in blink layout, the controls of the alternation.
fn guide_chooser(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    name(ui, "Lines");
    // The disparities have no guide lines.
    let has_guides = model.look.rectified.layout != RectifiedLayout::Disparity;
    let mut shown = has_guides && !model.look.rectified.hides_guides;
    let switch = ui.add_enabled(has_guides, Checkbox::new(&mut shown, "guide lines"));
    finish_button(ui, switch, RectifiedCommand::ToggleGuides.into(), commands);
    if model.look.rectified.layout == RectifiedLayout::Blink {
        let swap = ui.button("Swap");
        finish_button(ui, swap, RectifiedCommand::Swap.into(), commands);
        let mut running = model.open.viewing.blink == Blink::Running;
        let run = ui.checkbox(&mut running, "auto");
        finish_button(ui, run, RectifiedCommand::RunBlink.into(), commands);
    }
}

/// Shows a label. Equal widths align the choices.
fn name(ui: &mut Ui, text: &str) {
    ui.scope(|ui| {
        ui.set_min_width(52.0);
        ui.weak(text);
    });
}

/// Shows how well rows agree and, if they do, the disparities.
fn rows(ui: &mut Ui, model: &Model, measures: &Measures, (row, measured): (&str, &str), fits: bool) {
    let Some(rows) = measures.rows else {
        ui.weak(
            "No match is inside both pictures, so the lines cannot be checked. Click some pairs to check \
             them.",
        );
        return;
    };
    ui.label(format!(
        "{row}s differ by {:.2} px on average, {:.2} px at most, over {} {measured}.",
        rows.mean, rows.max, rows.matches
    ))
    .on_hover_text(
        "Distance of matches across the lines of the rectified pictures. Well below 1 px is good.",
    );
    if !fits {
        return;
    }
    let mut text = disparities_in_words(rows.disparity, model.document.is_of_files());
    if rows.far_off > 0 {
        let _ = write!(text, " Outliers left out: {} of {}.", rows.far_off, rows.matches);
    }
    ui.label(text).on_hover_text(
        "Smallest and largest disparity (left x − right x) of the matches of the result, or else of the clicked pairs, \
         and of the true matches if they are known. Other points may lie beyond, so the search range is wider, in \
         multiples of 16. The other order of the pictures changes the signs.",
    );
}

/// Returns whether the geometry fits the matches, so that their disparities mean something.
pub fn fits(full: &Rectification) -> bool {
    !full.warnings.iter().any(|warning| matches!(warning, RectifyWarning::Misfit { .. }))
}

/// Shows the distortion of each picture, one measure a row: the dock may be narrow.
fn shapes(ui: &mut Ui, [left, right]: &[Distortion; 2]) {
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let angle = |d: &Distortion| d.orthogonality.map_or("-".into(), |angle| format!("{angle:.1}°"));
    let ratio = |d: &Distortion| d.aspect_ratio.map_or("-".into(), |ratio| format!("{ratio:.3}"));
    let rows = [
        (
            "Angle",
            "Angle between the centre lines of the image after rectification. 90° preserves right angles.",
            [angle(left), angle(right)],
        ),
        (
            "Proportions",
            "Ratio of the image's diagonals after rectification. 1 preserves proportions; far from 1, the \
             image is squeezed.",
            [ratio(left), ratio(right)],
        ),
        ("Cut", "Share of the image outside the rectified picture.", [percent(left.cut), percent(right.cut)]),
        (
            "Shrunk",
            "Share of the image reduced to less than half its area, where detail is lost.",
            [percent(left.shrunk), percent(right.shrunk)],
        ),
        (
            "Stretched",
            "Share of the image enlarged to more than twice its area.",
            [percent(left.stretched), percent(right.stretched)],
        ),
    ];
    Grid::new("shapes").num_columns(3).spacing([14.0, 1.0]).min_col_width(0.0).min_row_height(16.0).show(
        ui,
        |ui| {
            ui.label("");
            ui.weak("Left");
            ui.weak("Right");
            ui.end_row();
            for (title, tooltip, values) in rows {
                ui.label(RichText::new(title).size(12.0).weak()).on_hover_text(tooltip);
                for value in values {
                    ui.label(value);
                }
                ui.end_row();
            }
        },
    );
}
