//! Names of the tabs of the bottom panel and of the overlays over the images. The view knows their
//! contents.

/// A tab of the bottom panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TabId {
    /// The list of point pairs.
    #[default]
    Points,
    /// Intensities along the inspected line pair.
    Profiles,
    /// Cost matrices of the clicks.
    Pencils,
    /// The best hypotheses of the search.
    Hypotheses,
    /// The result beside other methods and the truth.
    Residuals,
    /// The rectified pair.
    Rectified,
}

impl TabId {
    /// All tabs from left to right.
    pub const ALL: [Self; 6] =
        [Self::Points, Self::Profiles, Self::Pencils, Self::Hypotheses, Self::Residuals, Self::Rectified];

    /// Returns the heading of the tab.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Points => "Point pairs",
            Self::Profiles => "Profiles",
            Self::Pencils => "Pencils",
            Self::Hypotheses => "Hypotheses",
            Self::Residuals => "Residuals",
            Self::Rectified => "Rectified",
        }
    }
}

/// Rule for showing an overlay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// Shown whenever it has content.
    Always,
    /// Shown until the user hides it.
    AtFirst,
    /// Hidden until the user shows it.
    OnRequest,
    /// Shown until the user hides it, with ground truth only.
    WithTruth,
}

/// An overlay over the images.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "each is explained where it is drawn")]
pub enum OverlayId {
    Candidates,
    RoundTrip,
    Uncertainty,
    Lines,
    TrueLines,
    ChosenLines,
    Bisectors,
    CursorLine,
    Pinned,
    Samples,
    TrueMatches,
    Matches,
    MagnifiedResiduals,
    Hypotheses,
    Epipoles,
    PointedAt,
    Suggestion,
    NextClick,
    Points,
}

impl OverlayId {
    /// All overlays with names and rules, from the lowest to the topmost.
    const TABLE: [(Self, &'static str, Visibility); 19] = [
        (Self::Candidates, "Candidates", Visibility::OnRequest),
        (Self::RoundTrip, "Round trip", Visibility::OnRequest),
        (Self::Uncertainty, "Uncertainty", Visibility::AtFirst),
        (Self::Lines, "Epipolar lines", Visibility::AtFirst),
        (Self::TrueLines, "True lines", Visibility::WithTruth),
        (Self::ChosenLines, "Chosen lines", Visibility::OnRequest),
        (Self::Bisectors, "Bisectors", Visibility::OnRequest),
        (Self::CursorLine, "Cursor line", Visibility::AtFirst),
        (Self::Pinned, "Pinned", Visibility::AtFirst),
        (Self::Samples, "Matched samples", Visibility::AtFirst),
        (Self::TrueMatches, "True matches", Visibility::WithTruth),
        (Self::Matches, "Matches", Visibility::OnRequest),
        (Self::MagnifiedResiduals, "Residuals ×50", Visibility::OnRequest),
        (Self::Hypotheses, "Hypotheses", Visibility::AtFirst),
        (Self::Epipoles, "Epipoles", Visibility::AtFirst),
        (Self::PointedAt, "Pointed at", Visibility::Always),
        (Self::Suggestion, "Suggested match", Visibility::Always),
        (Self::NextClick, "Next click", Visibility::Always),
        (Self::Points, "Points", Visibility::AtFirst),
    ];

    /// Number of overlays.
    pub const COUNT: usize = Self::TABLE.len();

    /// Returns all overlays, from the lowest to the topmost.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::TABLE.into_iter().map(|(id, ..)| id)
    }

    /// Returns the name of the overlay.
    pub const fn name(self) -> &'static str {
        Self::TABLE[self as usize].1
    }

    /// Returns whether the overlay is drawn over the map of the epipoles. The map must not cover
    /// things to click.
    pub const fn is_above_map(self) -> bool {
        matches!(self, Self::PointedAt | Self::Suggestion | Self::NextClick | Self::Points)
    }

    /// Returns whether a figure can include the overlay. Overlays for the cursor or the next click
    /// make no sense on paper.
    pub fn is_for_figures(self) -> bool {
        self.visibility() != Visibility::Always && self != Self::CursorLine
    }

    /// Returns the rule for showing the overlay.
    pub const fn visibility(self) -> Visibility {
        Self::TABLE[self as usize].2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlays_are_in_the_order_of_their_table() {
        assert!(OverlayId::all().enumerate().all(|(place, id)| id as usize == place));
        assert!(TabId::ALL.into_iter().enumerate().all(|(place, id)| id as usize == place));
    }
}
