//! The timeline below the pictures: the steps of the search, and the moment that is shown. Sequences have a switch that
//! exchanges it for the player of their frames.

use egui::{
    Align2, Button, Color32, CornerRadius, FontId, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Ui,
    UiBuilder, WidgetInfo, pos2, vec2,
};

use super::{busy, command_button, finish_button, player};
use crate::app::model::recording::PlayerCommand;
use crate::app::model::replay::ReplayCommand;
use crate::app::model::replay::course::{Course, StepState, TimedStep};
use crate::app::model::step::{StepProgress, duration, progress_of, sentence, title};
use crate::app::model::{Command, MethodStep, Model};
use crate::estimate::SearchPlan;

/// Height of the timeline in a low window, and otherwise, screen points.
const LOW: f32 = 36.0;
const USUAL: f32 = 48.0;
/// Height of the window from which the timeline has its usual height.
const HIGH_WINDOW: f32 = 720.0;
/// Widths of the parts beside the steps.
const SWITCH: f32 = 124.0;
const PLAY: f32 = 44.0;
const SPEED: f32 = 44.0;
const TIME: f32 = 46.0;
const RESULT: f32 = 68.0;
/// Width of a step that did not run, and the least width of any.
const CLOSED: f32 = 34.0;
/// Width of the sign of a step.
const SIGN: f32 = 25.0;
/// Width of the time of a step.
const TOOK: f32 = 58.0;
/// Height of the bars.
const BAR: f32 = 4.0;
/// Height of the strip along which the knob is dragged. Above it, a click plays a step.
const KNOB: f32 = 12.0;
/// Number of the strokes of a bar that is hatched.
const HATCH: f32 = 5.0;

/// Returns the height of the timeline in a window.
pub fn height(window: f32) -> f32 {
    if window < HIGH_WINDOW { LOW } else { USUAL }
}

/// Shows the timeline in an area.
pub fn show(ui: &mut Ui, area: Rect, model: &Model, commands: &mut Vec<Command>) {
    let line = Stroke::new(1.0, ui.visuals().widgets.noninteractive.bg_stroke.color);
    ui.painter().rect_filled(area, 0.0, ui.visuals().panel_fill);
    ui.painter().hline(area.x_range(), area.min.y, line);
    let mut room = area.shrink2(vec2(8.0, 4.0));
    if model.has_sequences() {
        let (switch, rest) = room.split_left_right_at_x(room.min.x + SWITCH);
        room = rest;
        frames_or_search(&mut inside(ui, switch, "switch"), model, commands);
        if model.shows_player() {
            player::show(&mut inside(ui, room, "player"), model, commands);
            return;
        }
    }
    let course = model.course();
    let (play, rest) = room.split_left_right_at_x(room.min.x + PLAY);
    let (speed, rest) = rest.split_left_right_at_x(rest.min.x + SPEED);
    let (rest, result) = rest.split_left_right_at_x(rest.max.x - RESULT);
    let (steps, time) = rest.split_left_right_at_x(rest.max.x - TIME);
    play_button(ui, play, model, commands);
    inside(ui, speed, "speed").centered_and_justified(|ui| {
        let button = ui.add(Button::new(model.look.speed.label()).frame(false));
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, "Speed"));
        finish_button(ui, button, ReplayCommand::NextSpeed.into(), commands);
    });
    inside(ui, result.shrink2(vec2(2.0, 4.0)), "result").centered_and_justified(|ui| {
        let runs = model.open.computation.is_running();
        let shows_moment = model.open.replay.moment().is_some() && !model.is_live();
        // Elsewhere, the card has this button.
        if runs && model.is_live() {
            command_button(ui, Command::Stop, true, commands);
            return;
        }
        let button = ui.add_enabled(shows_moment, Button::new(if runs { "Live" } else { "Result" }));
        finish_button(ui, button, ReplayCommand::Finish.into(), commands);
    });
    let now = model.replayed().map(|place| course.at(place));
    let written = now.or_else(|| model.has_record().then(|| course.length()));
    if let Some(seconds) = written {
        let color = ui.visuals().weak_text_color();
        let text = format!("{seconds:.1} s");
        ui.painter().text(time.center(), Align2::CENTER_CENTER, text, FontId::proportional(12.0), color);
    }
    all_steps(ui, steps, &course, model, commands);
}

