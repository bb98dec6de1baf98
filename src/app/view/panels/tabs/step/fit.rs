//! The last step: how far the matches lie from the lines of the result.

use egui::{CollapsingHeader, Label, RichText, ScrollArea, Ui, vec2};
use egui_plot::{AxisHints, Bar, BarChart, HPlacement, VLine};

use super::super::{empty, profiles::chart};
use crate::app::model::Model;
use crate::app::view::theme;
use crate::comparison::median;
use crate::estimate::SearchPlan;
use crate::geometry::symmetric_epipolar_distance;
use crate::presentation::story_in_words;

/// Number of bars.
const BARS: usize = 24;
/// The last bar also has all farther matches. Half of the matches lie below the first quarter.
const MEDIANS: f64 = 4.0;

/// Shows a histogram of the distances, with their median.
pub fn show(ui: &mut Ui, model: &Model) {
    let shown = model.shown();
    let matches = shown.as_ref().map_or(&[][..], |shown| shown.estimate.matches());
    let f = shown.as_ref().map(|shown| shown.fundamental);
    let distance = |pair| f.map_or(f64::NAN, |f| symmetric_epipolar_distance(f, pair));
    let distances: Vec<f64> =
        matches.iter().map(|m| distance(&m.pair)).filter(|distance| distance.is_finite()).collect();
    if distances.is_empty() {
        let text = if model.document.search_plan() == SearchPlan::Barcodes {
            "Motion barcodes give no matches. The verdict tells how well the barcodes agree."
        } else {
            "The distances of the matches from their lines appear here with the result."
        };
        empty(ui, text);
        return;
    }
    // The dock has room for one of both.
    if story(ui, model) {
        return;
    }
    let median = median(&distances);
    let (counts, width) = histogram(&distances, median);
    ui.label(
        RichText::new(format!("{} matches, median distance {median:.2} px", distances.len()))
            .size(theme::CAPTION)
            .weak(),
    );
    let text = ui.visuals().text_color();
    let color = theme::line_color(model.line_look());
    chart(ui, "fit")
        .custom_x_axes(vec![AxisHints::new_x().label("Distance, px (last bar: all beyond)").formatter(
            |mark, _| {
                let decimals = if mark.step_size < 0.099 { 2 } else { 1 };
                format!("{:.decimals$}", mark.value)
            },
        )])
        .custom_y_axes(vec![AxisHints::new_y().label("Matches").placement(HPlacement::Left)])
        .set_margin_fraction(vec2(0.01, 0.05))
        .show(ui, |plot| {
            let bar = |(k, count): (usize, &usize)| {
                Bar::new((k as f64 + 0.5) * width, *count as f64).width(0.9 * width).fill(color)
            };
            plot.bar_chart(BarChart::new("distances", counts.iter().enumerate().map(bar).collect()));
            plot.vline(VLine::new("median", median).color(text).width(1.5));
        });
}

/// Shows what happened in the search, folded at first. Returns whether it is unfolded.
fn story(ui: &mut Ui, model: &Model) -> bool {
    let trace = model.open.computation.searched().and_then(|searched| searched.trace.as_deref());
    let lines = trace.map_or_else(Vec::new, |trace| story_in_words(&trace.events));
    if lines.is_empty() {
        return false;
    }
    let unfolded = CollapsingHeader::new("Course of the search").show(ui, |ui| {
        ScrollArea::vertical().show(ui, |ui| {
            for line in lines {
                ui.add(Label::new(RichText::new(line).size(theme::CAPTION)).wrap());
            }
        });
    });
    unfolded.body_returned.is_some()
}

/// Returns the number of distances in each bar, and the width of the bars, px.
fn histogram(distances: &[f64], median: f64) -> ([usize; BARS], f64) {
    let width = (MEDIANS * median / BARS as f64).max(1e-3);
    let mut counts = [0; BARS];
    for distance in distances {
        counts[((distance / width) as usize).min(BARS - 1)] += 1;
    }
    (counts, width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_distance_is_in_a_bar_and_half_of_them_in_the_first_quarter() {
        let distances: Vec<f64> = (0..100).map(f64::from).map(|k| 0.1 * k * k).collect();
        let (counts, width) = histogram(&distances, median(&distances));
        assert_eq!(counts.iter().sum::<usize>(), 100);
        assert_eq!(counts[..BARS / 4].iter().sum::<usize>(), 50);
        assert!((width - 4.0 * 245.05 / 24.0).abs() < 1e-9, "{width}");
        assert_eq!(histogram(&[0.0, 0.0], 0.0).0[0], 2);
    }
}
