//! The tab of the method: a strip of its steps, and the open step with its chart, its explanation and
//! its parameters. The step also switches its overlays on.

mod candidates;
mod epipole_map;
mod fit;
mod hypotheses;
mod matrix;
mod parameters;
mod pencils;

use egui::{
    Button, CollapsingHeader, FontId, Label, Rect, RichText, ScrollArea, Sense, Shape, Stroke, Ui, UiBuilder,
    WidgetInfo, pos2, vec2,
};

use super::{Tab, busy, finish_button, pale_earlier, say_earlier};
use crate::app::model::step::{StepProgress, progress, result_text};
use crate::app::model::{Command, MethodStep, Model, Side, TabId};
use crate::app::view::theme;
use crate::estimate::{Method, Preset, Search, SearchPlan, Stage};

/// Registered in [`super::TABS`].
pub const TAB: Tab = Tab { id: TabId::Method, tools, show };

/// Height of the strip, screen points.
const STRIP: f32 = 24.0;
/// Length of the point of a step in the strip.
const POINT: f32 = 7.0;
/// Width from which the explanation is beside the chart, screen points.
const ROOM_FOR_BOTH: f32 = 430.0;

impl MethodStep {
    /// Returns the stages of the computation that belong to the step.
    fn stages(self) -> &'static [Stage] {
        match self {
            Self::Pencils => &[Stage::Pyramid, Stage::Pencils],
            Self::Candidates | Self::RoundTrip => &[],
            Self::Epipoles => &[Stage::Features, Stage::Hypotheses],
            Self::Validation => &[Stage::Validation],
            Self::Result => &[Stage::Refinement],
        }
    }

    /// Explains the step of a search in two or three sentences.
    fn explanation(self, plan: SearchPlan) -> String {
        let all_lines = matches!(plan, SearchPlan::Barcodes | SearchPlan::LinesAlone { .. });
        let of_clicks = match self {
            Self::Pencils if plan == SearchPlan::Barcodes => {
                "Every line through p in the left image is compared with every line through p in the right one, \
                 and the same for q. A bright cell is a line pair across which things move in the same frames."
            }
            Self::Pencils => {
                "Lines through p in the left image are matched with lines through p in the right one, and \
                 the same for q. A bright cell is a line pair whose intensities match well."
            }
            Self::Candidates => {
                "A candidate is a line pair of which each line is the best match of the other. The images \
                 show the candidates of p and q, the cheapest ones brightest."
            }
            Self::Epipoles if plan == SearchPlan::Unclicked => {
                "Without clicks, matched features propose the hypotheses, each with an epipole in either \
                 image. Line pairs through matches propose more if doubts remain."
            }
            Self::Epipoles if all_lines => {
                "Three candidates at a time, from all lines of both images, give the map between the lines, \
                 and so a hypothesis. Each hypothesis has an epipole in either image."
            }
            Self::Epipoles => {
                "A candidate through p and one through q meet in an epipole in each image. Their bisectors \
                 and a third line pair give the map between the lines, and so a hypothesis."
            }
            Self::RoundTrip => {
                "H maps the epipolar lines from left to right, G maps them back; the orange region lies \
                 between a line and its return. A small region speaks for a hypothesis; a good one may have \
                 a large region, so the validation decides."
            }
            Self::Validation if plan == SearchPlan::Barcodes => {
                "The best hypotheses are fitted to the barcodes of lines all over both images. The one whose \
                 barcodes agree best is the result."
            }
            Self::Validation => {
                "The best hypotheses are scored over the whole of both images. The lead over the rival \
                 compares the first one with the best clearly different one."
            }
            Self::Result if plan == SearchPlan::Barcodes => {
                "The best hypothesis is fitted to the barcodes in full size. Fits without some of the frames \
                 give its uncertainty, if there are enough."
            }
            Self::Result => {
                "The best hypothesis is fitted to patches that match along its lines at full resolution. \
                 The bands around the lines show the uncertainty that follows from the matches."
            }
        };
        let mut text = of_clicks.to_owned();
        if plan == SearchPlan::Unclicked {
            for (click, found) in [("p", "match 1"), ("q", "match 2")] {
                for end in [" ", ".", ","] {
                    text = text.replace(&format!(" {click}{end}"), &format!(" {found}{end}"));
                }
            }
            if self == Self::Pencils {
                text += " F comes from matched features, and these two matches take the place of clicks.";
            }
        }
        text
    }
}

