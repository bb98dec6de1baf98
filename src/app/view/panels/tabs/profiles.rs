//! The tab of the intensities along the inspected line pair, before and after warping, with the
//! matching costs.

use egui::{
    Align, Color32, ColorImage, Id, Label, Layout, Rangef, Rect, RichText, ScrollArea, Sense, TextureHandle,
    TextureOptions, Ui, UiBuilder, Vec2, vec2,
};
use egui_plot::{
    AxisHints, GridInput, GridMark, HPlacement, Line, Plot, PlotImage, PlotPoint, PlotPoints, PlotUi, VLine,
};

use super::inspected::{marked, read_out, tools};
use super::{Tab, barcodes, empty};
use crate::app::model::inspection::Inspection;
use crate::app::model::{Command, Model, TabId, Target};
use crate::app::view::{heat, theme};

pub const TAB: Tab = Tab { id: TabId::Profiles, tools, show };

const LEFT: Color32 = theme::CAMERAS[0];
const RIGHT: Color32 = theme::CAMERAS[1];

/// Height below which the plots scroll, screen points, since lower plots would overlap.
const LEAST_HEIGHT: f32 = 176.0;

fn show(ui: &mut Ui, model: &Model, commands: &mut Vec<Command>) {
    if let Some(inspected) = model.inspected_barcodes() {
        barcodes::show(ui, model, &inspected, commands);
        return;
    }
    let Some(inspection) =
        model.open.inspection.as_ref().filter(|inspection| !inspection.samples().is_empty())
    else {
        let text = if model.open.inspection.is_some() {
            "This line does not cross the left image. Pin another pair to compare its intensities."
        } else if model.inspected().is_some() {
            "The two lines are being compared."
        } else if model.recordings().is_some() {
            "The motion along a line pair appears here with the first result."
        } else {
            "Intensities along a line pair appear here with the first result."
        };
        empty(ui, text);
        return;
    };
    let room = ui.available_size();
    let hovered =
        ScrollArea::vertical().id_salt("profile plots").auto_shrink([false, false]).show(ui, |ui| {
            let grid = PlotGrid::fitting(room);
            let (area, _) = ui.allocate_exact_size(vec2(room.x, grid.height(room)), Sense::hover());
            all_plots(ui, model, inspection, area, grid)
        });
    if let Some(sample) = hovered.inner {
        commands.push(Command::PointAt(Target::Sample(sample)));
    }
}

/// Arrangement of the four plots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PlotGrid {
    /// The curves at the left; costs and disparities at the right.
    Whole,
    /// The curves in the first row. The others are below and are scrolled to.
    Low,
    /// One below the other.
    Narrow,
}

impl PlotGrid {
    fn fitting(room: Vec2) -> Self {
        match room {
            _ if room.x < LEAST_WIDTH => Self::Narrow,
            _ if room.y < LEAST_HEIGHT => Self::Low,
            _ => Self::Whole,
        }
    }

    fn height(self, room: Vec2) -> f32 {
        match self {
            Self::Whole => room.y,
            Self::Low => 2.0 * room.y.max(0.5 * LEAST_HEIGHT),
            // Whole plots fill the view, so that no title is cut at its end.
            Self::Narrow => {
                let in_view = (2.0 * room.y / LEAST_HEIGHT).floor().clamp(1.0, 4.0);
                4.0 * (room.y / in_view).max(0.5 * LEAST_HEIGHT)
            }
        }
    }

    fn place(self, area: Rect, number: usize) -> Rect {
        let cell = |column: usize, columns: usize, row: usize, rows: usize| {
            let size = area.size() / vec2(columns as f32, rows as f32);
            Rect::from_min_size(area.min + size * vec2(column as f32, row as f32), size)
        };
        match self {
            Self::Whole => cell(number % 2, 2, number / 2, 2),
            Self::Low => cell(number / 2, 2, number % 2, 2),
            // Both curves first.
            Self::Narrow => cell(0, 1, [0, 2, 1, 3][number], 4),
        }
    }

    /// Returns the plot beside whose title the lines and the sample under the cursor are described: one
    /// in view with room there.
    fn described(self) -> usize {
        match self {
            Self::Whole => 1,
            Self::Low | Self::Narrow => 0,
        }
    }

    /// Returns whether a plot shows the scale of the distance, which plots in a column share.
    fn has_scale(self, number: usize) -> bool {
        match self {
            Self::Whole => number >= 2,
            Self::Low => true,
            Self::Narrow => number == 3,
        }
    }
}

