//! A prepared pair under one relative view of its images.

use std::sync::Arc;

use super::patches::{KappaVoting, PatchLevels, SupportLevel};
use super::prepared::PreparedPair;
use crate::estimate::Parameters;
use crate::image::PyramidPair;
use crate::similarity::SimilaritySource;

/// Evidence of a pair under one relative view: its line similarity and its patches.
pub(in crate::estimate) struct ViewedPair<'a> {
    pub prepared: &'a PreparedPair,
    /// Line similarity under the view of the patches.
    pub source: Box<dyn SimilaritySource + 'a>,
    pub patches: Arc<PatchLevels>,
}

impl<'a> ViewedPair<'a> {
    /// Returns the pair under the view of these patches.
    pub fn new(prepared: &'a PreparedPair, patches: Arc<PatchLevels>, parameters: &Parameters) -> Self {
        let source = prepared.similarity_source(patches.view(), parameters);
        Self { prepared, source, patches }
    }

    /// Returns the pair with neither image turned or scaled, and without features.
    pub fn upright(prepared: &'a PreparedPair, parameters: &Parameters) -> Self {
        Self::new(prepared, prepared.upright_patches(), parameters)
    }

    /// Returns the pyramids of both images.
    pub fn pyramids(&self) -> &'a PyramidPair {
        self.prepared.pyramids()
    }

    /// Returns the corners and their correlations at the coarse size.
    pub fn coarse(&self) -> &SupportLevel {
        self.patches.coarse(self.pyramids())
    }

    /// Returns the votes of look-alike corners for κ, at the coarse size.
    pub fn voting(&self) -> &KappaVoting {
        self.patches.voting(self.pyramids())
    }

    /// Returns the corners and their correlations at the fine size.
    pub fn fine(&self) -> &SupportLevel {
        self.patches.fine(self.pyramids())
    }
}
