//! Single values as dots, in grouped rows, on a logarithmic axis.

use maud::{Markup, html as markup};

use super::axis::{Area, AxisScale};
use super::legend::{ROW, Sign, column, diamond, upright};
use super::{FAINT, GRID, Stroke, SvgDrawing, TEXT, WIDTH, n, text_width};

/// Group of rows.
#[derive(Debug, Clone)]
pub struct StripGroup {
    /// Name beside the group.
    pub name: String,
    /// Rows, in the same order in every group.
    pub strips: Vec<Strip>,
}

/// Row of values.
#[derive(Debug, Clone)]
pub struct Strip {
    /// Name in the legend.
    pub name: String,
    /// Stroke that gives the dots their colour. Dashed means open dots.
    pub stroke: Stroke,
    /// Values; those that are not finite are counted at the right end.
    pub values: Vec<f64>,
    /// Median of the values, drawn as a vertical stroke.
    pub middle: f64,
    /// Confidence interval of the median, drawn as a bar.
    pub interval: Option<[f64; 2]>,
    /// Reference value, drawn as a diamond.
    pub reference: Option<f64>,
}

/// Height of a row if there are few.
const ROOMY: f64 = 15.0;
/// Height of a row if there are many.
const NARROW: f64 = 9.5;
/// Number of rows from which they are narrow.
const MANY: usize = 45;
/// Gap between two groups.
const GAP: f64 = 9.0;

/// Draws all groups from top to bottom. `middle` and `reference` are the names of these signs in
/// the legend.
pub fn strips(
    groups: &[StripGroup],
    quantity: &str,
    middle: &str,
    reference: &str,
    limits: &[f64],
) -> SvgDrawing {
    let all = || groups.iter().flat_map(|g| g.strips.iter());
    let scale = AxisScale::decades(all().flat_map(|s| s.values.iter().copied().chain(s.reference)));
    let rows = groups.first().map_or(&[][..], |g| &g.strips);
    let mut legend: Vec<_> = rows.iter().map(|s| (dot_sign(s), s.name.clone())).collect();
    legend.push((Sign::Upright, middle.to_owned()));
    if all().any(|s| s.reference.is_some()) {
        legend.push((Sign::Diamond, reference.to_owned()));
    }
    let names = legend.iter().map(|(_, name)| text_width(name)).fold(0.0, f64::max);
    let left = 24.0 + groups.iter().map(|g| text_width(&g.name)).fold(0.0, f64::max).min(0.3 * WIDTH);
    let strip = if all().count() > MANY { NARROW } else { ROOMY };
    let heights: Vec<f64> = groups.iter().map(|g| strip * g.strips.len() as f64 + GAP).collect();
    let (top, body) = (26.0, heights.iter().sum::<f64>().max(ROW * legend.len() as f64));
    let area = Area { left, right: WIDTH - 92.0 - names, top, bottom: top + body };
    let tops = heights.iter().scan(top, |next, height| {
        let own = *next;
        *next += height;
        Some((own, height))
    });
    let content = markup! {
        (area.horizontal(&scale, quantity))
        (area.limits(&scale, limits))
        @for (group, (y, height)) in groups.iter().zip(tops) {
            text x=(n(area.left - 10.0)) y=(n(y + 0.5 * height + 0.35 * TEXT)) text-anchor="end" { (group.name) }
            line x1=(n(area.left)) x2=(n(area.right)) y1=(n(y)) y2=(n(y)) stroke=(GRID) {}
            @for (k, content) in group.strips.iter().enumerate() {
                (row(content, &area, &scale, y + 0.5 * GAP + (k as f64 + 0.5) * strip, strip))
            }
        }
        (column(&legend, area.right + 42.0, area.top + 8.0))
    };
    SvgDrawing::new(WIDTH, area.bottom + 52.0, content)
}

fn dot_sign(strip: &Strip) -> Sign {
    if strip.stroke.dashed { Sign::Ring(strip.stroke.color) } else { Sign::Dot(strip.stroke.color) }
}

fn row(strip: &Strip, area: &Area, scale: &AxisScale, y: f64, height: f64) -> Markup {
    let x = |value: f64| area.x(scale, value);
    let failed = strip.values.iter().filter(|v| !v.is_finite()).count();
    let color = strip.stroke.color;
    markup! {
        @if let Some([low, high]) = strip.interval {
            rect x=(n(x(low))) y=(n(y - 0.5 * height + 1.0)) width=(n((x(high) - x(low)).max(0.5)))
                height=(n(height - 2.0)) fill=(color) fill-opacity="0.16" {}
        }
        @for value in strip.values.iter().filter(|v| v.is_finite()) {
            @if strip.stroke.dashed {
                circle cx=(n(x(*value))) cy=(n(y)) r="2.1" fill="none" stroke=(color) {}
            } @else {
                circle cx=(n(x(*value))) cy=(n(y)) r="2.4" fill=(color) fill-opacity="0.6" {}
            }
        }
        @if strip.middle.is_finite() { (upright(x(strip.middle), y, 0.5 * height - 0.5)) }
        @if let Some(value) = strip.reference { (diamond(x(value), y)) }
        @if failed > 0 {
            text x=(n(area.right + 4.0)) y=(n(y + 3.5)) font-size="10" fill=(FAINT) { "× " (failed) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip(values: &[f64]) -> Strip {
        Strip {
            name: "method".into(),
            stroke: Stroke::solid("#123456", 1.0),
            values: values.to_vec(),
            middle: f64::INFINITY,
            interval: Some([0.5, f64::INFINITY]),
            reference: Some(3.0),
        }
    }

    #[test]
    fn every_value_is_a_dot_and_failures_are_counted() {
        let group = StripGroup { name: "a & b".into(), strips: vec![strip(&[1.0, f64::INFINITY, 30.0])] };
        let text = strips(&[group], "error, px", "median", "printed", &[1.0]).file("");
        assert_eq!(text.matches("r=\"2.4\"").count(), 2);
        assert!(text.contains("× 1") && text.contains("a &amp; b") && text.contains("printed"));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }

    #[test]
    fn nothing_to_draw_is_still_a_drawing() {
        let text = strips(&[], "error, px", "median", "printed", &[]).file("");
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
}
