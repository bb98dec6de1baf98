//! Stages of the algorithm, used for progress, timings and groups of parameters.

use serde::Serialize;

named! {
    fn label;
    /// Stages of the algorithm, in order.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Stage {
        /// Grey pyramids of both images.
        Pyramid = "Image pyramid",
        /// Lines through the clicks and their similarity matrices.
        Pencils = "Line pencils",
        /// Epipole hypotheses from candidate pairs, with the forward and backward maps.
        Hypotheses = "Epipole hypotheses",
        /// Full validation of the best hypotheses.
        Validation = "Validation",
        /// Local refinement, coarse to fine.
        Refinement = "Refinement",
        /// Covariant features and the views that they suggest. This stage runs if the others leave
        /// doubts, or without clicks.
        Features = "Features and views",
    }
}