fn tools(ui: &mut Ui, model: &Model, _: &mut Vec<Command>) {
    say_earlier(ui, model.open.computation.is_behind());
}

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    strip(ui, model, commands);
    let step = model.look.step;
    let area = ui.available_rect_before_wrap();
    let (chart, words) = if area.width() >= ROOM_FOR_BOTH {
        let (chart, words) = area.split_left_right_at_fraction(0.62);
        (chart.with_max_x(chart.max.x - theme::GAP), words)
    } else {
        let (chart, words) = area.split_top_bottom_at_fraction(0.62);
        (chart.with_max_y(chart.max.y - theme::GAP), words)
    };
    ui.scope_builder(UiBuilder::new().max_rect(words).id_salt("words"), |ui| {
        explained(ui, step, model, commands);
    });
    ui.scope_builder(UiBuilder::new().max_rect(chart).id_salt(step.title()), |ui| {
        pale_earlier(ui, model.open.computation.is_behind());
        match step {
            MethodStep::Pencils => pencils::show(ui, model, commands),
            MethodStep::Candidates => candidates::show(ui, model, commands),
            MethodStep::Epipoles => epipoles(ui, model, commands),
            MethodStep::RoundTrip | MethodStep::Validation => hypotheses::show(ui, step, model, commands),
            MethodStep::Result => fit::show(ui, model),
        }
    });
}

/// Words in place of the plots of pencils that a search does not have.
const NO_PENCILS: &str = "This search has no line pencils.";
/// Words in place of plots without room.
const NO_ROOM: &str = "Enlarge the dock to see the plots.";
/// Least height of the maps of the epipoles, screen points.
const LEAST_MAP: f32 = 56.0;

fn epipoles(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    if model.shown().is_none() {
        super::empty(ui, "The epipoles of all hypotheses appear here during the estimate.");
        return;
    }
    let area = ui.available_rect_before_wrap();
    if area.height() < LEAST_MAP {
        super::empty(ui, NO_ROOM);
        return;
    }
    let (left, right) = area.split_left_right_at_fraction(0.5);
    for (side, area) in Side::BOTH.into_iter().zip([left, right]) {
        epipole_map::show(ui, area, side, model, commands);
    }
}

/// Returns whether the search compares all lines at once, in place of pencils.
fn has_no_pencils(model: &Model) -> bool {
    let plan = model.document.search_plan();
    let all_lines = matches!(plan, SearchPlan::Barcodes | SearchPlan::LinesAlone { .. });
    all_lines && model.document.is_unclicked()
}

/// Explains a step of the search of this document.
fn explanation(step: MethodStep, model: &Model) -> String {
    if matches!(step, MethodStep::Pencils | MethodStep::Candidates) && has_no_pencils(model) {
        return "This search compares all lines of both images at once. Line pencils need two point pairs."
            .into();
    }
    step.explanation(model.document.search_plan())
}

/// Shows the explanation, the figure that decided, the parameters, and the neighbouring steps.
fn explained(ui: &mut Ui, step: MethodStep, model: &Model, commands: &mut Vec<Command>) {
    ScrollArea::vertical().id_salt("words").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        ui.set_max_width(ui.available_width() - theme::SCROLL_BAR);
        ui.horizontal(|ui| {
            for (forward, text) in [(false, "◀ Back"), (true, "Next ▶")] {
                let button = ui.add_enabled(step.neighbour(forward).is_some(), Button::new(text).small());
                finish_button(ui, button, Command::StepMethod { forward }, commands);
            }
        });
        ui.add(Label::new(explanation(step, model)).wrap());
        for stage in step.stages() {
            if let Some(text) = result_text(*stage, &model.document, &model.open.computation) {
                ui.add(Label::new(RichText::new(text).weak()).wrap());
            }
        }
        let stages = step.stages();
        if stages.is_empty() {
            return;
        }
        let parameters = &model.document.parameters;
        let is_changed = stages.iter().any(|stage| parameters::is_any_changed(*stage, parameters));
        let title = if is_changed { "Parameters *" } else { "Parameters" };
        CollapsingHeader::new(title).id_salt(("parameters", step.title())).show_unindented(ui, |ui| {
            choices(ui, model, commands);
            for stage in stages {
                parameters::show(ui, *stage, parameters, commands);
            }
        });
    });
}

/// Shows the preset and, for the published search, the method.
fn choices(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let parameters = &model.document.parameters;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.weak("Preset");
        for (preset, name) in [(Preset::Robust, "Robust"), (Preset::Paper, "As published")] {
            let response = ui.selectable_label(parameters.preset == preset, name);
            finish_button(ui, response, Command::SetPreset(preset), commands);
        }
        if parameters.search == Search::Lines {
            for (method, name) in [(Method::TwoPoint, "Two-point"), (Method::ThreePoint, "Three-point")] {
                let response = ui.selectable_label(parameters.method == method, name);
                finish_button(ui, response, Command::SetMethod(method), commands);
            }
        }
        let reset = *parameters != parameters.with_preset(parameters.preset);
        let button = ui.add_enabled(reset, Button::new("Reset all").small());
        finish_button(ui, button, Command::ResetParameters, commands);
    });
}

