//! What a search found, and whether to trust it.

use std::fmt;

use serde::Serialize;

use crate::geometry::Point;

/// The image that was clicked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClickedImage {
    /// Image 1, the left one: matches are suggested in image 2.
    First,
    /// Image 2, the right one: matches are suggested in image 1.
    Second,
}

impl ClickedImage {
    /// 1 or 2.
    pub fn number(self) -> usize {
        self.index() + 1
    }

    pub(super) fn index(self) -> usize {
        usize::from(self == Self::Second)
    }

    pub(super) fn other(self) -> Self {
        if self == Self::First { Self::Second } else { Self::First }
    }
}

/// A place in the other image that looks like the surroundings of the click.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Suggestion {
    /// Where, to a fraction of a pixel; full-size pixels.
    pub position: Point,
    /// Normalised correlation of the patches after alignment, mean of three sizes, −1 to 1.
    pub correlation: f64,
    /// How far the clicked image is turned there, radians, from the x axis to the y axis.
    pub rotation: f64,
    /// How much larger the same thing is there than in the clicked image.
    pub scale: f64,
}

/// The candidates for a match and how sure the best one is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suggestions {
    /// Best first, at least one.
    pub candidates: Vec<Suggestion>,
    /// Mismatch of the best candidate over that of the best competitor, 0 to 1: `(1 − c₁)/(1 − c₂)`, both
    /// mismatches with a little added for noise.
    /// Competitors are the next separate place in the other image and, on the way back, the next separate place
    /// in the clicked one. Near 0 the best one stands alone; at 1 another is as good.
    pub ambiguity: f64,
    /// How far from the click the way back ends: the match of the best candidate, searched for in the clicked
    /// image, px. `None` when the way back found nothing.
    pub return_distance: Option<f64>,
    /// Whether to trust the best candidate.
    pub verdict: Clarity,
}

/// Whether the best candidate can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clarity {
    /// One place stands out, and the way back leads to the click.
    Clear,
    /// The best place does not look much like the click.
    Weak,
    /// Another place looks nearly as good.
    Ambiguous,
    /// The match of the best place is not the click.
    NoReturn,
}

impl Suggestions {
    /// The best candidate if it can be trusted.
    pub fn clear(&self) -> Option<&Suggestion> {
        if self.verdict == Clarity::Clear { self.candidates.first() } else { None }
    }
}

impl fmt::Display for Clarity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Clear => "Clear: one place stands out, and its own match is the point",
            Self::Weak => "Unclear: the best place does not look much like the surroundings of the point",
            Self::Ambiguous => "Unclear: other places look nearly as good",
            Self::NoReturn => "Unclear: the match of the best place is not the point",
        })
    }
}
