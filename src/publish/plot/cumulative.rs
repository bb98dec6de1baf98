//! Cumulative distributions on a logarithmic axis.

use maud::html as markup;

use super::axis::{Area, AxisScale};
use super::legend::{ROW, Sign, column};
use super::{Stroke, SvgDrawing, WIDTH, n, path, text_width};

/// Values of one curve. Values that are not finite count and lie beyond the right end of the axis.
#[derive(Debug, Clone)]
pub struct Distribution {
    /// Name in the legend.
    pub name: String,
    /// Stroke of the curve.
    pub stroke: Stroke,
    /// Values in any order.
    pub values: Vec<f64>,
}

/// Draws one curve per distribution: the fraction of its values, in per cent, that are at most the
/// value on the axis. Dotted lines mark the `limits`, in px.
pub fn cumulative(all: &[Distribution], quantity: &str, share_of: &str, limits: &[f64]) -> SvgDrawing {
    let scale = AxisScale::decades(all.iter().flat_map(|d| d.values.iter().copied()));
    let names = all.iter().map(|d| text_width(&d.name)).fold(0.0, f64::max);
    let height = f64::max(360.0, 60.0 + ROW * all.len() as f64);
    let area = Area { left: 66.0, right: WIDTH - 62.0 - names, top: 26.0, bottom: height - 52.0 };
    let shares = AxisScale::linear(0.0, 100.0);
    let legend: Vec<_> = all.iter().map(|d| (Sign::Line(d.stroke), d.name.clone())).collect();
    let content = markup! {
        (area.vertical(&shares, share_of, " %"))
        (area.horizontal(&scale, quantity))
        (area.limits(&scale, limits))
        @for distribution in all {
            polyline points=(path(steps(&distribution.values).into_iter().map(|[value, share]| {
                [area.x(&scale, value), area.y(&shares, 100.0 * share)]
            }))) fill="none" stroke=(distribution.stroke.color) stroke-width=(n(distribution.stroke.width))
                stroke-dasharray=[distribution.stroke.dashes()] stroke-linejoin="round" {}
        }
        (column(&legend, area.right + 18.0, area.top + 8.0))
    };
    SvgDrawing::new(WIDTH, height, content)
}

/// Returns the corners of a curve as value and fraction, from left to right.
fn steps(values: &[f64]) -> Vec<[f64; 2]> {
    let mut finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    finite.sort_by(f64::total_cmp);
    let share = |k: usize| k as f64 / values.len().max(1) as f64;
    let mut corners = vec![[0.0, 0.0]];
    for (k, value) in finite.iter().enumerate() {
        corners.push([*value, share(k)]);
        corners.push([*value, share(k + 1)]);
    }
    corners.push([f64::INFINITY, share(finite.len())]);
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_keep_the_curve_from_reaching_the_top() {
        let corners = steps(&[2.0, f64::INFINITY, 1.0, f64::NAN]);
        let shares: Vec<f64> = corners.iter().map(|c| c[1]).collect();
        assert_eq!(shares, [0.0, 0.0, 0.25, 0.25, 0.5, 0.5]);
        assert!((corners[2][0] - 1.0).abs() < 1e-12 && corners[5][0].is_infinite());
    }

    #[test]
    fn nothing_to_draw_is_still_a_drawing() {
        let empty =
            Distribution { name: "none".into(), stroke: Stroke::solid("#000", 1.0), values: Vec::new() };
        let text = cumulative(&[empty], "error", "trials", &[1.0]).file("");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
}