fn inside(ui: &mut Ui, area: Rect, name: &str) -> Ui {
    ui.new_child(UiBuilder::new().max_rect(area).id_salt(name))
}

/// Shows the switch between the player of the frames and the replay of the search.
fn frames_or_search(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (name, is_shown) in [("Frames", model.shows_player()), ("Search", !model.shows_player())] {
            let button = ui.add(Button::selectable(is_shown, name).frame_when_inactive(true));
            if !is_shown {
                finish_button(ui, button, PlayerCommand::Exchange.into(), commands);
            }
        }
    });
}

fn play_button(ui: &mut Ui, area: Rect, model: &Model, commands: &mut Vec<Command>) {
    let place = Rect::from_center_size(area.center(), vec2(30.0, 30.0));
    let enabled = model.has_record();
    let response =
        ui.interact(place, ui.scope_id().with("play"), if enabled { Sense::click() } else { Sense::hover() });
    let playing = model.open.replay.is_playing();
    let name = if playing { "Pause the replay" } else { "Play how the lines were found" };
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    let visuals = ui.visuals();
    let fill = match (enabled, response.hovered()) {
        (false, _) => visuals.widgets.inactive.bg_fill,
        (true, hovered) => visuals.strong_text_color().gamma_multiply(if hovered { 1.0 } else { 0.88 }),
    };
    let ink = if enabled { visuals.panel_fill } else { visuals.weak_text_color() };
    let painter = ui.painter();
    painter.circle_filled(place.center(), 14.0, fill);
    if response.has_focus() {
        painter.circle_stroke(place.center(), 16.0, Stroke::new(1.5, visuals.strong_text_color()));
    }
    let at = |x: f32, y: f32| place.center() + vec2(x, y);
    if playing {
        for x in [-4.5, 1.5] {
            painter.rect_filled(Rect::from_min_size(at(x, -5.5), vec2(3.0, 11.0)), 0.5, ink);
        }
    } else {
        let triangle = vec![at(-3.5, -6.0), at(6.5, 0.0), at(-3.5, 6.0)];
        painter.add(Shape::convex_polygon(triangle, ink, Stroke::NONE));
    }
    finish_button(ui, response, ReplayCommand::TogglePlay.into(), commands);
}

/// Returns the width of each step: in proportion to its time, and narrow if it did not run.
fn widths(course: &Course, room: f32) -> Vec<f32> {
    let is_closed = |step: &TimedStep| matches!(step.state, StepState::NotNeeded | StepState::NotReached);
    let closed = course.steps.iter().filter(|step| is_closed(step)).count() as f32 * CLOSED;
    let open: f64 = course.steps.iter().filter(|step| !is_closed(step)).map(|step| step.seconds).sum();
    let share = |step: &TimedStep| (room - closed) * (step.seconds / open.max(0.1)) as f32;
    course.steps.iter().map(|step| if is_closed(step) { CLOSED } else { share(step) }).collect()
}

fn all_steps(ui: &mut Ui, area: Rect, course: &Course, model: &Model, commands: &mut Vec<Command>) {
    let plan = model.document.search_plan();
    let widths = widths(course, area.width());
    let shown = model.replayed();
    let now = shown.map_or_else(|| course.length(), |place| course.at(place));
    let mut left = area.min.x;
    let mut begin = 0.0;
    // Where each second of the axis is, for the knob and for dragging.
    let mut axis: Vec<(Rect, f64, f64)> = Vec::new();
    for (timed, width) in course.steps.iter().zip(&widths) {
        let place = Rect::from_min_max(pos2(left, area.min.y), pos2(left + width - 4.0, area.max.y));
        left += width;
        let is_shown = shown.is_some_and(|shown| shown.step == timed.step);
        let ran = timed.state == StepState::Ran;
        one_step(ui, place, timed, is_shown, model, plan, commands);
        let bar =
            Rect::from_min_max(pos2(place.min.x + 6.0, place.max.y - BAR - 5.0), place.max - vec2(6.0, 5.0));
        let visuals = ui.visuals();
        let track = visuals.widgets.inactive.bg_fill;
        match timed.state {
            StepState::NotNeeded | StepState::NotReached => hatched(ui.painter(), bar, track),
            _ => drop(ui.painter().rect_filled(bar, 2.0, track)),
        }
        if ran {
            let share = ((now - begin) / timed.seconds).clamp(0.0, 1.0) as f32;
            let passed = bar.with_max_x(egui::lerp(bar.x_range(), share));
            ui.painter().rect_filled(passed, 2.0, visuals.text_color());
            axis.push((bar, begin, timed.seconds));
            begin += timed.seconds;
        }
    }
    scrub(ui, area, &axis, now, model, commands);
}

