//! Curves over a common axis, in panels one below the other.

use maud::html as markup;

use super::axis::{Area, AxisScale};
use super::legend::{Sign, row};
use super::{FAINT, Stroke, SvgDrawing, TEXT, WIDTH, n, path};

/// Panel of curves.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Title above the panel.
    pub title: String,
    /// Curves of the panel.
    pub curves: Vec<Curve>,
}

/// Curve of a panel.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Name in the legend.
    pub name: String,
    /// Stroke of the curve.
    pub stroke: Stroke,
    /// Points from left to right; `None` makes a gap.
    pub points: Vec<(f64, Option<f64>)>,
}

/// Height of a panel.
const PANEL: f64 = 150.0;

/// Draws all panels with the same scales. Curves of the same name share an entry of the legend.
pub fn curves(panels: &[Panel], across: &str, up: &str, range: [f64; 2]) -> SvgDrawing {
    let xs = || panels.iter().flat_map(|p| &p.curves).flat_map(|c| c.points.iter().map(|p| p.0));
    let (low, high) = xs().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let scale = if low <= high { AxisScale::linear(low, high) } else { AxisScale::linear(0.0, 1.0) };
    let values = AxisScale::linear(range[0], range[1]);
    let area = |k: usize| {
        let top = 50.0 + k as f64 * (PANEL + 30.0);
        Area { left: 66.0, right: WIDTH - 12.0, top, bottom: top + PANEL }
    };
    let mut legend: Vec<(Sign, String)> = Vec::new();
    for curve in panels.iter().flat_map(|p| &p.curves) {
        if legend.iter().all(|(_, name)| *name != curve.name) {
            legend.push((Sign::Line(curve.stroke), curve.name.clone()));
        }
    }
    let last = panels.len().saturating_sub(1);
    let content = markup! {
        (row(&legend, area(0).left, 14.0))
        @for (k, panel) in panels.iter().enumerate() {
            text x=(n(area(k).left)) y=(n(area(k).top - 7.0)) fill=(FAINT) { (panel.title) }
            (area(k).vertical(&values, up, ""))
            @if k == last { (area(k).horizontal(&scale, across)) } @else { (area(k).ticks(&scale)) }
            @for curve in &panel.curves {
                @for run in runs(&curve.points) {
                    polyline points=(path(run.into_iter().map(|[x, y]| [area(k).x(&scale, x), area(k).y(&values, y)])))
                        fill="none" stroke=(curve.stroke.color) stroke-width=(n(curve.stroke.width))
                        stroke-dasharray=[curve.stroke.dashes()] stroke-linejoin="round" {}
                }
            }
        }
    };
    SvgDrawing::new(WIDTH, area(last).bottom + 22.0 + 2.0 * TEXT, content)
}

/// Splits the points at the gaps.
fn runs(points: &[(f64, Option<f64>)]) -> Vec<Vec<[f64; 2]>> {
    points
        .split(|(_, y)| y.is_none())
        .map(|run| run.iter().filter_map(|(x, y)| Some([*x, (*y)?])).collect::<Vec<_>>())
        .filter(|run| run.len() > 1)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_have_gaps_where_they_have_no_value() {
        let points = [(0.0, Some(1.0)), (1.0, Some(2.0)), (2.0, None), (3.0, Some(4.0)), (4.0, Some(5.0))];
        assert_eq!(runs(&points), [[[0.0, 1.0], [1.0, 2.0]], [[3.0, 4.0], [4.0, 5.0]]]);
        let curve = |name: &str| Curve {
            name: name.into(),
            stroke: Stroke::solid("#123456", 1.0),
            points: points.to_vec(),
        };
        let panel = |title: &str| Panel { title: title.into(), curves: vec![curve("left"), curve("right")] };
        let text = curves(&[panel("before"), panel("after")], "px", "grey level", [0.0, 255.0]).file("");
        assert_eq!(text.matches("<polyline").count(), 8);
        assert_eq!(text.matches(">left<").count(), 1, "one entry of the legend for both panels");
    }

    #[test]
    fn nothing_to_draw_is_still_a_drawing() {
        let text = curves(&[], "px", "grey level", [0.0, 255.0]).file("");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
}