/// Width below which the description of the lines is left out, screen points: it would be cut after a
/// word or two.
const ROOM_FOR_WORDS: f32 = 170.0;
/// Width below which the plots are one below the other, screen points.
const LEAST_WIDTH: f32 = 420.0;

/// Opacity of the costs of samples without a counterpart.
const FIXED: f32 = 0.45;

/// Half of the width of the longest label of an axis, screen points.
const HALF_LABEL: f32 = 24.0;

/// Shows the four plots. Returns the sample under the cursor.
fn all_plots(ui: &mut Ui, model: &Model, inspection: &Inspection, area: Rect, grid: PlotGrid) -> Option<i32> {
    let marked = marked(model);
    let mut hovered = None;
    for (number, (title, tooltip, content)) in PLOTS.into_iter().enumerate() {
        let rect = grid.place(area, number).shrink2(vec2(4.0, 1.0));
        let mut child = ui.new_child(UiBuilder::new().max_rect(rect).id_salt(title));
        child.spacing_mut().item_spacing.y = 0.0;
        child.horizontal(|ui| {
            ui.spacing_mut().interact_size.y = 0.0;
            let small = |text: &str| RichText::new(text).size(12.0).weak();
            ui.label(small(title)).on_hover_text(tooltip);
            if number % 2 == 0 {
                name_curves(ui);
            }
            if number == 3 {
                let (bar, _) = ui.allocate_exact_size(vec2(56.0, 9.0), Sense::hover());
                heat::bar(ui.painter(), bar, heat::grey);
                ui.label(small("unlike to alike"))
                    .on_hover_text("Cost of matching two samples, high to low.");
            }
            let has_room = ui.available_width() > ROOM_FOR_WORDS;
            if let Some((text, tooltip)) = read_out(model).filter(|_| number == grid.described() && has_room)
            {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    let text = RichText::new(text).size(12.0);
                    ui.add(Label::new(text).truncate()).on_hover_text(tooltip);
                });
            }
        });
        let plot = Titled { title, has_scale: grid.has_scale(number), content };
        hovered = plot.show(&mut child, inspection, marked).or(hovered);
    }
    hovered
}

type Content = fn(&mut PlotUi, &Inspection, &TextureHandle);

const PLOTS: [(&str, &str, Content); 4] = [
    (
        "Grey before warping",
        "Intensities of both lines (vertical) at the same distance from the click (horizontal, px).",
        before,
    ),
    (
        "Cost, grey²",
        "Cost of each sample, grey²: its intensity difference and the change of disparity. Faint: samples \
         without a counterpart, hidden or outside in the right image. Their cost is fixed.",
        costs,
    ),
    (
        "Grey after warping",
        "Intensities of the right line, warped onto the left line by the disparities found.",
        after,
    ),
    (
        "Disparity, px",
        "Cost of matching each sample of the left line (horizontal) at each disparity (vertical). Bright \
         means similar. The curve is the matching found.",
        band,
    ),
];

struct Titled<'a> {
    title: &'a str,
    /// Whether the scale of the distance is shown. The plots above share the scale.
    has_scale: bool,
    content: Content,
}

impl Titled<'_> {
    /// Shows the plot. Returns the sample under the cursor.
    fn show(&self, ui: &mut Ui, inspection: &Inspection, marked: Option<i32>) -> Option<i32> {
        let step = inspection.step;
        let samples = inspection.samples();
        let texture = band_texture(ui, inspection);
        // A label so near the right edge would be cut.
        let half_label = f64::from(HALF_LABEL / ui.available_width().max(HALF_LABEL));
        let response = chart(ui, self.title)
            .link_axis(Id::unique("profile plots"), [true, false])
            .show_axes([self.has_scale, true])
            .y_axis_min_width(40.0)
            .grid_spacing(8.0..=24.0)
            .set_margin_fraction(vec2(0.0, 0.06))
            .allow_zoom([true, false])
            .allow_drag([true, false])
            .custom_y_axes(vec![
                AxisHints::new_y().placement(HPlacement::Left).label_spacing(Rangef::new(6.0, 12.0)),
            ])
            .custom_x_axes(vec![
                AxisHints::new_x()
                    .formatter(move |mark, seen| {
                        let is_cut = seen.end() - mark.value < half_label * (seen.end() - seen.start());
                        if is_cut {
                            String::new()
                        } else if mark.value.abs() < 0.5 {
                            "0 px".to_owned()
                        } else {
                            format!("{:.0}", mark.value)
                        }
                    })
                    // Labels nearer to each other than this fade away.
                    .label_spacing(Rangef::new(20.0, 36.0)),
            ])
            .show(ui, |plot| {
                (self.content)(plot, inspection, &texture);
                let cursor = plot.pointer_coordinate().filter(|_| plot.response().hovered());
                let own = cursor.map(|point| (point.x / step).round() as i32);
                let own = own.filter(|sample| samples.contains(sample));
                if let Some(sample) = own.or(marked).filter(|sample| samples.contains(sample)) {
                    let line = VLine::new("cursor", f64::from(sample) * step);
                    plot.vline(line.color(theme::HOVER).width(1.0));
                }
                own
            });
        response.inner
    }
}