/// Shows the knob, and lets it be dragged along the bars.
fn scrub(
    ui: &mut Ui,
    area: Rect,
    axis: &[(Rect, f64, f64)],
    now: f64,
    model: &Model,
    commands: &mut Vec<Command>,
) {
    let (Some(first), Some(last)) = (axis.first(), axis.last()) else { return };
    let strip =
        Rect::from_x_y_ranges(first.0.min.x - 6.0..=last.0.max.x + 6.0, area.max.y - KNOB..=area.max.y);
    let response = ui.interact(strip, ui.scope_id().with("time of the replay"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::slider(true, now, "Time of the replay"));
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        let nearest = axis.iter().min_by(|a, b| {
            let away = |bar: &Rect| (at.x - at.x.clamp(bar.min.x, bar.max.x)).abs();
            away(&a.0).total_cmp(&away(&b.0))
        });
        if let Some((bar, begin, length)) = nearest {
            let share = ((at.x - bar.min.x) / bar.width()).clamp(0.0, 0.999);
            commands.push(ReplayCommand::Seek(begin + length * f64::from(share)).into());
        }
    }
    let within = axis.iter().find(|(_, begin, length)| now <= begin + length).unwrap_or(last);
    let share = ((now - within.1) / within.2).clamp(0.0, 1.0) as f32;
    let knob = pos2(egui::lerp(within.0.x_range(), share), within.0.center().y);
    let visuals = ui.visuals();
    let radius = if response.hovered() || response.has_focus() { 7.5 } else { 6.0 };
    let fill = if model.replayed().is_some() { Color32::WHITE } else { visuals.text_color() };
    ui.painter().circle(knob, radius, fill, Stroke::new(1.5, visuals.panel_fill));
}

fn hatched(painter: &Painter, bar: Rect, color: Color32) {
    let painter = painter.with_clip_rect(bar);
    let count = (bar.width() / HATCH) as usize + 2;
    for k in 0..count {
        let x = bar.min.x + k as f32 * HATCH;
        painter.line_segment([pos2(x, bar.min.y), pos2(x - BAR, bar.max.y)], Stroke::new(1.5, color));
    }
}

fn one_step(
    ui: &mut Ui,
    place: Rect,
    timed: &TimedStep,
    is_shown: bool,
    model: &Model,
    plan: SearchPlan,
    commands: &mut Vec<Command>,
) {
    let name = title(timed.step, plan);
    let response = ui.interact(place, ui.scope_id().with(timed.step.title()), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_shown, format!("Step {name}")));
    let visuals = ui.visuals();
    let highlight = match (is_shown, response.hovered() || response.has_focus()) {
        (true, _) => Some(visuals.widgets.active.bg_fill),
        (false, true) => Some(visuals.widgets.hovered.weak_bg_fill),
        (false, false) => None,
    };
    if let Some(fill) = highlight {
        ui.painter().rect_filled(place.expand2(vec2(2.0, 2.0)), CornerRadius::same(5), fill);
    }
    let color = match timed.state {
        _ if is_shown => visuals.strong_text_color(),
        StepState::Ran => visuals.text_color(),
        _ => visuals.weak_text_color(),
    };
    let middle = f32::midpoint(place.min.y, place.max.y - BAR - 5.0);
    let state = progress_of(timed.step, &model.open.computation);
    let sign = pos2(place.min.x + 13.0, middle);
    if state == StepProgress::Running {
        let mark = Rect::from_center_size(sign, vec2(14.0, 14.0));
        ui.scope_builder(UiBuilder::new().max_rect(mark), busy::show);
    } else {
        pictogram(ui.painter(), timed.step, sign, color);
    }
    let painter = ui.painter_at(place);
    let written = painter.layout_no_wrap(name.to_owned(), FontId::proportional(13.0), color);
    let has_room = place.width() >= SIGN + written.size().x;
    let (size, at) = (written.size(), pos2(place.min.x + SIGN, middle - written.size().y / 2.0));
    if has_room {
        painter.galley(at, written, color);
    }
    if let StepProgress::Done(Some(seconds)) = state
        && place.width() >= SIGN + size.x + TOOK
        && timed.state == StepState::Ran
    {
        let at = pos2(place.max.x - 6.0, middle);
        let color = if is_shown { color } else { ui.visuals().weak_text_color() };
        painter.text(at, Align2::RIGHT_CENTER, duration(seconds), FontId::proportional(11.0), color);
    }
    let hint = format!("{name}. {} {}", sentence(timed.step, plan), timed.state.in_words());
    if response.on_hover_text(hint.trim_end()).clicked() {
        commands.push(ReplayCommand::Play(timed.step).into());
    }
}

