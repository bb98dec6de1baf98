//! Names of the stages, of the tabs of the dock, of the steps of the method and of the overlays. The
//! view knows their contents.

/// A picture area that fills the window above or beside the dock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StageId {
    /// The two pictures as opened.
    #[default]
    Pictures,
    /// The rectified pair.
    Rectified,
    /// The triangulated matches, with both cameras.
    Scene,
}

impl StageId {
    /// All stages from left to right.
    pub const ALL: [Self; 3] = [Self::Pictures, Self::Rectified, Self::Scene];

    /// Returns the heading of the stage.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Pictures => "Pictures",
            Self::Rectified => "Rectified",
            Self::Scene => "3-D",
        }
    }
}

/// A tab of the dock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TabId {
    /// Intensities along the inspected line pair.
    #[default]
    Profiles,
    /// The steps of the method.
    Method,
    /// Distances of points from their epipolar lines.
    Residuals,
    /// The result beside other methods and the truth.
    Compare,
}

impl TabId {
    /// All tabs from left to right.
    pub const ALL: [Self; 4] = [Self::Profiles, Self::Method, Self::Residuals, Self::Compare];

    /// Returns the heading of the tab.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Profiles => "Profiles",
            Self::Method => "Method",
            Self::Residuals => "Residuals",
            Self::Compare => "Compare",
        }
    }
}

/// A step of the method, as a person follows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MethodStep {
    /// Comparison of all lines through a click with all lines through its match.
    #[default]
    Pencils,
    /// Line pairs that are each other's best match.
    Candidates,
    /// Intersections of two candidates, which are possible epipoles.
    Epipoles,
    /// Mapping of lines to the other image and back.
    RoundTrip,
    /// Comparison of the best hypotheses over the whole of both images.
    Validation,
    /// Fit of the best hypothesis to patches at full resolution.
    Result,
}

impl MethodStep {
    /// All steps in their order.
    pub const ALL: [Self; 6] =
        [Self::Pencils, Self::Candidates, Self::Epipoles, Self::RoundTrip, Self::Validation, Self::Result];

    /// Returns the heading of the step.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Pencils => "Pencils",
            Self::Candidates => "Candidates",
            Self::Epipoles => "Epipoles",
            Self::RoundTrip => "Round trip",
            Self::Validation => "Validation",
            Self::Result => "Result",
        }
    }

    /// Returns the neighbouring step; `None` at the ends.
    pub fn neighbour(self, forward: bool) -> Option<Self> {
        let place = self as usize;
        let other = if forward { Some(place + 1) } else { place.checked_sub(1) };
        Self::ALL.get(other?).copied()
    }
}

/// A part of the dock that switches overlays on while it is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OverlayPlace {
    Tab(TabId),
    Step(MethodStep),
}

/// Rule for showing an overlay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// Shown whenever it has content.
    Always,
    /// Shown until the user hides it.
    AtFirst,
    /// Shown while its part of the dock is open, or when the user keeps it on.
    OnRequest,
    /// Shown until the user hides it, with ground truth only.
    WithTruth,
    /// Shown until the user hides it, with matches from elsewhere only.
    WithGiven,
}

/// Group of overlays in their menu.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the titles say all")]
pub enum OverlayGroup {
    Result,
    Method,
    Data,
}

impl OverlayGroup {
    /// All groups with their titles.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Result, "Result"), (Self::Method, "Method"), (Self::Data, "Data")];
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
    Given,
    Matches,
    MagnifiedResiduals,
    RowOffsets,
    Hypotheses,
    Epipoles,
    PointedAt,
    Suggestion,
    NextClick,
    Points,
}

impl OverlayId {
    /// All overlays with names and rules, from the lowest to the topmost.
    const TABLE: [(Self, &'static str, Visibility); 21] = [
        (Self::Candidates, "Candidates", Visibility::OnRequest),
        (Self::RoundTrip, "Round trip", Visibility::OnRequest),
        (Self::Uncertainty, "Uncertainty", Visibility::OnRequest),
        (Self::Lines, "Epipolar lines", Visibility::AtFirst),
        (Self::TrueLines, "True lines", Visibility::WithTruth),
        (Self::ChosenLines, "Chosen lines", Visibility::OnRequest),
        (Self::Bisectors, "Bisectors", Visibility::OnRequest),
        (Self::CursorLine, "Cursor line", Visibility::AtFirst),
        (Self::Pinned, "Pinned", Visibility::AtFirst),
        (Self::Samples, "Matched samples", Visibility::OnRequest),
        (Self::TrueMatches, "True matches", Visibility::WithTruth),
        (Self::Given, "Given matches", Visibility::WithGiven),
        (Self::Matches, "Matches", Visibility::OnRequest),
        (Self::MagnifiedResiduals, "Residuals ×50", Visibility::OnRequest),
        (Self::RowOffsets, "Row offsets ×50", Visibility::OnRequest),
        (Self::Hypotheses, "Hypotheses", Visibility::OnRequest),
        (Self::Epipoles, "Epipoles", Visibility::OnRequest),
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

    /// Returns the parts of the dock that show the overlay while they are open.
    pub const fn places(self) -> &'static [OverlayPlace] {
        use MethodStep::{Candidates, Epipoles, Result, RoundTrip, Validation};
        use OverlayPlace::{Step, Tab};
        match self {
            Self::Candidates => &[Step(Candidates)],
            Self::ChosenLines | Self::Bisectors | Self::Hypotheses => &[Step(Epipoles)],
            Self::Epipoles => &[Step(Epipoles), Step(Result)],
            Self::RoundTrip => &[Step(RoundTrip)],
            Self::Uncertainty => &[Step(Result)],
            Self::Matches => &[Step(Validation), Step(Result)],
            Self::Samples => &[Tab(TabId::Profiles)],
            Self::MagnifiedResiduals => &[Tab(TabId::Residuals)],
            _ => &[],
        }
    }

    /// Returns the group of the overlay in its menu.
    pub const fn group(self) -> OverlayGroup {
        match self {
            Self::Candidates | Self::RoundTrip | Self::ChosenLines | Self::Bisectors | Self::Hypotheses => {
                OverlayGroup::Method
            }
            Self::Points
            | Self::Samples
            | Self::Matches
            | Self::Given
            | Self::TrueMatches
            | Self::TrueLines => OverlayGroup::Data,
            _ => OverlayGroup::Result,
        }
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
        assert!(MethodStep::ALL.into_iter().enumerate().all(|(place, id)| id as usize == place));
    }

    #[test]
    fn steps_end_at_both_ends() {
        assert_eq!(MethodStep::Pencils.neighbour(false), None);
        assert_eq!(MethodStep::Pencils.neighbour(true), Some(MethodStep::Candidates));
        assert_eq!(MethodStep::Result.neighbour(true), None);
    }
}
