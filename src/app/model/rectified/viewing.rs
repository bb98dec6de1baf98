//! Ways of viewing the rectified pair.

use serde::{Deserialize, Serialize};

use crate::app::model::document::Side;
use crate::app::model::pane_view::PaneView;
use crate::geometry::Frame;

/// Time that each picture is shown in a blink, seconds.
const BLINK: f64 = 0.6;
/// Minimum distance of guide lines, screen points.
const GUIDE_GAP: f64 = 30.0;

/// Layout of the two pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RectifiedLayout {
    // Settings of earlier versions may name other layouts.
    #[default]
    #[serde(alias = "wipe", alias = "anaglyph")]
    SideBySide,
    /// The pictures in one place, in turn.
    Blink,
    Disparity,
}

impl RectifiedLayout {
    pub const ALL: [(Self, &'static str, &'static str); 3] = [
        (
            Self::SideBySide,
            "Side by side",
            "The left picture beside the right one. Corresponding points are in the same row.",
        ),
        (
            Self::Blink,
            "Blink",
            "Both pictures in one place, in turn. Things may only jump sideways: a jump up or down \
             means that rows do not agree.",
        ),
        (
            Self::Disparity,
            "Disparity",
            "Shift to the left from the left picture to the right one, by colour, from a coarse \
             matching of the rows; grey where nothing matches or there is no texture. A good geometry gives smooth \
             surfaces with sharp edges.",
        ),
    ];
}

/// Returns the number of rows between the guide lines over the pictures, for rows of `scale` screen points: a round
/// number, as small as the zoom has room for.
pub fn guide_spacing(scale: f64) -> f64 {
    let wanted = GUIDE_GAP / scale.max(1e-9);
    let power = 10f64.powf(wanted.log10().floor());
    let round = [1.0, 2.0, 5.0].into_iter().map(|k| k * power).find(|s| *s >= wanted);
    round.unwrap_or(10.0 * power).max(1.0)
}

/// View settings kept between runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct RectifiedLook {
    pub layout: RectifiedLayout,
    /// Whether the horizontal lines for comparing rows are hidden.
    pub hides_guides: bool,
    /// Whether high pictures, unrolled about an epipole, are shown upright, as in the files.
    pub as_in_the_file: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blink {
    /// The pictures alternate by the clock.
    Running,
    Still(Side),
}

impl Blink {
    /// Returns the picture to show at a time in seconds, and the seconds until it changes.
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

/// Visible part of the pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RectifiedView {
    /// Size of the pictures when the part was chosen.
    pub frame: Frame,
    pub view: PaneView,
}

/// View settings that are not kept between runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewing {
    /// Visible part, the same of both pictures; `None` shows all.
    pub view: Option<RectifiedView>,
    pub blink: Blink,
    /// Shift of the right picture to the right, px of the written pictures.
    pub shift: f64,
}

impl Default for Viewing {
    fn default() -> Self {
        Self { view: None, blink: Blink::Running, shift: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guide_lines_keep_their_distance_at_every_zoom() {
        for scale in [0.01, 0.1, 0.37, 1.0, 3.3, 64.0] {
            let spacing = guide_spacing(scale);
            assert!(spacing >= 1.0 && spacing * scale >= GUIDE_GAP - 1e-9, "{spacing} at {scale}");
            assert!(spacing * scale <= 2.6 * GUIDE_GAP || spacing <= 1.0, "{spacing} at {scale}");
        }
    }

    #[test]
    fn pictures_take_turns_and_a_still_one_stays() {
        let (first, left) = Blink::Running.shown(0.1);
        let (second, _) = Blink::Running.shown(0.1 + left.unwrap() + 0.01);
        assert_eq!((first, second), (Side::Left, Side::Right));
        assert_eq!(Blink::Still(Side::Right).shown(7.0), (Side::Right, None));
    }
}