/// Shows the steps as a strip that fills from left to right while the computation runs.
fn strip(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    let (area, _) = ui.allocate_exact_size(vec2(ui.available_width(), STRIP), Sense::hover());
    let palette = theme::palette(ui.visuals());
    let galley_of = |text: &str| {
        ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(12.0), palette.on_accent)
    };
    let needed = |step: MethodStep| galley_of(step.title()).size().x + 2.0 * POINT + 4.0;
    let count = MethodStep::ALL.len() as f32;
    let longest = MethodStep::ALL.into_iter().map(needed).fold(0.0, f32::max);
    // In little room only the open step has its title, the others their numbers.
    let is_short = longest > area.width() / count;
    let open_width = if is_short { needed(model.look.step) } else { area.width() / count };
    let closed_width = (area.width() - open_width) / (count - 1.0);
    let mut left = area.min.x;
    for (number, step) in MethodStep::ALL.into_iter().enumerate() {
        let width = if model.look.step == step { open_width } else { closed_width };
        let title = if is_short && model.look.step != step {
            (number + 1).to_string()
        } else {
            step.title().to_owned()
        };
        let place = Rect::from_min_max(pos2(left, area.min.y), pos2(left + width - 1.0, area.max.y));
        let response = ui.interact(place, ui.scope_id().with(step.title()), Sense::click());
        let open = model.look.step == step;
        response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, open, step.title()));
        let state = state_of(step, model);
        let visuals = ui.visuals();
        let (fill, text) = match state {
            _ if open => (palette.accent, palette.on_accent),
            _ if response.hovered() => (visuals.widgets.hovered.bg_fill, visuals.text_color()),
            StepProgress::Done(_) => (visuals.widgets.inactive.bg_fill, visuals.text_color()),
            _ => (visuals.faint_bg_color, visuals.weak_text_color()),
        };
        let notch = if number == 0 { 0.0 } else { POINT };
        let arrow = [
            place.min,
            pos2(place.max.x - POINT, place.min.y),
            pos2(place.max.x, place.center().y),
            pos2(place.max.x - POINT, place.max.y),
            place.left_bottom(),
        ];
        // Only convex shapes can be filled, so the notch is painted over.
        let cut = [place.min, pos2(place.min.x + notch, place.center().y), place.left_bottom()];
        for (corners, fill) in [(&arrow[..], fill), (&cut, ui.visuals().panel_fill)] {
            ui.painter().add(Shape::convex_polygon(corners.to_vec(), fill, Stroke::NONE));
        }
        let time = match state {
            StepProgress::Done(Some(seconds)) if width > 104.0 => format!("  {}", fit::duration(seconds)),
            _ => String::new(),
        };
        let galley = ui.painter().layout_no_wrap(title, FontId::proportional(12.0), text);
        let caption =
            ui.painter().layout_no_wrap(time, FontId::proportional(10.5), text.gamma_multiply(0.75));
        let start = place.center().x + POINT / 2.0 - f32::midpoint(galley.size().x, caption.size().x);
        let start = start.max(place.min.x + notch + 1.0);
        let middle = place.center().y;
        let painter = ui.painter_at(place);
        let end = start + galley.size().x;
        painter.galley(pos2(start, middle - galley.size().y / 2.0), galley, text);
        painter.galley(pos2(end, middle - caption.size().y / 2.0), caption, text);
        if state == StepProgress::Running {
            let mark = Rect::from_center_size(pos2(place.max.x - 16.0, middle), vec2(14.0, 14.0));
            ui.scope_builder(UiBuilder::new().max_rect(mark), busy::show);
        }
        let hint = format!("{}. {} (N for the next step)", step.title(), explanation(step, model));
        if response.on_hover_text(hint).clicked() {
            commands.push(Command::ShowStep(step));
        }
        left += width;
    }
}

/// Returns the progress of a step: of its last stage that has begun, or of the step before it.
fn state_of(step: MethodStep, model: &Model) -> StepProgress {
    let computation = &model.open.computation;
    // A stage repeated by the wider search is not shown as running twice.
    let of = |stages: &[Stage]| stages.iter().map(|stage| progress(*stage, computation)).reduce(later);
    match step {
        MethodStep::Candidates => without_time(of(MethodStep::Pencils.stages())),
        MethodStep::RoundTrip => without_time(of(MethodStep::Epipoles.stages())),
        MethodStep::Pencils => progress(Stage::Pencils, computation),
        _ => of(step.stages()).unwrap_or(StepProgress::Waiting),
    }
}

/// Sums the times of two stages; a running or failed stage prevails.
fn later(first: StepProgress, second: StepProgress) -> StepProgress {
    use StepProgress::{Done, Failed, Running, Stopped, Waiting};
    match (first, second) {
        (Waiting, other) | (other, Waiting) => other,
        (Done(a), Done(b)) => Done(a.zip(b).map(|(a, b)| a + b).or(a).or(b)),
        (Running, _) | (_, Running) => Running,
        (Failed, _) | (_, Failed) => Failed,
        (Stopped, _) | (_, Stopped) => Stopped,
    }
}

fn without_time(progress: Option<StepProgress>) -> StepProgress {
    match progress {
        Some(StepProgress::Done(_)) => StepProgress::Done(None),
        other => other.unwrap_or(StepProgress::Waiting),
    }
}
