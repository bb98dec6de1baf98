//! How a person looks at the rectified pair.

use serde::{Deserialize, Serialize};

use crate::app::model::document::Side;
use crate::app::model::pane_view::PaneView;
use crate::geometry::Frame;

/// Seconds that each picture is shown while they alternate.
const BLINK: f64 = 0.6;
/// Guide lines are at least this far apart when their distance follows the zoom, screen points.
const GUIDE_GAP: f64 = 30.0;

/// How the two pictures are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RectifiedLayout {
    /// One beside the other.
    #[default]
    SideBySide,
    /// One in place of the other, by turns.
    Blink,
    /// Both at once, red and cyan.
    Anaglyph,
    /// The left one up to a line that can be drawn, the right one from there on.
    Wipe,
    /// How far things are apart, by colour.
    Disparity,
}

impl RectifiedLayout {
    /// All of them, with their names and a sentence about each.
    pub const ALL: [(Self, &'static str, &'static str); 5] = [
        (
            Self::SideBySide,
            "Side by side",
            "The left picture beside the right one; what is in a row on the left is in the same row on the right.",
        ),
        (
            Self::Blink,
            "Blink",
            "Both pictures in one place by turns: things may only jump sideways. Anything that jumps up or down \
             shows rows that do not agree.",
        ),
        (
            Self::Anaglyph,
            "Anaglyph",
            "Both pictures at once, the left one red and the right one cyan, for glasses of these colours. Coloured \
             edges above and below things show rows that do not agree.",
        ),
        (
            Self::Wipe,
            "Wipe",
            "The left picture up to a line, the right one from there on: drag the line across. Edges that cross it must \
             not jump up or down.",
        ),
        (
            Self::Disparity,
            "Disparity",
            "How far to the left things are in the right picture, by colour, as a coarse matching of the rows finds it; \
             grey where nothing matches. A good geometry gives smooth surfaces with sharp edges.",
        ),
    ];
}

/// Horizontal lines over the pictures, by which rows are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Guides {
    /// None.
    Hidden,
    /// As many as the zoom has room for, at round numbers of rows.
    #[default]
    Automatic,
    /// One every so many rows.
    Every(u16),
}

impl Guides {
    /// Layouts that are offered.
    pub const ALL: [Self; 6] =
        [Self::Automatic, Self::Every(10), Self::Every(25), Self::Every(50), Self::Every(100), Self::Hidden];

    /// What it is called.
    pub fn name(self) -> String {
        match self {
            Self::Hidden => "None".into(),
            Self::Automatic => "Automatic".into(),
            Self::Every(rows) => format!("Every {rows} rows"),
        }
    }

    /// Rows from one line to the next where a row is `scale` screen points high; `None` without lines. Lines that
    /// would run into one another are thinned out.
    pub fn spacing(self, scale: f64) -> Option<f64> {
        let wanted = GUIDE_GAP / scale.max(1e-9);
        match self {
            Self::Hidden => None,
            Self::Automatic => {
                let power = 10f64.powf(wanted.log10().floor());
                let round = [1.0, 2.0, 5.0].into_iter().map(|k| k * power).find(|s| *s >= wanted);
                Some(round.unwrap_or(10.0 * power).max(1.0))
            }
            Self::Every(rows) => {
                let rows = f64::from(rows.max(1));
                // A tenth of the usual gap is where lines can no longer be told apart.
                Some(rows * (0.1 * wanted / rows).ceil().max(1.0))
            }
        }
    }
}

/// What is remembered from one run to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct RectifiedLook {
    /// How the pictures are laid out.
    pub layout: RectifiedLayout,
    /// The lines over them.
    pub guides: Guides,
}

/// Which picture is shown where they take turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blink {
    /// One after the other by the clock.
    Running,
    /// This one.
    Still(Side),
}

impl Blink {
    /// The picture to be shown `time` seconds after some beginning, and in how many seconds that changes.
    pub fn shown(self, time: f64) -> (Side, Option<f64>) {
        match self {
            Self::Still(side) => (side, None),
            Self::Running => {
                let turns = time / BLINK;
                let side = if turns.rem_euclid(2.0) < 1.0 { Side::Left } else { Side::Right };
                (side, Some((turns.floor() + 1.0 - turns) * BLINK))
            }
        }
    }
}

/// What part of the pictures is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RectifiedView {
    /// The size of the pictures it was chosen on.
    pub frame: Frame,
    /// The part.
    pub view: PaneView,
}

/// What part is shown and which picture's turn it is: gone when the window closes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewing {
    /// The same part of both pictures; `None` shows them whole.
    pub view: Option<RectifiedView>,
    /// The picture whose turn it is.
    pub blink: Blink,
    /// How far to the right the right picture is shown, px of the pictures as they are written.
    pub shift: f64,
    /// Up to which part of the width the left picture is shown in a wipe.
    pub wipe: f32,
}

impl Default for Viewing {
    fn default() -> Self {
        Self { view: None, blink: Blink::Running, shift: 0.0, wipe: 0.5 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guide_lines_keep_their_distance_at_any_zoom() {
        for scale in [0.01, 0.1, 0.37, 1.0, 3.3, 64.0] {
            let spacing = Guides::Automatic.spacing(scale).unwrap();
            assert!(spacing >= 1.0 && spacing * scale >= GUIDE_GAP - 1e-9, "{spacing} at {scale}");
            assert!(spacing * scale <= 2.6 * GUIDE_GAP || spacing <= 1.0, "{spacing} at {scale}");
            assert!(Guides::Every(10).spacing(scale).unwrap() * scale >= 2.9);
        }
        assert_eq!(Guides::Every(25).spacing(1.0), Some(25.0));
        assert_eq!(Guides::Hidden.spacing(1.0), None);
    }

    #[test]
    fn pictures_take_turns_and_a_still_one_stays() {
        let (first, left) = Blink::Running.shown(0.1);
        let (second, _) = Blink::Running.shown(0.1 + left.unwrap() + 0.01);
        assert_eq!((first, second), (Side::Left, Side::Right));
        assert_eq!(Blink::Still(Side::Right).shown(7.0), (Side::Right, None));
    }
}
