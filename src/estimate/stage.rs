//! Stages of the algorithm, used for progress, timings and groups of parameters.

use serde::Serialize;

/// Stages of the algorithm, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Grey pyramids of both images.
    Pyramid,
    /// Lines through the clicks and their similarity matrices.
    Pencils,
    /// Epipole hypotheses from candidate pairs, with the forward and backward maps.
    Hypotheses,
    /// Full validation of the best hypotheses.
    Validation,
    /// Local refinement, coarse to fine.
    Refinement,
    /// Covariant features and the views that they suggest. This stage runs if the others leave
    /// doubts, or without clicks.
    Features,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Self; 6] =
        [Self::Pyramid, Self::Pencils, Self::Hypotheses, Self::Validation, Self::Refinement, Self::Features];

    /// Returns the name shown to the user.
    pub fn label(self) -> &'static str {
        match self {
            Self::Pyramid => "Image pyramid",
            Self::Pencils => "Line pencils",
            Self::Hypotheses => "Epipole hypotheses",
            Self::Validation => "Validation",
            Self::Refinement => "Refinement",
            Self::Features => "Features and views",
        }
    }
}
