//! A prepared pair under one relative view of its images.

use std::sync::Arc;

use super::patches::PatchLevels;
use super::prepared::PreparedPair;
use crate::estimate::{Clicks, Parameters};
use crate::similarity::SimilaritySource;

/// Input of a search.
#[derive(Clone, Copy)]
pub(in crate::estimate) struct SearchInput<'a> {
    pub prepared: &'a PreparedPair,
    pub clicks: &'a Clicks,
    pub parameters: &'a Parameters,
}

/// Input of a search with the evidence of the pair under one relative view: its line similarity and
/// its patches.
pub(in crate::estimate) struct ViewedPair<'a> {
    pub input: SearchInput<'a>,
    /// Line similarity under the view of the patches.
    pub source: Box<dyn SimilaritySource + 'a>,
    pub patches: Arc<PatchLevels>,
}

impl<'a> ViewedPair<'a> {
    /// Returns the pair under the view of these patches.
    pub fn new(input: SearchInput<'a>, patches: Arc<PatchLevels>) -> Self {
        let source = input.prepared.similarity_source(patches.view(), input.parameters);
        Self { input, source, patches }
    }

    /// Returns the pair with neither image turned or scaled, and without features.
    pub fn upright(input: SearchInput<'a>) -> Self {
        Self::new(input, input.prepared.upright_patches())
    }

    /// Returns the pair under the same view with other clicks.
    pub fn with_clicks<'b>(&'b self, clicks: &'b Clicks) -> ViewedPair<'b> {
        ViewedPair::new(SearchInput { clicks, ..self.input }, Arc::clone(&self.patches))
    }
}