/// Tells the colours of the profiles.
fn name_curves(ui: &mut Ui) {
    for (color, text) in [(LEFT, "left"), (RIGHT, "right")] {
        let (area, _) = ui.allocate_exact_size(vec2(14.0, 3.0), Sense::hover());
        ui.painter().rect_filled(area, 1.0, color);
        ui.label(RichText::new(text).size(theme::CAPTION).weak());
    }
}

/// Shows the profiles of the inspected lines as they are, and the right one on its way to its place: `slide` of 0
/// before warping, 1 after it.
pub(super) fn sliding(ui: &mut Ui, model: &Model, slide: f64) {
    let Some(inspection) =
        model.open.inspection.as_ref().filter(|inspection| !inspection.samples().is_empty())
    else {
        empty(ui, "The two lines are being compared.");
        return;
    };
    let area = ui.available_rect_before_wrap();
    let (upper, lower) = area.split_top_bottom_at_fraction(0.5);
    let matching = &inspection.warped.matching;
    for (rect, title, slide) in [(upper, "as they are", 0.0), (lower, "warped", slide)] {
        let mut child = ui.new_child(UiBuilder::new().max_rect(rect.shrink2(vec2(4.0, 1.0))).id_salt(title));
        child.spacing_mut().item_spacing.y = 0.0;
        child.horizontal(|ui| {
            ui.label(RichText::new(title).size(theme::CAPTION).weak());
            name_curves(ui);
        });
        chart(&child, title)
            .link_axis(Id::unique("sliding profiles"), [true, false])
            .show_axes([false, false])
            .set_margin_fraction(vec2(0.0, 0.06))
            .show(&mut child, |plot| {
                if title == "warped" {
                    let moved = |k: usize| {
                        let value = inspection.warped.warped2.get(k).copied().flatten()?;
                        let away = f64::from(*matching.disparities.get(k)?) * (1.0 - slide);
                        Some([away * inspection.step, f64::from(value)])
                    };
                    draw_curve(plot, "right", moved_curve(inspection, moved), RIGHT);
                    left_intensities(plot, inspection);
                } else {
                    profiles_before(plot, inspection);
                }
            });
    }
}

/// Returns the points of a curve whose samples are moved along the line.
fn moved_curve(inspection: &Inspection, moved: impl Fn(usize) -> Option<[f64; 2]>) -> Vec<Vec<[f64; 2]>> {
    let own = |k: usize| moved(k).map(|[_, value]| value);
    let mut pieces = curve(inspection, own);
    let mut shifts = (0..inspection.samples().len()).filter_map(|k| moved(k).map(|[away, _]| away));
    for point in pieces.iter_mut().flatten() {
        point[0] += shifts.next().unwrap_or(0.0);
    }
    pieces
}

/// Creates a plot in the look of the window, at first without movement.
pub(super) fn chart<'a>(ui: &Ui, name: &str) -> Plot<'a> {
    Plot::new(name)
        .x_grid_spacer(|input| marks(&input, 6.0))
        .y_grid_spacer(|input| marks(&input, 4.0))
        .grid_color(ui.visuals().widgets.noninteractive.bg_stroke.color)
        .show_x(false)
        .show_y(false)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .label_formatter(|_| None)
}

/// Returns marks of an axis at round numbers, about `count` of them in view.
fn marks(input: &GridInput, count: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let wanted = ((high - low) / count).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(wanted.log10().floor());
    let step = power * [1.0, 2.0, 5.0].into_iter().find(|round| round * power >= wanted).unwrap_or(10.0);
    let first = (low / step).ceil();
    // The plot also asks before its bounds are known.
    let number = ((high / step).floor() - first).clamp(0.0, 100.0) as usize;
    (0..=number).map(|k| GridMark { value: (first + k as f64) * step, step_size: step }).collect()
}

