//! Names of the stages, of the tabs of the dock, of the steps of a search and of the overlays. The
//! view knows their contents.

named! {
    fn title;

    /// A picture area that fills the window above or beside the dock. Stages lie from left to right.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum StageId {
        /// The two pictures as opened.
        #[default]
        Pictures = "Pictures",
        Rectified = "Rectified",
        /// The triangulated matches, with both cameras.
        Scene = "3-D",
    }
}

named! {
    fn title;

    /// A tab of the dock, from left to right.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum TabId {
        /// The hypotheses of the result, or the chart of the step that is shown. It has the name of the step then.
        Step = "Hypotheses",
        /// Intensities along the inspected line pair.
        #[default]
        Profiles = "Profiles",
        /// Distances of points from their epipolar lines.
        Residuals = "Residuals",
        /// The result beside other methods and the truth.
        Compare = "Compare",
    }
}

named! {
    fn title;

    /// A step of a search, as a person follows it.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum MethodStep {
        /// Moving objects of two sequences, frame by frame.
        Motion = "Motion",
        /// Comparison of the motion barcodes of lines.
        Barcodes = "Barcodes",
        /// Comparison of all lines through a click with all lines through its match.
        #[default]
        Pencils = "Pencils",
        /// Line pairs that are each other's best match.
        Candidates = "Candidates",
        /// Distinctive places of both pictures. With clicks also their matches, which have a step of their own without.
        Features = "Features",
        /// Matches of features, found by appearance alone.
        Matches = "Matches",
        /// Intersections of two candidates, which are possible epipoles.
        Epipoles = "Epipoles",
        /// Mapping of lines to the other image and back.
        RoundTrip = "Round trip",
        /// Comparison of the best hypotheses over the whole of both images.
        Validation = "Validation",
        /// Fit of the best hypothesis to patches at full resolution.
        Refinement = "Refinement",
    }
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

named! {
    fn title;

    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum OverlayGroup {
        Result = "Result",
        Data = "Data",
    }
}

named! {
    fn name;

    /// An overlay over the images, from the lowest to the topmost. Each is explained where it is drawn.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum OverlayId {
        Uncertainty = "Uncertainty",
        Lines = "Epipolar lines",
        TrueLines = "True lines",
        CursorLine = "Cursor line",
        Pinned = "Pinned",
        Samples = "Matched samples",
        TrueMatches = "True matches",
        Given = "Given matches",
        Matches = "Matches",
        MagnifiedResiduals = "Residuals ×50",
        Hypotheses = "Hypotheses",
        Epipoles = "Epipoles",
        PointedAt = "Pointed at",
        Suggestion = "Suggested match",
        NextClick = "Next click",
        Points = "Points",
    }
}

impl OverlayId {
    pub const COUNT: usize = Self::ALL.len();

    pub fn visibility(self) -> Visibility {
        match self {
            Self::PointedAt | Self::Suggestion | Self::NextClick => Visibility::Always,
            Self::Lines | Self::CursorLine | Self::Pinned | Self::Epipoles | Self::Points => {
                Visibility::AtFirst
            }
            Self::TrueLines | Self::TrueMatches => Visibility::WithTruth,
            Self::Given => Visibility::WithGiven,
            _ => Visibility::OnRequest,
        }
    }

    /// Returns the tab that shows the overlay while it is open.
    pub fn tab(self) -> Option<TabId> {
        match self {
            Self::Hypotheses => Some(TabId::Step),
            Self::Samples => Some(TabId::Profiles),
            Self::MagnifiedResiduals => Some(TabId::Residuals),
            _ => None,
        }
    }

    pub fn group(self) -> OverlayGroup {
        match self {
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
}
