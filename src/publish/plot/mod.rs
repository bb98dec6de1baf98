//! Plots and annotated pictures as SVG.
//!
//! Lengths are user units; a drawing is [`WIDTH`] units wide. Lettering has the same size in all
//! drawings. Colours are from Okabe and Ito (*Color Universal Design*, 2008): they remain distinct
//! with common colour-vision deficiencies and in grey. No element has an identifier, so a page can
//! contain several drawings.

mod axis;
mod cumulative;
mod curves;
mod legend;
mod picture;
mod strips;

pub use axis::AxisScale;
pub use cumulative::{Distribution, cumulative};
pub use curves::{Curve, Panel, curves};
pub use legend::Sign;
pub use picture::{Mark, MarkedPicture, pictures};
pub use strips::{Strip, StripGroup, strips};

use maud::{Markup, PreEscaped, html as markup};

/// Width of every drawing.
pub const WIDTH: f64 = 940.0;

/// Size of the lettering of axes and legends.
pub(super) const TEXT: f64 = 12.5;

/// Colours of data on white, each legible as a thin line.
pub const COLORS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#aa4499", "#e69f00", "#1a1a1a", "#56b4e9"];

/// Colour of axes and lettering.
pub(super) const INK: &str = "#1a1a1a";
/// Colour of secondary text.
pub(super) const FAINT: &str = "#666666";
/// Colour of the grid.
pub(super) const GRID: &str = "#e2e2e2";

/// Style of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour of the line.
    pub color: &'static str,
    /// Width of the line.
    pub width: f64,
    /// Whether the line is dashed.
    pub dashed: bool,
}

impl Stroke {
    /// Creates a solid line.
    pub fn solid(color: &'static str, width: f64) -> Self {
        Self { color, width, dashed: false }
    }

    /// Returns the dash attribute.
    fn dashes(&self) -> Option<&'static str> {
        self.dashed.then_some("6 3")
    }
}

/// Drawing for a document.
#[derive(Debug, Clone)]
pub struct SvgDrawing {
    width: f64,
    height: f64,
    content: Markup,
}

impl SvgDrawing {
    /// Creates a drawing of elements in a rectangle from (0, 0) to the given size.
    pub(super) fn new(width: f64, height: f64, content: Markup) -> Self {
        Self { width, height, content }
    }

    /// Returns an element of an HTML page; `label` is for screen readers.
    pub fn inline(&self, label: &str) -> Markup {
        markup! {
            svg xmlns="http://www.w3.org/2000/svg" viewBox={ "0 0 " (n(self.width)) " " (n(self.height)) }
                width=(n(self.width)) height=(n(self.height)) role="img" aria-label=(label)
                font-family="Helvetica, Arial, 'Liberation Sans', sans-serif" font-size=(TEXT) fill=(INK)
            {
                rect width=(n(self.width)) height=(n(self.height)) fill="#ffffff" {}
                (self.content)
            }
        }
    }

    /// Returns a separate SVG file.
    pub fn file(&self, label: &str) -> String {
        let declaration = PreEscaped("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        markup! { (declaration) (self.inline(label)) "\n" }.into_string()
    }
}

/// Formats a coordinate with visible precision.
pub(super) fn n(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Estimates the width of a text.
pub(super) fn text_width(text: &str) -> f64 {
    0.5 * TEXT * text.chars().count() as f64
}

/// Formats the `points` of a polyline.
pub(super) fn path(points: impl Iterator<Item = [f64; 2]>) -> String {
    points.map(|[x, y]| format!("{},{}", n(x), n(y))).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([1.0, -0.001, 2.5, 3.456, -7.0].map(n), ["1", "0", "2.5", "3.46", "-7"]);
    }
}