/// Returns the points of a curve over the distance from the anchor, px.
fn curve(inspection: &Inspection, value: impl Fn(usize) -> Option<f64>) -> Vec<Vec<[f64; 2]>> {
    // Missing values leave a gap.
    let mut pieces = vec![Vec::new()];
    for (k, sample) in inspection.samples().enumerate() {
        match (value(k), pieces.last_mut()) {
            (Some(value), Some(piece)) => piece.push([f64::from(sample) * inspection.step, value]),
            (None, Some(piece)) if !piece.is_empty() => pieces.push(Vec::new()),
            _ => {}
        }
    }
    pieces
}

fn draw_curve(plot: &mut PlotUi, name: &str, pieces: Vec<Vec<[f64; 2]>>, color: Color32) {
    for piece in pieces.into_iter().filter(|piece| piece.len() > 1) {
        plot.line(Line::new(name, PlotPoints::from(piece)).color(color).width(1.3).allow_hover(false));
    }
}

fn left_intensities(plot: &mut PlotUi, inspection: &Inspection) {
    let values = &inspection.warped.profile1.values;
    draw_curve(plot, "left", curve(inspection, |k| values.get(k).map(|v| f64::from(*v))), LEFT);
}

fn before(plot: &mut PlotUi, inspection: &Inspection, _: &TextureHandle) {
    profiles_before(plot, inspection);
}

fn profiles_before(plot: &mut PlotUi, inspection: &Inspection) {
    let first = inspection.warped.profile1.first;
    let value = |k: usize| inspection.warped.profile2.get(first + k as i32).map(f64::from);
    draw_curve(plot, "right", curve(inspection, value), RIGHT);
    left_intensities(plot, inspection);
}

fn after(plot: &mut PlotUi, inspection: &Inspection, _: &TextureHandle) {
    let value = |k: usize| inspection.warped.warped2.get(k).copied().flatten().map(f64::from);
    draw_curve(plot, "right, warped", curve(inspection, value), RIGHT);
    left_intensities(plot, inspection);
}

fn costs(plot: &mut PlotUi, inspection: &Inspection, _: &TextureHandle) {
    let costs = &inspection.warped.matching.sample_costs;
    let value = |k: usize| costs.get(k).map(|cost| f64::from(*cost));
    let visuals = &plot.ctx().global_style().visuals;
    let (measured, fixed) = (visuals.text_color(), visuals.weak_text_color().gamma_multiply(FIXED));
    // A single such sample stays in the curve, and so do the ends of longer stretches.
    let lone = |k: usize| (k.saturating_sub(1)..=k + 1).all(|near| !inspection.has_counterpart(near));
    draw_curve(plot, "no counterpart", curve(inspection, |k| value(k).filter(|_| lone(k))), fixed);
    draw_curve(plot, "cost", curve(inspection, |k| value(k).filter(|_| !lone(k))), measured);
}

fn band(plot: &mut PlotUi, inspection: &Inspection, texture: &TextureHandle) {
    let (samples, range, step) = (inspection.samples(), inspection.range, inspection.step);
    let middle = |first: i32, last: i32| f64::from(first + last) / 2.0 * step;
    let centre = PlotPoint::new(middle(samples.start, samples.end - 1), middle(range.min, range.max));
    let size = vec2((samples.len() as f64 * step) as f32, (range.len() as f64 * step) as f32);
    plot.image(PlotImage::new("cost", texture.id(), centre, size).allow_hover(false));
    // Beside the right line there is nothing to match.
    let path = |k: usize| {
        inspection.warped.warped2.get(k).copied().flatten()?;
        inspection.warped.matching.disparities.get(k).map(|d| f64::from(*d) * step)
    };
    draw_curve(plot, "path", curve(inspection, path), theme::HOVER);
}

/// Returns the cost band as a texture, kept from frame to frame.
fn band_texture(ui: &Ui, inspection: &Inspection) -> TextureHandle {
    let id = Id::unique("cost band");
    if let Some((number, texture)) = ui.data(|data| data.get_temp::<(u64, TextureHandle)>(id))
        && number == inspection.number
    {
        return texture;
    }
    let size = [inspection.band.width() as usize, inspection.band.height() as usize];
    let image = ColorImage::from_gray(size, inspection.band.as_raw());
    let texture = ui.ctx().load_texture("cost band", image, TextureOptions::NEAREST);
    ui.data_mut(|data| data.insert_temp(id, (inspection.number, texture.clone())));
    texture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_column_shows_whole_plots() {
        for height in [90.0, 185.0, 250.0, 351.0, 500.0] {
            let plot = PlotGrid::Narrow.height(vec2(300.0, height)) / 4.0;
            let in_view = height / plot;
            assert!((in_view - in_view.round()).abs() < 1e-3, "{in_view} plots in {height}");
        }
    }
}