/// Draws the sign of a step around a place.
fn pictogram(painter: &Painter, step: MethodStep, centre: Pos2, color: Color32) {
    let stroke = Stroke::new(1.3, color);
    let lines = |ends: &[[f32; 4]]| {
        for [x1, y1, x2, y2] in ends {
            painter.line_segment([centre + vec2(*x1, *y1), centre + vec2(*x2, *y2)], stroke);
        }
    };
    let dots = |places: &[[f32; 2]], radius: f32| {
        for [x, y] in places {
            painter.circle_filled(centre + vec2(*x, *y), radius, color);
        }
    };
    match step {
        MethodStep::Motion => {
            for (x, opacity) in [(-4.0, 0.35), (0.0, 0.6), (4.0, 1.0)] {
                painter.circle_filled(centre + vec2(x, 0.0), 3.2, color.gamma_multiply(opacity));
            }
        }
        MethodStep::Barcodes => lines(&[
            [-6.0, -4.5, -6.0, 4.5],
            [-3.0, -4.5, -3.0, 4.5],
            [-1.5, -4.5, -1.5, 4.5],
            [3.0, -4.5, 3.0, 4.5],
            [6.0, -4.5, 6.0, 4.5],
        ]),
        MethodStep::Pencils => lines(&[[-6.0, 0.0, 6.0, -4.0], [-6.0, 0.0, 6.0, 0.0], [-6.0, 0.0, 6.0, 4.0]]),
        MethodStep::Candidates => lines(&[[-6.0, -3.5, 6.0, 3.5], [-6.0, 3.5, 6.0, -3.5]]),
        MethodStep::Features => dots(&[[-4.5, -3.5], [0.0, 1.0], [4.5, -2.0], [-3.0, 4.5], [4.0, 4.0]], 1.5),
        MethodStep::Matches => {
            lines(&[[-5.0, -3.0, 5.0, -4.5], [-5.0, 4.0, 5.0, 2.5]]);
            dots(&[[-5.0, -3.0], [5.0, -4.5], [-5.0, 4.0], [5.0, 2.5]], 1.5);
        }
        MethodStep::Epipoles => {
            lines(&[[-6.0, -4.5, 6.0, 4.5], [-6.0, 4.5, 6.0, -4.5]]);
            dots(&[[0.0, 0.0]], 2.4);
        }
        MethodStep::RoundTrip => {
            lines(&[[-6.0, -2.5, 6.0, -2.5], [6.0, -2.5, 3.0, -5.0]]);
            lines(&[[-6.0, 2.5, 6.0, 2.5], [-6.0, 2.5, -3.0, 5.0]]);
        }
        MethodStep::Validation => {
            lines(&[[-6.0, -4.0, 6.0, -4.0], [-6.0, 0.0, 3.0, 0.0], [-6.0, 4.0, 0.0, 4.0]]);
        }
        MethodStep::Refinement => {
            painter.circle_stroke(centre, 4.0, stroke);
            lines(&[
                [2.5, 0.0, 6.5, 0.0],
                [-2.5, 0.0, -6.5, 0.0],
                [0.0, 2.5, 0.0, 6.5],
                [0.0, -2.5, 0.0, -6.5],
            ]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_fill_the_strip_and_those_that_did_not_run_are_narrow() {
        let course = Course::planned(SearchPlan::Patches { clicks: 2 });
        let all = widths(&course, 900.0);
        assert!((all.iter().sum::<f32>() - 900.0).abs() < 1e-2);
        let mut closed = course;
        closed.steps[2].state = StepState::NotNeeded;
        let some = widths(&closed, 900.0);
        assert!((some.iter().sum::<f32>() - 900.0).abs() < 1e-2);
        assert!((some[2] - CLOSED).abs() < 1e-6 && some[0] > all[0]);
    }
}
