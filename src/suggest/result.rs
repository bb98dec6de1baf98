//! Results of a search, with a verdict.

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
    /// Returns 1 or 2.
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

/// Position in the other image that looks like the surroundings of the click.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Suggestion {
    /// Position with subpixel accuracy, full-size px.
    pub position: Point,
    /// Normalised correlation of the aligned patches, mean of three sizes, −1 to 1.
    pub correlation: f64,
    /// Rotation relative to the clicked image, radians from the x axis to the y axis.
    pub rotation: f64,
    /// Scale relative to the clicked image.
    pub scale: f64,
}

/// Candidates for a match, with a verdict on the best one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Suggestions {
    /// Candidates, best first, at least one.
    pub candidates: Vec<Suggestion>,
    /// Ratio of the mismatches of the best candidate and its best competitor, 0 to 1:
    /// `(1 − c₁)/(1 − c₂)`, with a constant for noise added to both mismatches. Competitors are the
    /// next separate position in the other image and, in the reverse search, the next separate
    /// position in the clicked image. Near 0 the best candidate is unrivalled; at 1 a competitor is
    /// equally good.
    pub ambiguity: f64,
    /// Distance from the click to the match of the best candidate in the clicked image, px. `None`
    /// when the reverse search found nothing.
    pub return_distance: Option<f64>,
    /// Verdict on the best candidate.
    pub verdict: Clarity,
}

/// Verdict on the best candidate of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clarity {
    /// The best candidate has no rival and the reverse search ends at the click, or the nearest
    /// known matches expect the candidate there.
    Clear,
    /// The best candidate does not look much like the click.
    Weak,
    /// A competitor looks nearly as good.
    Ambiguous,
    /// The reverse search does not end at the click.
    NoReturn,
}

impl Suggestions {
    /// Returns the best candidate if it is clear.
    pub fn clear(&self) -> Option<&Suggestion> {
        if self.verdict == Clarity::Clear { self.candidates.first() } else { None }
    }
}

impl fmt::Display for Clarity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Clear => "Clear: the best place has no rival and the reverse search ends at the point, or the nearest matches confirm it",
            Self::Weak => "Unclear: the best place hardly looks like the surroundings of the point",
            Self::Ambiguous => "Unclear: other places look nearly as good",
            Self::NoReturn => "Unclear: the reverse search from the best place does not end at the point",
        })
    }
}
