//! What the tabs of the bottom panel and the overlays over the images are called: all that is remembered of them. What
//! each shows is known to the view alone.

/// A tab of the bottom panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TabId {
    /// The list of point pairs.
    #[default]
    Points,
    /// Intensities along the inspected line pair.
    Profiles,
    /// The similarity matrices of the clicks.
    Pencils,
    /// The geometries that came nearest.
    Hypotheses,
    /// The result beside other methods and the truth.
    Residuals,
    /// The rectified pair.
    Rectified,
}

impl TabId {
    /// All of them from left to right.
    pub const ALL: [Self; 6] =
        [Self::Points, Self::Profiles, Self::Pencils, Self::Hypotheses, Self::Residuals, Self::Rectified];

    /// Heading of the tab.
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

/// When an overlay is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// Whenever it has something to show.
    Always,
    /// Until somebody hides it.
    AtFirst,
    /// When somebody asks for it.
    OnRequest,
    /// Until somebody hides it, where ground truth is in use; elsewhere it has nothing to show.
    WithTruth,
}

/// A layer over the images.
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
    /// All of them, from the lowest to the topmost, with their names and when they are shown.
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

    /// How many they are.
    pub const COUNT: usize = Self::TABLE.len();

    /// All of them, from the lowest to the topmost.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::TABLE.into_iter().map(|(id, ..)| id)
    }

    /// What it is called.
    pub const fn name(self) -> &'static str {
        Self::TABLE[self as usize].1
    }

    /// Whether it is drawn over the map of the epipoles too: what a person clicks must not be covered.
    pub const fn is_above_map(self) -> bool {
        matches!(self, Self::PointedAt | Self::Suggestion | Self::NextClick | Self::Points)
    }

    /// Whether a figure can have it: what follows the cursor, or helps with the next click, belongs to the window.
    pub fn is_for_figures(self) -> bool {
        self.visibility() != Visibility::Always && self != Self::CursorLine
    }

    /// When it is shown.
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
