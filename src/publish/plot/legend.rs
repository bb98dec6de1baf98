//! Legends of lines and signs.

use maud::{Markup, html as markup};

use super::{INK, Stroke, TEXT, n, text_width};

/// Sign of a legend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sign {
    /// Line with a stroke.
    Line(Stroke),
    /// Filled dot of a colour.
    Dot(&'static str),
    /// Open circle of a colour.
    Ring(&'static str),
    /// Open square of a colour.
    Square(&'static str),
    /// Open diamond.
    Diamond,
    /// Vertical stroke.
    Upright,
}

/// Width reserved for a sign.
const SIGN: f64 = 26.0;
/// Distance between the rows of a column.
pub(super) const ROW: f64 = TEXT + 6.0;

/// Draws entries one below the other, the first centred at `top`.
pub(super) fn column(entries: &[(Sign, String)], left: f64, top: f64) -> Markup {
    markup! {
        @for (k, entry) in entries.iter().enumerate() { (entry_at(entry, left, top + k as f64 * ROW)) }
    }
}

/// Draws entries side by side.
pub(super) fn row(entries: &[(Sign, String)], left: f64, middle: f64) -> Markup {
    let widths = entries.iter().map(|(_, text)| SIGN + 26.0 + text_width(text));
    let places = widths.scan(left, |next, width| {
        let own = *next;
        *next += width;
        Some(own)
    });
    markup! { @for (entry, x) in entries.iter().zip(places) { (entry_at(entry, x, middle)) } }
}

fn entry_at((sign, text): &(Sign, String), x: f64, y: f64) -> Markup {
    markup! {
        (sign.markup(x, y))
        text x=(n(x + SIGN + 6.0)) y=(n(y + 0.35 * TEXT)) { (text) }
    }
}

impl Sign {
    fn markup(self, x: f64, y: f64) -> Markup {
        match self {
            Self::Line(stroke) => markup! {
                line x1=(n(x)) x2=(n(x + SIGN)) y1=(n(y)) y2=(n(y)) stroke=(stroke.color) stroke-width=(n(stroke.width))
                    stroke-dasharray=[stroke.dashes()] {}
            },
            Self::Dot(color) => markup! { circle cx=(n(x + 0.5 * SIGN)) cy=(n(y)) r="3.5" fill=(color) {} },
            Self::Ring(color) => {
                markup! { circle cx=(n(x + 0.5 * SIGN)) cy=(n(y)) r="3.2" fill="none" stroke=(color) stroke-width="1.4" {} }
            }
            Self::Square(color) => markup! {
                rect x=(n(x + 0.5 * SIGN - 5.0)) y=(n(y - 5.0)) width="10" height="10" fill="none" stroke=(color)
                    stroke-width="2" {}
            },
            Self::Diamond => diamond(x + 0.5 * SIGN, y),
            Self::Upright => upright(x + 0.5 * SIGN, y, 5.0),
        }
    }
}

pub(super) fn diamond(x: f64, y: f64) -> Markup {
    const R: f64 = 4.0;
    let path = format!("M{} {}l{R} {R}l-{R} {R}l-{R} -{R}z", n(x), n(y - R));
    markup! { path d=(path) fill="#ffffff" stroke=(INK) stroke-width="1.2" {} }
}

/// Draws a vertical stroke of twice `height`.
pub(super) fn upright(x: f64, y: f64, height: f64) -> Markup {
    markup! {
        line x1=(n(x)) x2=(n(x)) y1=(n(y - height)) y2=(n(y + height)) stroke=(INK) stroke-width="2" {}
    }
}
