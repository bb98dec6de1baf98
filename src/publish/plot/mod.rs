//! Plots and marked pictures as SVG.
//!
//! Lengths are user units, of which a drawing is [`WIDTH`] wide; lettering has the same size in all drawings, so
//! that they look alike side by side. Colours are those of Okabe and Ito (*Color Universal Design*, 2008), which
//! people with any common colour vision tell apart and which stay apart in grey. No element has an identifier:
//! several drawings can stand in one page.

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

/// Lettering of axes and legends.
pub(super) const TEXT: f64 = 12.5;

/// Colours of data on white, each legible as a thin line.
pub const COLORS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#aa4499", "#e69f00", "#1a1a1a", "#56b4e9"];

/// Axes and lettering.
pub(super) const INK: &str = "#1a1a1a";
/// What is read second.
pub(super) const FAINT: &str = "#666666";
/// The grid.
pub(super) const GRID: &str = "#e2e2e2";

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour of the line.
    pub color: &'static str,
    /// Width of the line.
    pub width: f64,
    /// Whether it has gaps.
    pub dashed: bool,
}

impl Stroke {
    /// A line without gaps.
    pub fn solid(color: &'static str, width: f64) -> Self {
        Self { color, width, dashed: false }
    }

    /// The attribute that makes the gaps.
    fn dashes(&self) -> Option<&'static str> {
        self.dashed.then_some("6 3")
    }
}

/// A drawing that a document can show.
#[derive(Debug, Clone)]
pub struct SvgDrawing {
    width: f64,
    height: f64,
    content: Markup,
}

impl SvgDrawing {
    /// Elements in a rectangle from (0, 0) to the given size.
    pub(super) fn new(width: f64, height: f64, content: Markup) -> Self {
        Self { width, height, content }
    }

    /// An element of an HTML page; `label` is for those who cannot see it.
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

    /// A file of its own.
    pub fn file(&self, label: &str) -> String {
        let declaration = PreEscaped("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        markup! { (declaration) (self.inline(label)) "\n" }.into_string()
    }
}

/// A number with as many digits as can be seen.
pub(super) fn n(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// About how wide a text is.
pub(super) fn text_width(text: &str) -> f64 {
    0.5 * TEXT * text.chars().count() as f64
}

/// The `points` of a polyline.
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
